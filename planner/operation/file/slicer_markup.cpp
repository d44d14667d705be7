// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/slicer_markup.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "planner/operation/file/drawn_region.h"
#include "planner/operation/file/landmarks_file.h"
#include "planner/operation/table/json.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/number_format.h"

namespace octotomy::planner {
namespace {

glm::dvec3 vector_of(const SortedJson& value, const std::string& where) {
  if (!value.is_array() || value.size() != 3) refuse(where, "must be a point [x, y, z]");
  return {number_of(value[0], where), number_of(value[1], where), number_of(value[2], where)};
}

/// The upper left 3 x 3 part of a row-major matrix with `width` numbers in a row.
glm::dmat3 axes_of(const SortedJson& value, std::size_t width, const std::string& where) {
  if (!value.is_array() || value.size() != width * width)
    refuse(where, "must be a list of " + std::to_string(width * width) + " numbers");
  glm::dmat3 axes;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 3; ++column)
      axes[static_cast<int>(column)][static_cast<int>(row)] = number_of(value[width * row + column], where);
  return axes;
}

/// Axes count as perpendicular unit vectors within this tolerance, because files have six digits.
constexpr double axes_to = 1e-4;

void set_axes(const glm::dmat3& axes, const std::string& where, MarkupPlane& plane) {
  const glm::dmat3 off = glm::transpose(axes) * axes - glm::dmat3(1.0);
  double worst = 0.0;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) worst = std::max(worst, std::abs(off[column][row]));
  if (!(worst <= axes_to) || glm::determinant(axes) < 0.0)
    refuse(where, "must be three perpendicular unit vectors that form a right-handed system");
  plane.normal = glm::normalize(axes[2]);
  plane.right = glm::normalize(axes[0] - glm::dot(axes[0], plane.normal) * plane.normal);
  plane.up = glm::cross(plane.normal, plane.right);
}

void set_bounds(const SortedJson& list, const std::string& where, double mm, MarkupPlane& plane) {
  if (list.contains("planeBounds")) {
    const SortedJson& bounds = list["planeBounds"];
    if (!bounds.is_array() || bounds.size() != 4)
      refuse(where + ".planeBounds", "must be a list of 4 numbers");
    std::array<double, 4> numbers{};
    for (std::size_t i = 0; i < 4; ++i) numbers[i] = mm * number_of(bounds[i], where + ".planeBounds");
    // Slicer writes empty bounds if it chose the plane's size.
    if (numbers[0] < numbers[1] && numbers[2] < numbers[3]) {
      plane.low_mm = {numbers[0], numbers[2]};
      plane.high_mm = {numbers[1], numbers[3]};
      return;
    }
  }
  if (!list.contains("size")) return;
  const SortedJson& size = list["size"];
  if (!size.is_array() || size.size() < 2) refuse(where + ".size", "must be a list of 2 or 3 numbers");
  const glm::dvec2 half =
      0.5 * mm * glm::dvec2(number_of(size[0], where + ".size"), number_of(size[1], where + ".size"));
  if (!(half.x > 0.0 && half.y > 0.0)) return;
  plane.low_mm = -half;
  plane.high_mm = half;
}

MarkupPlane plane_of(const SortedJson& list, const glm::dvec3& lps_mm, SlicerMarkup& markup) {
  const double mm = std::abs(lps_mm.x);
  const glm::dmat3 lps(glm::dvec3(lps_mm.x, 0, 0) / mm, glm::dvec3(0, lps_mm.y, 0) / mm, glm::dvec3(0, 0, 1));
  MarkupPlane plane;
  const bool is_stated = list.contains("center") && list.contains("orientation");
  if (is_stated) {
    plane.origin_mm = lps_mm * vector_of(list["center"], markup.where + ".center");
    set_axes(lps * axes_of(list["orientation"], 3, markup.where + ".orientation"),
             markup.where + ".orientation", plane);
  } else if (list.contains("baseToNode") && list.value("planeType", "") == "pointNormal") {
    if (markup.points_mm.empty()) refuse(markup.where, "has no placed control point: place the plane again");
    plane.origin_mm = markup.points_mm.front();
    set_axes(lps * axes_of(list["baseToNode"], 4, markup.where + ".baseToNode"), markup.where + ".baseToNode",
             plane);
  } else {
    if (markup.points_mm.size() < 3)
      refuse(markup.where,
             "has neither 'center' and 'orientation' nor three placed points: place the plane again");
    const std::vector<glm::dvec3>& p = markup.points_mm;
    const glm::dvec3 across = glm::cross(p[1] - p[0], p[2] - p[0]);
    if (!(glm::length(across) > 1e-3 * glm::length(p[1] - p[0]) * glm::length(p[2] - p[0])))
      refuse(markup.where, "has its three points on one line, which does not determine a plane");
    plane.origin_mm = p[0];
    plane.right = glm::normalize(p[1] - p[0]);
    plane.normal = glm::normalize(across);
    plane.up = glm::cross(plane.normal, plane.right);
    markup.findings.push_back(
        "WARN, frame: the file states no axes of the plane: they are computed from its first three points, "
        "the normal by the right-hand rule");
  }
  set_bounds(list, markup.where, mm, plane);
  return plane;
}

