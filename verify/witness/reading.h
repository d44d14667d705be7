// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "verify/witness/line_reading.h"

// Witnesses evaluate a plan's objects a third time, at single points. They read the scan's samples and the
// plan's own numbers, not octrees or meshes, by code that neither kernel uses. Where the kernels differ, a
// witness decides which of them is wrong.
namespace octotomy::verify {

/// The sides that a kernel's answer may have at a point.
struct AllowedSides {
  bool in = false;    ///< inside is allowed
  bool out = false;   ///< outside is allowed
  bool near = false;  ///< a surface passes within rounding of the point
  /// Both sides are allowed only because parts of an object were chosen or its cavities filled. The witness
  /// decides the side of the object before that step.
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

/// The sides that each kernel may have at a point. They differ because the kernels interpolate differently.
struct Reading {
  AllowedSides voxel, mesh;
  /// Number of surfaces that meet at the point. A surface that has a vertex of its own there counts twice. A
  /// mesh may have a vertex at the point only if the number is two or more.
  int surfaces = 0;
};

/// The parts of a reading that the caller needs. `Both` and `MeshOnly` include the surfaces; `BothSides` and
/// `MeshSides` are sides only. Sides alone cost less, because an operand that decides makes the other
/// operands unnecessary.
enum class ReadingNeeds { Both, MeshOnly, BothSides, MeshSides };
constexpr bool needs_voxels(ReadingNeeds asked) {
  return asked == ReadingNeeds::Both || asked == ReadingNeeds::BothSides;
}
constexpr bool needs_surfaces(ReadingNeeds asked) {
  return asked == ReadingNeeds::Both || asked == ReadingNeeds::MeshOnly;
}

class Necks;
/// A step of the plan at which both kernels chose some of an object's connected parts. `chosen_from_made`:
/// the motion from the object's present position back to its position at that step, LPS to LPS. `necks` is
/// null if the kernels' answers at that step are not available.
struct PartChoice {
  std::shared_ptr<const Necks> necks = {};
  glm::dmat4 chosen_from_made{1.0};
};

/// Reads one object at a point in LPS millimetres. `slack_mm`: distance by which the object's surfaces may be
/// off. Empty: the object has no witness. Safe to call from several threads.
class Witness {
 public:
  using Read = std::function<Reading(const glm::dvec3& p_mm, double slack_mm, ReadingNeeds asked)>;

  Witness() = default;
  /// `read` returns the whole reading. If it takes a third parameter of type ReadingNeeds, it may leave out
  /// the parts that are not needed.
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
  /// The reader from which the witness was made; null if the reader is of another type.
  template <typename Reader>
  const Reader* reader() const {
    return read_.target<Reader>();
  }
  /// The reading of the same object along lines, computed by separate code; may be empty.
  const LineReading& lines() const { return lines_; }
  Witness with_lines(LineReading lines) && {
    lines_ = std::move(lines);
    return std::move(*this);
  }
  /// The choices of connected parts among the steps that made the object. At each choice a thin neck may
  /// decide which parts belong to the object.
  const std::vector<PartChoice>& choices() const { return choices_; }
  Witness with_choices(std::vector<PartChoice> choices) && {
    choices_ = std::move(choices);
    return std::move(*this);
  }
  /// Returns the mesh's sides and the surfaces, at a fraction of the cost. Does not compute the voxel
  /// kernel's sides.
  Reading of_mesh(const glm::dvec3& p_mm) const { return read_(p_mm, 0.0, ReadingNeeds::MeshOnly); }
  /// Returns both kernels' sides, without the surfaces.
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
