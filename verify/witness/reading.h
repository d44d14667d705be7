// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "verify/witness/line_reading.h"

// A third evaluation of a plan's objects, at single points. It reads the scan's samples and the plan's own
// numbers, not octrees or meshes, by code that neither kernel uses. Where the kernels differ, it decides
// which one is wrong.
namespace octotomy::verify {

/// The answers that are allowed for a kernel at a point.
struct AllowedSides {
  bool in = false;    ///< inside is allowed
  bool out = false;   ///< outside is allowed
  bool near = false;  ///< a surface passes within rounding of the point
  /// Both sides are allowed because parts of an object were chosen or its cavities filled, although the witness
  /// decides the side of the whole object.
  bool chosen = false;

  bool is_open() const { return in && out && !near; }
  bool allows(bool inside) const { return inside ? in : out; }
  bool operator==(const AllowedSides&) const = default;
};
inline constexpr AllowedSides certainly_in{true, false, false};
inline constexpr AllowedSides certainly_out{false, true, false};
/// The point is on a surface, within a kernel's interpolation and rounding.
inline constexpr AllowedSides on_surface{true, true, true};
/// The point is away from any surface, but the witness cannot decide the side.
inline constexpr AllowedSides either_side{true, true, false};
inline constexpr AllowedSides either_by_choice{true, true, false, true};

/// The allowed answers of each kernel at a point. They differ because the kernels interpolate differently.
struct Reading {
  AllowedSides voxel, mesh;
  /// Number of surfaces that meet at the point. A surface with a vertex of its own there counts twice. A mesh
  /// may have a vertex at the point if the number is two or more.
  int surfaces = 0;
};

/// The parts of a reading that the caller needs. `Both` and `MeshOnly` include the surfaces; `BothSides` and
/// `MeshSides` are sides only. They cost less, because the other operands are not read once one operand
/// decides.
enum class ReadingNeeds { Both, MeshOnly, BothSides, MeshSides };
constexpr bool needs_voxels(ReadingNeeds asked) {
  return asked == ReadingNeeds::Both || asked == ReadingNeeds::BothSides;
}
constexpr bool needs_surfaces(ReadingNeeds asked) {
  return asked == ReadingNeeds::Both || asked == ReadingNeeds::MeshOnly;
}

class Necks;
/// A step of the plan at which both kernels chose some of an object's connected parts, and the motion of the
/// object since then, LPS to LPS. `necks` is null if the kernels' answers at that step are not available.
struct PartChoice {
  std::shared_ptr<const Necks> necks = {};
  glm::dmat4 chosen_from_made{1.0};
};

/// Computes the reading of one object at a point, LPS millimetres. The object's surfaces may be off by
/// `slack_mm`. Empty: the object has no witness. Safe to call from several threads.
class Witness {
 public:
  using Read = std::function<Reading(const glm::dvec3& p_mm, double slack_mm, ReadingNeeds asked)>;

  Witness() = default;
  /// `read` returns the whole reading; with a third parameter of type ReadingNeeds it may leave out the parts
  /// that are not needed.
  template <typename Reader>
  requires std::is_invocable_v<const Reader&, const glm::dvec3&, double> ||
      std::is_invocable_v<const Reader&, const glm::dvec3&, double, ReadingNeeds>
      Witness(Reader read) {  // NOLINT(google-explicit-constructor): any reader is a witness
    if constexpr (std::is_invocable_v<const Reader&, const glm::dvec3&, double, ReadingNeeds>)
      read_ = std::move(read);
    else
      read_ = [read = std::move(read)](const glm::dvec3& p_mm, double slack_mm, ReadingNeeds) {
        return read(p_mm, slack_mm);
      };
  }

  explicit operator bool() const { return static_cast<bool>(read_); }
  Reading operator()(const glm::dvec3& p_mm, double slack_mm, ReadingNeeds asked = ReadingNeeds::Both) const {
    return read_(p_mm, slack_mm, asked);
  }
  /// The reader from which the witness was made; null if it is of another type.
  template <typename Reader>
  const Reader* reader() const {
    return read_.target<Reader>();
  }
  /// The same object's reading along lines, computed by separate code; may be empty.
  const LineReading& lines() const { return lines_; }
  Witness with_lines(LineReading lines) && {
    lines_ = std::move(lines);
    return std::move(*this);
  }
  /// The choices of connected parts among the steps that computed the object. At each of them a thin neck may
  /// decide which parts belong to the object.
  const std::vector<PartChoice>& choices() const { return choices_; }
  Witness with_choices(std::vector<PartChoice> choices) && {
    choices_ = std::move(choices);
    return std::move(*this);
  }
  /// The mesh's sides and the surfaces, at a fraction of the cost. The voxel kernel's sides are not computed.
  Reading of_mesh(const glm::dvec3& p_mm) const { return read_(p_mm, 0.0, ReadingNeeds::MeshOnly); }
  /// Both kernels' sides, without the surfaces.
  Reading allowed_sides(const glm::dvec3& p_mm) const { return read_(p_mm, 0.0, ReadingNeeds::BothSides); }
  AllowedSides mesh_sides(const glm::dvec3& p_mm) const {
    return read_(p_mm, 0.0, ReadingNeeds::MeshSides).mesh;
  }

 private:
  Read read_;
  LineReading lines_;
  std::vector<PartChoice> choices_;
};

}  // namespace octotomy::verify
