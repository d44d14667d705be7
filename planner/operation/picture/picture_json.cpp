// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/picture/picture_json.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "planner/operation/picture/colour.h"

namespace octotomy::planner {
namespace {

/// The average visits to the nodes of one status at each level; null for levels without such nodes.
Json averages(const std::vector<voxel::LevelCount>& visits, const std::vector<voxel::LevelCount>& existing,
              std::uint64_t voxel::LevelCount::*status) {
  Json list = Json::array();
  for (std::size_t i = 0; i < existing.size(); ++i)
    list.push_back(existing[i].*status == 0 ? Json(nullptr)
                                            : Json(static_cast<double>(visits[i].*status) /
                                                   static_cast<double>(existing[i].*status)));
  return list;
}

}  // namespace

Json depth_range_json(const voxel::Picture& picture) {
  float low = 0.0f, high = -1.0f;
  for (const float depth : picture.depth_mm)
    if (std::isfinite(depth)) {
      low = high < low ? depth : std::min(low, depth);
      high = std::max(high, depth);
    }
  return high < low ? Json(nullptr) : Json::array({low, high});
}

Json objects_json(const std::vector<voxel::DrawnObject>& objects, const voxel::Picture& picture) {
  std::vector<std::uint64_t> lit(objects.size(), 0);
  for (const std::int16_t object : picture.object)
    if (object >= 0) ++lit[static_cast<std::size_t>(object)];
  Json list = Json::array();
  for (std::size_t i = 0; i < objects.size(); ++i)
    list.push_back({{"name", objects[i].name},
                    {"colour", text_of_colour(objects[i].colour)},
                    {"opacity", objects[i].opacity},
                    {"lit_pixels", lit[i]}});
  return list;
}

Json picks_json(const std::vector<glm::ivec2>& pixels, const std::vector<voxel::DrawnObject>& objects,
                const voxel::Picture& picture) {
  Json list = Json::array();
  for (const glm::ivec2& pixel : pixels) {
    const std::size_t index =
        static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(picture.size_px.x) +
        static_cast<std::size_t>(pixel.x);
    const std::optional<glm::dvec3> point_mm = picture.point_mm(pixel);
    const glm::dvec2 view_mm = picture.plane().view_mm(glm::dvec2(pixel) + 0.5);
    Json pick{{"pixel", {pixel.x, pixel.y}}, {"view_mm", {view_mm.x, view_mm.y}}};
    pick["object"] =
        point_mm ? Json(objects[static_cast<std::size_t>(picture.object[index])].name) : Json(nullptr);
    pick["point_mm"] = to_json(point_mm);
    pick["depth_mm"] = point_mm ? Json(picture.depth_mm[index]) : Json(nullptr);
    pick["colour"] = text_of_colour(
        glm::vec3(picture.rgb[3 * index], picture.rgb[3 * index + 1], picture.rgb[3 * index + 2]) / 255.0f);
    list.push_back(std::move(pick));
  }
  return list;
}

Json distances_json(const voxel::DrawnObject& object, const std::string& other,
                    const voxel::Picture& picture) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (int y = 0; y < picture.size_px.y; ++y)
    for (int x = 0; x < picture.size_px.x; ++x) {
      const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.size_px.x) +
                         static_cast<std::size_t>(x);
      if (picture.object[pixel] != 0) continue;
      const double distance_mm =
          object.scalar->at(object.scalar->universe.lattice().voxel(*picture.point_mm({x, y})));
      low = std::min(low, distance_mm);
      high = std::max(high, distance_mm);
    }
  Json json{{"object", object.name}, {"distance_to", other}, {"range_mm", object.scalar->most}};
  json["seen_mm"] = low <= high ? Json::array({low, high}) : Json(nullptr);
  return json;
}

void add_visits(Json& json, const voxel::Visits& visits) {
  const auto tally = [&](const voxel::VisitTally& of) {
    return Json{{"partial", averages(of.octree, visits.existing, &voxel::LevelCount::partial)},
                {"full", averages(of.octree, visits.existing, &voxel::LevelCount::full)},
                {"empty", averages(of.octree, visits.existing, &voxel::LevelCount::empty)},
                {"per_pixel", visits.per_pixel(of)}};
  };
  json["visits"] = {{"direct", tally(visits.direct)}, {"all", tally(visits.all)}};
  json["visits_per_pixel"] = visits.per_pixel(visits.all);
  const std::optional<double> unvisited = visits.unvisited_fraction();
  json["unvisited_fraction"] = unvisited ? Json(*unvisited) : Json(nullptr);
}

}  // namespace octotomy::planner
