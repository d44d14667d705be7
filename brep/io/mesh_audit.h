// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// What a mesh file says about itself: its frame, unit, program and polygons; what was taken from it, and what
// was assumed because the file is silent. A guess is a Warn.
namespace octotomy::brep {

enum class MeshVerdict { Pass, Warn, Fail };

/// "PASS", "WARN" or "FAIL".
std::string to_string(MeshVerdict verdict);

/// One line of a mesh file's audit: "frame", "unit", "writer", "size", "polygons", "points", "file", and beside
/// a scan "scale" and "place".
struct MeshFinding {
  std::string check;
  MeshVerdict verdict = MeshVerdict::Pass;
  std::string detail;
};

/// The frame of a name: three letters for the directions in which x, y and z grow, one each of L or R, A or
/// P, S or I, in any order and case ("LPS", "ras"), or the words that NRRD has for them
/// ("left-posterior-superior"). Returned as three capitals; none where the name is no frame.
std::optional<std::string> frame_named(std::string_view name);

/// LPS from a frame's coordinates. Precondition: frame_named() knows the frame. A negative determinant means
/// that the frame is left-handed, so that triangles wind the other way.
glm::dmat3 lps_from(const std::string& frame);

/// A unit of length: its name as `--unit` spells it, and its millimetres.
struct LengthUnit {
  std::string name;
  double mm = 1.0;
};
/// The unit of a word in any case: nm, um, mm, cm, dm, m, mil, inch, foot, their plurals and long forms
/// ("millimetres", "microns"); none where the word is no unit.
std::optional<LengthUnit> length_unit(std::string_view word);

/// Coordinates along the axes.
struct Extent {
  glm::dvec3 low_mm{0.0}, high_mm{0.0};
};

/// What speaks against a mesh's use beside something larger, which `beside` names ("the scan"):
/// - scale: its longest side is less than a hundredth of the other's, or more than ten times as long. A screw
///   is a fiftieth of a head, a cutting box at most a few heads. The unit that would make it fit is named.
/// - place: it lies wholly outside of the other. Where it would lie inside with x and y negated, it says so.
/// Empty where nothing does.
std::vector<MeshFinding> findings_beside(const Extent& mesh, const Extent& other, const std::string& beside);

}  // namespace octotomy::brep
