// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/file/region_file.h"

#include <algorithm>
#include <stdexcept>

#include "planner/table/json_file.h"

namespace octotomy::planner {
namespace {

using Json = nlohmann::json;

std::vector<std::vector<glm::dvec2>> polygons_of(const Json& value, const std::string& where) {
  if (!value.is_array()) refuse(where, "must be a list of polygons [[[u, v], ...], ...]");
  std::vector<std::vector<glm::dvec2>> polygons;
  for (const Json& polygon : value) {
    const std::string at = where + "[" + std::to_string(polygons.size()) + "]";
    if (!polygon.is_array()) refuse(at, "must be a list of points [u, v]");
    polygons.emplace_back();
    for (const Json& point : polygon) {
      const std::string place = at + "[" + std::to_string(polygons.back().size()) + "]";
      polygons.back().push_back(point_of(point, place));
    }
  }
  return polygons;
}

voxel::SliceMask slices_of(const Json& json, const std::string& source) {
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
  const Json& slices = need(json, "slices", source);
  if (!slices.is_array()) refuse(source + ": slices", "must be a list");
  for (const Json& slice : slices) {
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

}  // namespace

voxel::Region read_region(const voxel::View& view, const std::filesystem::path& path) {
  const Json json = read_json(path);
  if (json.is_array()) return {view, polygons_of(json, path.string())};
  check_keys(json, path.string(), {"polygons_mm"});
  return {view, polygons_of(need(json, "polygons_mm", path.string()), path.string() + ": polygons_mm")};
}

voxel::SliceMask read_slices(const std::filesystem::path& path) {
  try {
    return slices_of(read_json(path), path.string());
  } catch (const std::invalid_argument& error) {
    refuse(path.string(), error.what());
  }
}

}  // namespace octotomy::planner
