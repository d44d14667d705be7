// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/measure/wall_thickness.h"

#include <algorithm>
#include <cmath>

#include "brep/measure/local_thickness.h"
#include "planner/operation/measure/result_json.h"
#include "voxel/measure/local_thickness.h"

namespace octotomy::planner {
namespace {

using WeightedValues = std::vector<std::pair<double, double>>;

constexpr const char* wall_rule =
    "only where the ball touches the surface at two places that are at least 150 degrees apart, seen from "
    "its centre; edges are thus left out unless their sides converge by 30 degrees or less";

/// The thickness over the volume, with the same keys for both kernels.
template <typename Found>
Json volume_json(const Found& found, std::vector<std::string> sources) {
  return {{"average",
           {{"value", found.mean_mm},
            {"unit", "mm"},
            {"half_width", found.mean_half_width_mm},
            {"coverage", 0.99},
            {"sources", std::move(sources)}}},
          {"mean_mm", found.mean_mm},
          {"deviation_mm", found.deviation_mm},
          {"median_mm", found.median_mm},
          {"max_mm", found.largest_mm}};
}

/// The thickness of the surface's points that lie on walls, the thinnest wall and the walls' share of the
/// surface; nulls if there are no walls.
Json wall_json(WeightedValues walls, double whole, const std::optional<glm::dvec3>& thinnest_mm) {
  double share = 0.0;
  for (const auto& [value, weight] : walls) share += weight;
  Json json = weighted_summary(std::move(walls), "mm");
  json.update({{"share", whole > 0.0 ? Json(share / whole) : Json(nullptr)},
               {"thinnest_mm", to_json(thinnest_mm)},
               {"rule", wall_rule}});
  if (!thinnest_mm)
    json.update({{"finding", "the object has no walls, because no two of its sides are nearly parallel"}});
  return json;
}

/// For each vertex, the mean over the samples of its triangles, weighted by their nearness.
std::vector<double> at_vertices_of(const brep::Solid& solid,
                                   const std::vector<brep::LocalThicknessAt>& surface) {
  const brep::Triangles& triangles = solid.triangles();
  std::vector<glm::dvec3> places;
  for (const brep::LocalThicknessAt& at : surface) places.push_back(at.point.p_mm);
  const std::vector<brep::Foot> feet = solid.tree().feet(places);
  std::vector<double> sums(triangles.points_mm.size(), 0.0), weights(sums.size(), 0.0);
  for (std::size_t i = 0; i < surface.size(); ++i)
    for (int corner = 0; corner < 3; ++corner) {
      const std::size_t vertex = triangles.faces[feet[i].face][static_cast<std::size_t>(corner)];
      const double weight = surface[i].area_mm2 * feet[i].weights[corner];
      sums[vertex] += weight * surface[i].thickness_mm;
      weights[vertex] += weight;
    }
  // In large meshes some triangles have no sample. A vertex without a sample gets the value of a neighbour.
  for (int round = 0; round < 8; ++round)
    for (const auto& face : triangles.faces)
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const std::size_t to = face[corner], from = face[(corner + 1) % 3];
        if (weights[to] > 0.0 || !(weights[from] > 0.0)) continue;
        sums[to] = sums[from] / weights[from];
        weights[to] = 1.0;
      }
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = weights[i] > 0.0 ? sums[i] / weights[i] : 0.0;
  return sums;
}

}  // namespace

Json weighted_summary(WeightedValues value_and_weight, const std::string& unit) {
  const auto key = [&](const char* what) { return std::string(what) + "_" + unit; };
  Json json;
  if (value_and_weight.empty()) {
    for (const char* what : {"min", "mean", "median", "max"}) json[key(what)] = nullptr;
    return json;
  }
  std::sort(value_and_weight.begin(), value_and_weight.end());
  double whole = 0.0, sum = 0.0;
  for (const auto& [value, weight] : value_and_weight) {
    whole += weight;
    sum += weight * value;
  }
  double below = 0.0;
  const auto median = std::find_if(value_and_weight.begin(), value_and_weight.end(),
                                   [&](const auto& entry) { return (below += entry.second) >= 0.5 * whole; });
  json[key("min")] = value_and_weight.front().first;
  json[key("mean")] = sum / whole;
  json[key("median")] = (median == value_and_weight.end() ? value_and_weight.back() : *median).first;
  json[key("max")] = value_and_weight.back().first;
  return json;
}

Json thickness_json(const brep::Solid& solid, const voxel::Progress& progress,
                    std::vector<double>& at_vertices) {
  brep::LocalThicknessOptions options;
  options.progress = progress.report;
  options.stop = progress.stop;
  const brep::LocalThickness found = brep::local_thickness(solid, options);
  WeightedValues ray, ball, wall;
  double area_mm2 = 0.0;
  for (const brep::LocalThicknessAt& at : found.surface) {
    area_mm2 += at.area_mm2;
    if (std::isfinite(at.ray_mm)) ray.emplace_back(at.ray_mm, at.area_mm2);
    ball.emplace_back(at.thickness_mm, at.area_mm2);
    if (at.is_wall) wall.emplace_back(at.thickness_mm, at.area_mm2);
  }
  at_vertices = at_vertices_of(solid, found.surface);
  const std::optional<glm::dvec3> thinnest_mm =
      found.thinnest_wall ? std::optional(found.surface[*found.thinnest_wall].point.p_mm) : std::nullopt;
  return {{"definition",
           "local thickness after Hildebrand and Ruegsegger 1997: diameter of the largest ball inside that "
           "contains the point; ball: at points of the surface, weighted by area; volume: at points of the "
           "volume; ray: along the inward normal to the surface"},
          {"ray", weighted_summary(std::move(ray), "mm")},
          {"ball", weighted_summary(std::move(ball), "mm")},
          {"volume",
           volume_json(found, {"sampling of the volume", "distance of the balls", "search of the balls"})},
          {"wall", wall_json(std::move(wall), area_mm2, thinnest_mm)},
          {"samples", found.surface.size()},
          {"sample_reach_mm", found.reach_mm}};
}

Json thickness_json(const voxel::Octree& octree, const voxel::Progress& progress) {
  voxel::LocalThicknessOptions options;
  options.progress = progress;
  const voxel::VoxelThickness found = voxel::local_thickness(octree, options);
  WeightedValues ball, wall;
  for (const voxel::ThicknessAtVoxel& at : found.surface) {
    ball.emplace_back(at.thickness_mm, 1.0);
    if (at.is_wall) wall.emplace_back(at.thickness_mm, 1.0);
  }
  std::optional<glm::dvec3> thinnest_mm;
  if (found.thinnest_wall)
    thinnest_mm = octree.universe().lattice().lps_mm(glm::dvec3(found.surface[*found.thinnest_wall].voxel));
  return {{"definition",
           "local thickness after Hildebrand and Ruegsegger 1997: diameter of the largest ball inside that "
           "contains a voxel's centre; ball: over voxels with a face outside; volume: over all voxels"},
          {"ball", weighted_summary(std::move(ball), "mm")},
          {"volume", volume_json(found, {"half a voxel on either side", "sampling of the voxels"})},
          {"wall", wall_json(std::move(wall), static_cast<double>(found.surface.size()), thinnest_mm)},
          {"samples", found.surface.size()}};
}

}  // namespace octotomy::planner
