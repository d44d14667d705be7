// SPDX-License-Identifier: AGPL-3.0-or-later
// 1. Compute signed distances to the other surface at points of the first: corners of triangles, which are
//    split if they are large and may be near, or voxels of the boundary.
// 2. Group points within the distance that are near each other into places (single linkage by a grid).
// 3. Add each triangle's area within the distance, by linear interpolation, to the place of the triangle's
//   nearest corner.
#include "planner/operation/measure/near_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "voxel/measure/distance_map.h"
#include "voxel/tree/voxel_boundary.h"

namespace octotomy::planner {
namespace {

struct Points {
  std::vector<glm::dvec3> p_mm, normals;
  std::vector<double> distances_mm;
  std::vector<std::array<std::uint32_t, 3>> faces = {};
};

/// Halves triangles at their longest edges until those that `wanted` selects have no edge longer than the
/// spacing. `wanted` gets a triangle's corners and its longest edge; `add` gets the new points of each round.
/// New points are not shared between triangles, but the surface stays the same.
template <typename Wanted, typename Add>
void refine(std::vector<glm::dvec3>& points, std::vector<std::array<std::uint32_t, 3>>& faces,
            double spacing_mm, const Wanted& wanted, const Add& add) {
  std::vector<std::array<std::uint32_t, 3>> open = std::move(faces), done;
  while (!open.empty()) {
    std::vector<std::array<std::uint32_t, 3>> halves;
    for (const auto& face : open) {
      int from = 0;
      double longest = 0.0;
      for (int side = 0; side < 3; ++side)
        if (const double length = glm::distance(points[face[static_cast<std::size_t>(side)]],
                                                points[face[static_cast<std::size_t>((side + 1) % 3)]]);
            length > longest)
          longest = length, from = side;
      if (longest <= spacing_mm || !wanted(face, longest)) {
        done.push_back(face);
        continue;
      }
      const auto a = face[static_cast<std::size_t>(from)], b = face[static_cast<std::size_t>((from + 1) % 3)],
                 c = face[static_cast<std::size_t>((from + 2) % 3)];
      const auto middle = static_cast<std::uint32_t>(points.size());
      points.push_back(0.5 * (points[a] + points[b]));
      halves.push_back({a, middle, c});
      halves.push_back({middle, b, c});
    }
    add();
    open = std::move(halves);
  }
  faces = std::move(done);
}

Points voxel_points(const voxel::Octree& one, const voxel::Octree& other) {
  const voxel::VoxelRange range = voxel::range_of(one);
  const std::vector<float> distances = voxel::signed_distances_mm(other, range);
  const voxel::Lattice lattice = one.universe().lattice();
  const glm::ivec3 dims = range.dims();
  const glm::dmat3 axes(lattice.lps_from_voxel);
  Points points;
  for (const voxel::VoxelFace& face : voxel::voxel_boundary(one)) {
    const glm::ivec3 v = face.voxel - range.low;
    const auto index =
        static_cast<std::size_t>(v.x) +
        static_cast<std::size_t>(dims.x) * (static_cast<std::size_t>(v.y) +
                                            static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(v.z));
    points.p_mm.push_back(lattice.lps_mm(face.voxel));
    points.normals.push_back(glm::normalize(axes[face.axis]) * static_cast<double>(face.side));
    // The object's surface lies half a voxel outside the centres of its voxels.
    points.distances_mm.push_back(static_cast<double>(distances[index]) - 0.5 * glm::length(axes[face.axis]));
  }
  return points;
}

/// Points of the mesh. They are dense where the distance may be at most `within_mm` or the least distance.
Points mesh_points(const brep::Solid& one, const brep::Solid& other, double within_mm, double spacing_mm) {
  const brep::Triangles& triangles = one.triangles();
  Points points{triangles.points_mm, {}, signed_distances_mm(other, triangles.points_mm), triangles.faces};
  double least = *std::min_element(points.distances_mm.begin(), points.distances_mm.end());
  refine(
      points.p_mm, points.faces, spacing_mm,
      [&](const std::array<std::uint32_t, 3>& face, double longest) {
        const std::vector<double>& d = points.distances_mm;
        // If a point moves, its distance changes by at most the same length.
        return std::min({d[face[0]], d[face[1]], d[face[2]]}) - longest <= std::max(within_mm, least);
      },
      [&] {
        const auto known = static_cast<std::ptrdiff_t>(points.distances_mm.size());
        if (known == static_cast<std::ptrdiff_t>(points.p_mm.size())) return;
        const std::vector<double> added =
            signed_distances_mm(other, {points.p_mm.begin() + known, points.p_mm.end()});
        least = std::min(least, *std::min_element(added.begin(), added.end()));
        points.distances_mm.insert(points.distances_mm.end(), added.begin(), added.end());
      });
  points.normals.assign(points.p_mm.size(), glm::dvec3(0.0));
  for (const auto& face : points.faces) {
    const glm::dvec3 across =
        glm::cross(points.p_mm[face[1]] - points.p_mm[face[0]], points.p_mm[face[2]] - points.p_mm[face[0]]);
    for (const auto corner : face) points.normals[corner] += across;
  }
  return points;
}

/// For each point within the distance, the number of its place, from 0; -1 for all other points.
std::vector<int> places_of(const Points& points, double within_mm, double apart_mm, int& count) {
  std::map<std::array<int, 3>, std::vector<std::size_t>> cells;
  std::vector<std::size_t> near, root(points.p_mm.size());
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto find = [&](std::size_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  const auto cell_of = [&](const glm::dvec3& p) {
    const glm::dvec3 cell = glm::floor(p / apart_mm);
    return std::array{static_cast<int>(cell.x), static_cast<int>(cell.y), static_cast<int>(cell.z)};
  };
  for (std::size_t i = 0; i < points.p_mm.size(); ++i)
    if (points.distances_mm[i] <= within_mm) {
      const auto cell = cell_of(points.p_mm[i]);
      for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
          for (int x = -1; x <= 1; ++x) {
            const auto found = cells.find({cell[0] + x, cell[1] + y, cell[2] + z});
            if (found == cells.end()) continue;
            for (const std::size_t k : found->second)
              if (glm::distance(points.p_mm[i], points.p_mm[k]) <= apart_mm) root[find(k)] = find(i);
          }
      cells[cell].push_back(i);
      near.push_back(i);
    }
  std::vector<int> places(points.p_mm.size(), -1);
  std::map<std::size_t, int> numbers;
  for (const std::size_t i : near)
    places[i] = numbers.emplace(find(i), static_cast<int>(numbers.size())).first->second;
  count = static_cast<int>(numbers.size());
  return places;
}

/// The share of a triangle's area in which a value is at most `most`. The value is linear between the
/// corners.
double share_below(std::array<double, 3> corners, double most) {
  std::sort(corners.begin(), corners.end());
  const auto [low, middle, high] = corners;
  if (most <= low) return 0.0;
  if (most >= high) return 1.0;
  if (most < middle) return (most - low) * (most - low) / ((middle - low) * (high - low));
  return 1.0 - (high - most) * (high - most) / ((high - low) * (high - middle));
}

void add_areas(const Points& points, const std::vector<int>& places, double within_mm,
               std::vector<Contact>& contacts) {
  for (const auto& face : points.faces) {
    const auto nearest = *std::min_element(face.begin(), face.end(), [&](const auto a, const auto b) {
      return points.distances_mm[a] < points.distances_mm[b];
    });
    if (places[nearest] < 0) continue;
    const auto& p = points.p_mm;
    const double area = 0.5 * glm::length(glm::cross(p[face[1]] - p[face[0]], p[face[2]] - p[face[0]]));
    *contacts[static_cast<std::size_t>(places[nearest])].area_mm2 +=
        area * share_below(
                   {points.distances_mm[face[0]], points.distances_mm[face[1]], points.distances_mm[face[2]]},
                   within_mm);
  }
}

}  // namespace

std::vector<double> signed_distances_mm(const brep::Solid& solid, const std::vector<glm::dvec3>& points_mm) {
  std::vector<double> distances_mm = solid.tree().distances_mm(points_mm);
  const std::vector<std::uint8_t> inside = solid.tree().inside(points_mm);
  for (std::size_t i = 0; i < distances_mm.size(); ++i)
    if (inside[i] != 0) distances_mm[i] = -distances_mm[i];
  return distances_mm;
}

double least_distance_mm(const brep::Solid& one, const brep::Solid& other, double spacing_mm) {
  const Points points = mesh_points(one, other, -std::numeric_limits<double>::infinity(), spacing_mm);
  return *std::min_element(points.distances_mm.begin(), points.distances_mm.end());
}

std::vector<NearPoint> near_points(const brep::Solid& one, const brep::Solid& other, double spacing_mm) {
  // Errors in a plan move pieces by a few millimetres, so points farther from the other surface than this
  // cannot become the nearest.
  constexpr double reach_mm = 5.0;
  constexpr std::size_t most_points = 400;
  const double least_mm = least_distance_mm(one, other, spacing_mm);
  const double within_mm = std::max(least_mm, 0.0) + reach_mm;
  const Points points = mesh_points(one, other, within_mm, spacing_mm);
  std::vector<double> areas(points.p_mm.size(), 0.0);
  for (const auto& face : points.faces)
    for (const auto corner : face)
      areas[corner] += glm::length(glm::cross(points.p_mm[face[1]] - points.p_mm[face[0]],
                                              points.p_mm[face[2]] - points.p_mm[face[0]])) /
                       6.0;
  std::vector<NearPoint> all;
  std::vector<glm::dvec3> places;
  for (std::size_t i = 0; i < points.p_mm.size(); ++i) {
    const double length = glm::length(points.normals[i]);
    if (points.distances_mm[i] > within_mm || !(length > 0.0)) continue;
    all.push_back({points.p_mm[i], -points.normals[i] / length, points.distances_mm[i], areas[i]});
    places.push_back(points.p_mm[i]);
  }
  const std::vector<brep::Foot> feet = other.tree().feet(places);
  // For smaller distances, the direction to the nearest point is only rounding; the other surface's normal is
  // used instead.
  constexpr double touching_mm = 1e-6;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!(feet[i].distance_mm > touching_mm)) continue;
    const glm::dvec3 inward = all[i].away;
    all[i].away = (all[i].p_mm - feet[i].p_mm) / std::copysign(feet[i].distance_mm, all[i].distance_mm);
    all[i].area_mm2 *= std::max(0.0, glm::dot(inward, all[i].away));
  }
  for (double width_mm = spacing_mm;; width_mm *= 1.25) {
    std::map<std::array<int, 3>, NearPoint> cells;
    for (const NearPoint& point : all) {
      const glm::dvec3 cell = glm::floor(point.p_mm / width_mm);
      const auto [found, is_new] = cells.emplace(
          std::array{static_cast<int>(cell.x), static_cast<int>(cell.y), static_cast<int>(cell.z)}, point);
      if (is_new) continue;
      const double area_mm2 = found->second.area_mm2 + point.area_mm2;
      if (point.distance_mm < found->second.distance_mm) found->second = point;
      found->second.area_mm2 = area_mm2;
    }
    if (cells.size() > most_points) continue;
    std::vector<NearPoint> near;
    near.reserve(cells.size());
    for (const auto& [cell, point] : cells) near.push_back(point);
    return near;
  }
}

