// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "verify/witness/line_reading.h"

// A third reading of a plan's objects, at single points: neither octrees nor meshes, but the scan's samples
// and the plan's own numbers, by code that neither kernel uses. It decides which of two kernels that differ
// is wrong.
namespace octotomy::verify {

/// What a kernel may answer at a point.
struct Word {
  bool in = false;    ///< it may say inside
  bool out = false;   ///< it may say outside
  bool near = false;  ///< both, because a surface passes within its rounding of the point

  bool allows(bool inside) const { return inside ? in : out; }
  bool operator==(const Word&) const = default;
};
inline constexpr Word certainly_in{true, false, false};
inline constexpr Word certainly_out{false, true, false};
/// On a surface, as far as a kernel's interpolation and rounding go.
inline constexpr Word on_surface{true, true, true};
/// Away from any surface; the witness does not know on which side.
inline constexpr Word untold{true, true, false};

/// What each kernel may answer at a point: their interpolations differ.
struct Reading {
  Word voxel, mesh;
  /// Surfaces that meet at the point, by which a mesh may have a vertex there: two that cross, or one that
  /// has a vertex of its own there and counts twice.
  int surfaces = 0;
};

/// What of a reading is needed. Words without surfaces cost less: an operand that decides alone spares the
/// others.
enum class Asked { Both, MeshOnly, BothWords, MeshWord };
constexpr bool needs_voxels(Asked asked) {
  return asked == Asked::Both || asked == Asked::BothWords;
}
constexpr bool needs_surfaces(Asked asked) {
  return asked == Asked::Both || asked == Asked::MeshOnly;
}

class Necks;
/// Some of an object's connected parts, as both kernels chose them on the way, and the motion since, LPS to
/// LPS. Without necks the kernels' answers are not known.
struct PartChoice {
  std::shared_ptr<const Necks> necks = {};
  glm::dmat4 chosen_from_made{1.0};
};

/// Answers for one object at a point, LPS millimetres, whose surfaces may lie `slack_mm` elsewhere. Empty:
/// the object has no witness. Safe to call from several threads.
class Witness {
 public:
  using Read = std::function<Reading(const glm::dvec3& p_mm, double slack_mm, Asked asked)>;

  Witness() = default;
  /// `read` answers both words and the surfaces, or takes what is needed as well and may leave out the rest.
  template <typename Reader>
  requires std::is_invocable_v<const Reader&, const glm::dvec3&, double> ||
      std::is_invocable_v<const Reader&, const glm::dvec3&, double, Asked>
      Witness(Reader read) {  // NOLINT(google-explicit-constructor): any reader is a witness
    if constexpr (std::is_invocable_v<const Reader&, const glm::dvec3&, double, Asked>)
      read_ = std::move(read);
    else
      read_ = [read = std::move(read)](const glm::dvec3& p_mm, double slack_mm, Asked) {
        return read(p_mm, slack_mm);
      };
  }

  explicit operator bool() const { return static_cast<bool>(read_); }
  Reading operator()(const glm::dvec3& p_mm, double slack_mm, Asked asked = Asked::Both) const {
    return read_(p_mm, slack_mm, asked);
  }
  /// The same object along lines, by code of its own; may be empty.
  const LineReading& lines() const { return lines_; }
  Witness with_lines(LineReading lines) && {
    lines_ = std::move(lines);
    return std::move(*this);
  }
  /// The choices of connected parts that the object is made of, where a thin neck decides what belongs to it.
  const std::vector<PartChoice>& choices() const { return choices_; }
  Witness with_choices(std::vector<PartChoice> choices) && {
    choices_ = std::move(choices);
    return std::move(*this);
  }
  /// The mesh's word and the surfaces alone, at a fraction of the cost; nothing is said of the voxels.
  Reading of_mesh(const glm::dvec3& p_mm) const { return read_(p_mm, 0.0, Asked::MeshOnly); }
  /// Both words, nothing of the surfaces.
  Reading words(const glm::dvec3& p_mm) const { return read_(p_mm, 0.0, Asked::BothWords); }
  Word mesh_word(const glm::dvec3& p_mm) const { return read_(p_mm, 0.0, Asked::MeshWord).mesh; }

 private:
  Read read_;
  LineReading lines_;
  std::vector<PartChoice> choices_;
};

}  // namespace octotomy::verify