SlicerMarkup markup_of(const SortedJson& list, const std::string& where) {
  SlicerMarkup markup;
  markup.type = word_of(need(list, "type", where), where + ".type");
  markup.where = where;
  glm::dvec3 lps_mm(1.0);
  try {
    lps_mm = lps_mm_of_markup(list);
  } catch (const std::runtime_error& error) {
    refuse(where, error.what());
  }
  if (!list.contains("coordinateSystem"))
    markup.findings.push_back(
        "WARN, frame: the file names no coordinateSystem: LPS is assumed; if its program meant RAS, left and "
        "right are exchanged");
  if (!list.contains("coordinateUnits"))
    markup.findings.push_back("WARN, unit: the file names no coordinateUnits: mm is assumed");
  const SortedJson& controls = need(list, "controlPoints", where);
  if (!controls.is_array()) refuse(where + ".controlPoints", "must be a list");
  for (std::size_t i = 0; i < controls.size(); ++i) {
    const std::string at = where + ".controlPoints[" + std::to_string(i) + "]";
    if (!controls[i].is_object()) refuse(at, "must be an object");
    if (controls[i].value("positionStatus", "defined") != "defined") continue;
    markup.points_mm.push_back(lps_mm * vector_of(need(controls[i], "position", at), at + ".position"));
  }
  if (markup.type == "Plane") markup.plane = plane_of(list, lps_mm, markup);
  return markup;
}

/// The largest distance between the closed spline of Catmull and Rom through the points and its chords.
double spline_bend_mm(const std::vector<glm::dvec3>& points) {
  double most = 0.0;
  const std::size_t count = points.size();
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 &a = points[(i + count - 1) % count], &b = points[i], &c = points[(i + 1) % count],
                     &d = points[(i + 2) % count];
    // The spline's middle between b and c is (9 (b + c) - (a + d)) / 16.
    most = std::max(most, glm::distance((9.0 * (b + c) - (a + d)) / 16.0, 0.5 * (b + c)));
  }
  return most;
}

}  // namespace

std::vector<SlicerMarkup> read_slicer_markups(const std::filesystem::path& path, const std::string& type,
                                              std::vector<std::string>& findings) {
  const std::string name = path.filename().string() + ": ";
  const SortedJson json = read_json(path);
  std::vector<SlicerMarkup> found;
  try {
    const SortedJson& lists = need(json, "markups", path.string());
    if (!lists.is_array()) refuse(path.string() + ": markups", "must be a list");
    for (std::size_t number = 0; number < lists.size(); ++number) {
      const std::string where = path.string() + ": markups[" + std::to_string(number) + "]";
      const std::string its = word_of(need(lists[number], "type", where), where + ".type");
      if (its != type) {
        findings.push_back(name + "a markup of type " + its + " is left out");
        continue;
      }
      found.push_back(markup_of(lists[number], where));
      for (const std::string& finding : found.back().findings) findings.push_back(name + finding);
    }
  } catch (const SortedJson::exception& error) {
    refuse(path.string(), error.what());
  }
  if (found.empty()) refuse(path.string(), "has no markup of type " + type);
  return found;
}

MarkupPlane read_plane(const std::filesystem::path& path, std::vector<std::string>& findings) {
  const std::vector<SlicerMarkup> found = read_slicer_markups(path, "Plane", findings);
  if (found.size() > 1)
    refuse(path.string(),
           "has " + std::to_string(found.size()) + " planes: save each plane in a separate file");
  return *found.front().plane;
}

std::vector<std::vector<glm::dvec2>> read_closed_curves(const std::filesystem::path& path,
                                                        const glm::dvec3& right, const glm::dvec3& up,
                                                        std::vector<std::string>& findings) {
  std::vector<std::vector<glm::dvec2>> polygons_mm;
  for (const SlicerMarkup& curve : read_slicer_markups(path, "ClosedCurve", findings)) {
    if (curve.points_mm.size() < 3)
      refuse(curve.where, "has " + std::to_string(curve.points_mm.size()) +
                              " placed points, but a region needs at least three: place further points");
    std::vector<glm::dvec2>& polygon = polygons_mm.emplace_back();
    for (const glm::dvec3& p_mm : curve.points_mm) {
      const glm::dvec2 seen(glm::dot(p_mm, right), glm::dot(p_mm, up));
      polygon.push_back(glm::round(1e4 * seen) / 1e4 + 0.0);
    }
    if (const double bend_mm = spline_bend_mm(curve.points_mm); bend_mm > curve_tolerance_mm)
      findings.push_back(path.filename().string() +
                         ": the curve is read as straight lines between control points; a spline through "
                         "these would be up to " +
                         three_figures(bend_mm) + " mm away: resample the curve in Slicer to more points");
  }
  return polygons_mm;
}

}  // namespace octotomy::planner
