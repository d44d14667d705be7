// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/file/region_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "planner/table/json.h"
#include "planner/table/json_file.h"
#include "planner/table/nearest_name.h"
#include "planner/table/number_format.h"
#include "voxel/scan/read_rtstruct.h"
#include "voxel/solid/polygon.h"

namespace octotomy::planner {
namespace {

std::vector<std::vector<glm::dvec2>> polygons_of(const SortedJson& value, const std::string& where) {
  if (!value.is_array()) refuse(where, "must be a list of polygons [[[u, v], ...], ...]");
  std::vector<std::vector<glm::dvec2>> polygons;
  for (const SortedJson& polygon : value) {
    const std::string at = where + "[" + std::to_string(polygons.size()) + "]";
    if (!polygon.is_array()) refuse(at, "must be a list of points [u, v]");
    polygons.emplace_back();
    for (const SortedJson& point : polygon) {
      const std::string place = at + "[" + std::to_string(polygons.back().size()) + "]";
      polygons.back().push_back(point_of(point, place));
    }
  }
  return polygons;
}

voxel::SliceMask slices_of(const SortedJson& json, const std::string& source) {
  check_keys(json, source, {"view", "between", "slices"});
  voxel::SliceMask mask;
  mask.view = voxel::parse_view(word_of(need(json, "view", source), source + ": view"));
  if (json.contains("between")) {
    const std::string between = word_of(json["between"], source + ": between");
    if (between != "shape_based" && between != "nearest")
      refuse(source + ": between", "is shape_based or nearest, not '" + between + "'");
    mask.between =
        between == "nearest" ? voxel::SliceMask::Between::Nearest : voxel::SliceMask::Between::ShapeBased;
  }
  const SortedJson& slices = need(json, "slices", source);
  if (!slices.is_array()) refuse(source + ": slices", "must be a list");
  for (const SortedJson& slice : slices) {
    const std::string where = source + ": slices[" + std::to_string(mask.slices.size()) + "]";
    check_keys(slice, where, {"position_mm", "polygons_mm"});
    mask.slices.push_back({number_of(need(slice, "position_mm", where), where + ".position_mm"),
                           polygons_of(need(slice, "polygons_mm", where), where + ".polygons_mm")});
  }
  std::stable_sort(mask.slices.begin(), mask.slices.end(),
                   [](const auto& a, const auto& b) { return a.position_mm < b.position_mm; });
  voxel::check(mask);
  return mask;
}

/// A plane may be off by as much as a decimal string rounds: a part of the least distance of planes.
constexpr double off_plane_mm() {
  return 0.01;
}

/// Twice the contour's area, along its normal.
glm::dvec3 area_of(const std::vector<glm::dvec3>& contour) {
  glm::dvec3 area(0.0);
  for (std::size_t i = 1; i + 1 < contour.size(); ++i)
    area += glm::cross(contour[i] - contour[0], contour[i + 1] - contour[0]);
  return area;
}

/// Looking along the normal of a contour, which is taken along the axis that it is within a thousandth of.
voxel::View view_across(const glm::dvec3& area) {
  voxel::View view;
  view.look = glm::normalize(area);
  const glm::dvec3 size = glm::abs(view.look);
  const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
  if (view.look[axis] < 0.0) view.look = -view.look;
  constexpr double along_axis = 1e-3;
  if (std::abs(view.look[axis] - 1.0) < along_axis * along_axis) {
    view.look = glm::dvec3(0.0);
    view.look[axis] = 1.0;
  }
  glm::dvec3 up(0.0);
  up[axis == 1 ? 2 : 1] = axis == 1 ? 1.0 : -1.0;
  view.up = glm::normalize(up - glm::dot(up, view.look) * view.look);
  view.right = glm::cross(view.look, view.up);
  return view;
}

using Slices = std::vector<voxel::SliceMask::Slice>;

/// A structure's contours by plane, ascending. `source` names it in refusals.
Slices planes_of(const voxel::Structure& structure, const voxel::View& view, const std::string& source) {
  std::vector<voxel::SliceMask::Slice> single;
  for (const std::vector<glm::dvec3>& contour : structure.contours_mm) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    voxel::SliceMask::Slice slice;
    slice.polygons_mm.emplace_back();
    for (const glm::dvec3& p : contour) {
      low = std::min(low, glm::dot(p, view.look));
      high = std::max(high, glm::dot(p, view.look));
      slice.polygons_mm.back().push_back(view.project(p));
    }
    if (!(high - low <= 2.0 * off_plane_mm()))
      refuse(source, "has contours in planes that are not parallel: by " + three_figures(high - low) +
                         " mm near " + plain(contour.front().x) + ", " + plain(contour.front().y) + ", " +
                         plain(contour.front().z) + " mm");
    slice.position_mm = 0.5 * (low + high);
    // A line there and back encloses nothing.
    if (std::abs(voxel::signed_area(slice.polygons_mm.back())) > 0.0) single.push_back(std::move(slice));
  }
  std::stable_sort(single.begin(), single.end(),
                   [](const auto& a, const auto& b) { return a.position_mm < b.position_mm; });
  Slices planes;
  for (voxel::SliceMask::Slice& slice : single)
    if (planes.empty() || slice.position_mm - planes.back().position_mm > 2.0 * off_plane_mm())
      planes.push_back(std::move(slice));
    else
      planes.back().polygons_mm.push_back(std::move(slice.polygons_mm.front()));
  return planes;
}

/// The least distance of planes of all structures that lie across the view; none where there is but one.
double least_distance_mm(const std::vector<voxel::Structure>& structures, const voxel::View& view) {
  std::vector<double> positions;
  for (const voxel::Structure& structure : structures)
    for (const auto& contour : structure.contours_mm)
      if (glm::length(glm::cross(area_of(contour), view.look)) <= 1e-3 * glm::length(area_of(contour)))
        positions.push_back(glm::dot(contour.front(), view.look));
  std::sort(positions.begin(), positions.end());
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < positions.size(); ++i)
    if (const double gap = positions[i] - positions[i - 1]; gap > 2.0 * off_plane_mm())
      least = std::min(least, gap);
  return least;
}

