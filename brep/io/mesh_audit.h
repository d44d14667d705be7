// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Findings about a mesh file: its statements on frame, unit, program and polygons, the values that were used,
// and the values that were assumed because the file states none. A guess is a Warn.
namespace octotomy::brep {

enum class MeshVerdict { Pass, Warn, Fail };

/// "PASS", "WARN" or "FAIL".
std::string to_string(MeshVerdict verdict);

/// One line of a mesh file's audit: "frame", "unit", "writer", "size", "polygons", "points", "file", and, if
/// a scan is given, "scale" and "place".
struct MeshFinding {
  std::string check;
  MeshVerdict verdict = MeshVerdict::Pass;
  std::string detail;
};

/// The frame with this name: three letters for the directions in which x, y and z grow, one each of L or R, A
/// or P, S or I, in any order and case ("LPS", "ras"), or NRRD's words for them ("left-posterior-superior").
/// Returns three capitals; none if the name is not a frame.
std::optional<std::string> frame_named(std::string_view name);

/// The transform from a frame's coordinates to LPS. Precondition: frame_named() accepts the frame. A negative
/// determinant means that the frame is left-handed, so that triangles must be reversed.
glm::dmat3 lps_from(const std::string& frame);

/// A unit of length: its name as in `--unit`, and its length in millimetres.
struct LengthUnit {
  std::string name;
  double mm = 1.0;
};
/// The unit that a word names, in upper or lower case: nm, um, mm, cm, dm, m, mil, inch, foot, their plurals
/// and long forms ("millimetres", "microns"); none if the word is not a unit.
std::optional<LengthUnit> length_unit(std::string_view word);

/// Lowest and highest coordinates along the axes.
struct Extent {
  glm::dvec3 low_mm{0.0}, high_mm{0.0};
};

/// Reasons to doubt a mesh that is used together with a larger object, which `beside` names ("the scan"):
/// - scale: its longest side is shorter than a hundredth or longer than ten times the other's longest side. A
///   screw is a fiftieth of a head, a cutting box at most a few heads. Names the unit in which the mesh would
///   fit.
/// - place: it lies wholly outside the other. Reports if it would meet the other with x and y negated.
/// Empty if there is no doubt.
std::vector<MeshFinding> findings_beside(const Extent& mesh, const Extent& other, const std::string& beside);

}  // namespace octotomy::brep