std::vector<glm::dvec3> points_about(const brep::Solid& solid, const glm::dvec3& place_mm, double radius_mm,
                                     double spacing_mm) {
  std::vector<glm::dvec3> points = solid.triangles().points_mm;
  auto faces = solid.triangles().faces;
  const auto off = [&](std::uint32_t corner) { return glm::distance(points[corner], place_mm); };
  refine(
      points, faces, spacing_mm,
      [&](const std::array<std::uint32_t, 3>& face, double longest) {
        return std::min({off(face[0]), off(face[1]), off(face[2])}) - longest <= radius_mm;
      },
      [] {});
  std::erase_if(points, [&](const glm::dvec3& p) { return glm::distance(p, place_mm) > radius_mm; });
  return points;
}

Contacts contacts_between(const voxel::Octree& one, const voxel::Octree& other,
                          const std::optional<brep::Solid>& solid_one,
                          const std::optional<brep::Solid>& solid_other, const ContactOptions& options) {
  Contacts made;
  made.by_mesh = solid_one && solid_other && !solid_one->empty() && !solid_other->empty();
  const Points voxels = voxel_points(one, other);
  const glm::dvec3 spacing_mm = one.universe().lattice().spacing_mm();
  const double half_voxel_mm = 0.5 * std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  const Points points =
      made.by_mesh ? mesh_points(*solid_one, *solid_other, options.within_mm, half_voxel_mm) : voxels;
  // Neighbouring points always belong to the same place, even if `apart_mm` is smaller than their distance.
  const double between_points_mm =
      made.by_mesh ? half_voxel_mm : std::max({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  int count = 0;
  const std::vector<int> places =
      places_of(points, options.within_mm, std::max(options.apart_mm, between_points_mm), count);
  made.contacts.resize(static_cast<std::size_t>(count));
  for (Contact& contact : made.contacts) {
    contact.nearest_mm = std::numeric_limits<double>::infinity();
    if (made.by_mesh) contact.area_mm2 = 0.0;
  }
  made.nearest_mm = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.p_mm.size(); ++i) {
    if (points.distances_mm[i] < made.nearest_mm)
      made.nearest_mm = points.distances_mm[i], made.nearest_at_mm = points.p_mm[i];
    if (places[i] < 0) continue;
    Contact& contact = made.contacts[static_cast<std::size_t>(places[i])];
    if (points.distances_mm[i] >= contact.nearest_mm) continue;
    contact.nearest_mm = points.distances_mm[i];
    contact.at_mm = points.p_mm[i];
    if (const double length = glm::length(points.normals[i]); length > 0.0)
      contact.normal = points.normals[i] / length;
  }
  if (made.by_mesh) add_areas(points, places, options.within_mm, made.contacts);
  made.voxel_nearest_mm = *std::min_element(voxels.distances_mm.begin(), voxels.distances_mm.end());
  // Farther than two voxels, the voxel kernel's distance belongs to another place.
  const double about_mm = 2.0 * glm::length(spacing_mm);
  for (Contact& contact : made.contacts)
    for (std::size_t i = 0; i < voxels.p_mm.size(); ++i)
      if (glm::distance(voxels.p_mm[i], contact.at_mm) <= about_mm)
        contact.voxel_nearest_mm =
            std::min(contact.voxel_nearest_mm.value_or(voxels.distances_mm[i]), voxels.distances_mm[i]);
  std::sort(made.contacts.begin(), made.contacts.end(), [](const Contact& a, const Contact& b) {
    return a.nearest_mm != b.nearest_mm ? a.nearest_mm < b.nearest_mm : a.at_mm.x < b.at_mm.x;
  });
  return made;
}

}  // namespace octotomy::planner