/// The planes with empty ones where the set has one and the structure has no contour.
Slices with_empty(const Slices& planes, double apart_mm) {
  Slices all{{planes.front().position_mm - apart_mm, {}}};
  for (const voxel::SliceMask::Slice& plane : planes) {
    // A gap of one and a half distances misses a plane.
    if (!all.back().polygons_mm.empty() && plane.position_mm - all.back().position_mm > 1.5 * apart_mm) {
      all.push_back({all.back().position_mm + apart_mm, {}});
      if (plane.position_mm - all.back().position_mm > 1.5 * apart_mm)
        all.push_back({plane.position_mm - apart_mm, {}});
    }
    all.push_back(plane);
  }
  all.push_back({planes.back().position_mm + apart_mm, {}});
  return all;
}

voxel::SliceMask slices_of(const std::vector<voxel::Structure>& structures, const std::string& name,
                           const std::string& source) {
  std::vector<std::string> names;
  for (const voxel::Structure& structure : structures) names.push_back(structure.name);
  std::string list;
  for (const std::string& known : names) list += (list.empty() ? "'" : ", '") + known + "'";
  if (name.empty() && structures.size() > 1)
    refuse(source, "holds several structures: say which by 'structure', one of " + list);
  const auto found =
      std::find_if(structures.begin(), structures.end(),
                   [&](const voxel::Structure& structure) { return name.empty() || structure.name == name; });
  if (found == structures.end()) refuse(source, "has no structure '" + name + "'" + suggestion(name, names));
  const std::string where = source + ": '" + found->name + "'";
  glm::dvec3 largest(0.0);
  for (const auto& contour : found->contours_mm)
    if (const glm::dvec3 area = area_of(contour); glm::length(area) > glm::length(largest)) largest = area;
  if (!(glm::length(largest) > 0.0))
    refuse(where, "has no closed contour" +
                      (found->others > 0 ? ", but " + std::to_string(found->others) + " points or lines"
                                         : std::string()));
  voxel::SliceMask mask;
  mask.view = view_across(largest);
  const double apart_mm = least_distance_mm(structures, mask.view);
  if (!std::isfinite(apart_mm))
    refuse(where, "lies in one plane, as the whole set does: how thick it is cannot be told");
  mask.slices = with_empty(planes_of(*found, mask.view, where), apart_mm);
  voxel::check(mask);
  return mask;
}

}  // namespace

voxel::Region read_region(const voxel::View& view, const std::filesystem::path& path) {
  const SortedJson json = read_json(path);
  if (json.is_array()) return {view, polygons_of(json, path.string())};
  check_keys(json, path.string(), {"polygons_mm"});
  return {view, polygons_of(need(json, "polygons_mm", path.string()), path.string() + ": polygons_mm")};
}

voxel::SliceMask read_slices(const std::filesystem::path& path, const std::string& structure) {
  const bool is_set = voxel::is_rtstruct(path);
  if (!is_set && !structure.empty())
    refuse(path.string(), "is no DICOM structure set, which 'structure' chooses of");
  try {
    return is_set ? slices_of(voxel::read_rtstruct(path), structure, path.string())
                  : slices_of(read_json(path), path.string());
  } catch (const std::invalid_argument& error) {
    refuse(path.string(), error.what());
  }
}

}  // namespace octotomy::planner
