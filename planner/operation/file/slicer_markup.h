// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

// Reads markups of 3D Slicer (.mrk.json): closed curves, which become regions, and planes, which become cuts.
// Lists of points are landmarks (landmarks_file.h).
namespace octotomy::planner {

/// A plane with a rectangle in it, in LPS millimetres; right x up = normal.
struct MarkupPlane {
  glm::dvec3 origin_mm{0.0};
  glm::dvec3 right{1, 0, 0}, up{0, 1, 0}, normal{0, 0, 1};  ///< unit
  /// corners of the rectangle along right and up, from the origin; none if the file states no rectangle
  std::optional<glm::dvec2> low_mm, high_mm;
};

/// One markup of a file: a curve's control points or a plane.
struct SlicerMarkup {
  std::string type;                   ///< Slicer's word: "ClosedCurve", "Plane"
  std::string where;                  ///< "cut.mrk.json: markups[0]"
  std::vector<glm::dvec3> points_mm;  ///< its placed control points, LPS mm
  std::optional<MarkupPlane> plane;   ///< of a plane alone
  std::vector<std::string> findings;  ///< statements that the file lacks, each begins with "WARN, "
};

/// The markups of a file that have this type. Others are left out, with a finding in `findings`. Points are
/// converted from the file's frame and unit; if it states none, LPS and mm are assumed, with a WARN. A
/// plane's axes come from its "orientation" and "center"; else from "baseToNode" and its control point; else
/// from its three points, with the origin at the first, `right` towards the second, and a WARN. Throws
/// std::runtime_error that states the place in the file if it is not JSON, has no markup of the type, or has
/// a faulty point or a plane without axes. Source: 3D Slicer, schema of markups 1.0.3,
/// vtkMRMLMarkupsPlaneJsonStorageNode.
std::vector<SlicerMarkup> read_slicer_markups(const std::filesystem::path& path, const std::string& type,
                                              std::vector<std::string>& findings);

/// The only plane in a file, with findings on it. Throws as read_slicer_markups(), and std::runtime_error if
/// the file has several planes.
MarkupPlane read_plane(const std::filesystem::path& path, std::vector<std::string>& findings);

/// A file's closed curves, projected along right x up, in mm rounded to 0.0001. Control points are joined by
/// straight lines; a finding states how far a spline would deviate. Throws as read_slicer_markups(), and
/// std::runtime_error for a curve of fewer than three points.
std::vector<std::vector<glm::dvec2>> read_closed_curves(const std::filesystem::path& path,
                                                        const glm::dvec3& right, const glm::dvec3& up,
                                                        std::vector<std::string>& findings);

}  // namespace octotomy::planner
