// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

// Markups of 3D Slicer, .mrk.json: closed curves, which become regions, and planes, which become cuts. Points lists
// are landmarks (landmarks_file.h).
namespace octotomy::planner {

/// A plane with its rectangle: LPS, millimetres, right x up = normal.
struct MarkupPlane {
  glm::dvec3 origin_mm{0.0};
  glm::dvec3 right{1, 0, 0}, up{0, 1, 0}, normal{0, 0, 1};  ///< unit
  /// Bounds of the rectangle along right and up, from the origin; none where the file states none.
  std::optional<glm::dvec2> low_mm, high_mm;
};

/// One markup of a file.
struct SlicerMarkup {
  std::string type;                   ///< Slicer's word: "ClosedCurve", "Plane"
  std::string where;                  ///< "cut.mrk.json: markups[0]"
  std::vector<glm::dvec3> points_mm;  ///< its placed control points, LPS
  std::optional<MarkupPlane> plane;   ///< of a plane alone
  std::vector<std::string> findings;  ///< statements that the file lacks, each begins with "WARN, "
};

/// The markups of a file that have this type. Others are left out, with a finding in `findings`.
/// Frame and unit are the file's. If the file states none, LPS and mm are assumed, with a WARN. A plane's
/// axes are those of its "orientation" about its "center"; else of "baseToNode" about its control point; else
/// of its three points, the origin at the first and `right` towards the second, with a WARN. Throws
/// std::runtime_error with the place in the file: no JSON, no markup of the type, a point that is none, a
/// plane without axes.
/// Source: 3D Slicer, schema of markups 1.0.3, vtkMRMLMarkupsPlaneJsonStorageNode.
std::vector<SlicerMarkup> read_slicer_markups(const std::filesystem::path& path, const std::string& type,
                                              std::vector<std::string>& findings);

/// The one plane of a file, and the findings on it. Throws as read_slicer_markups(), and if there are several.
MarkupPlane read_plane(const std::filesystem::path& path, std::vector<std::string>& findings);

/// A file's closed curves, projected along right x up, points rounded to a ten-thousandth of a millimetre. They are
/// straight between control points, with a finding where a spline would bend away. Throws as read_slicer_markups(),
/// and for a curve of fewer than three points.
std::vector<std::vector<glm::dvec2>> read_closed_curves(const std::filesystem::path& path,
                                                        const glm::dvec3& right, const glm::dvec3& up,
                                                        std::vector<std::string>& findings);

}  // namespace octotomy::planner
