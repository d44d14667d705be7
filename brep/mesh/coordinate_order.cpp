// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/coordinate_order.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <numeric>
#include <unordered_map>
#include <vector>

namespace octotomy::brep {

namespace {

using PointKey = std::array<double, 3>;

PointKey place_of(const Triangles& triangles, std::uint32_t v) {
  const glm::dvec3& p = triangles.points_mm[v];
  return {p.x, p.y, p.z};
}

/// For each vertex that coincides with another: the positions of its neighbours, in order. Read from the
/// faces, because a walk around a vertex may never end in a mesh that a Boolean left invalid.
std::unordered_map<std::uint32_t, std::vector<PointKey>> rings_of_shared(
    const Triangles& triangles, const std::vector<std::uint32_t>& order) {
  std::unordered_map<std::uint32_t, std::vector<PointKey>> rings;
  for (std::size_t i = 1; i < order.size(); ++i)
    if (place_of(triangles, order[i - 1]) == place_of(triangles, order[i]))
      for (const std::uint32_t v : {order[i - 1], order[i]}) rings[v];
  if (rings.empty()) return rings;
  for (const auto& face : triangles.faces)
    for (std::size_t corner = 0; corner < 3; ++corner)
      if (const auto ring = rings.find(face[corner]); ring != rings.end())
        for (const std::size_t other : {(corner + 1) % 3, (corner + 2) % 3})
          ring->second.push_back(place_of(triangles, face[other]));
  for (auto& [v, ring] : rings) {
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  }
  return rings;
}

}  // namespace

Triangles in_coordinate_order(const Mesh& mesh) {
  return in_coordinate_order(triangles_of(mesh));
}

Triangles in_coordinate_order(Triangles triangles) {
  check_joins(triangles);
  std::vector<std::uint32_t> order(triangles.points_mm.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t v, std::uint32_t w) {
    return place_of(triangles, v) < place_of(triangles, w);
  });
  const auto rings = rings_of_shared(triangles, order);
  for (auto first = order.begin(); !rings.empty() && first != order.end();) {
    const auto last = std::find_if(first + 1, order.end(), [&](std::uint32_t v) {
      return place_of(triangles, v) != place_of(triangles, *first);
    });
    if (last - first > 1)
      std::sort(first, last, [&](std::uint32_t v, std::uint32_t w) { return rings.at(v) < rings.at(w); });
    first = last;
  }

  Triangles sorted;
  std::vector<std::uint32_t> rank(order.size());
  for (const std::uint32_t v : order) {
    assert(v < rank.size());
    rank[v] = static_cast<std::uint32_t>(sorted.points_mm.size());
    sorted.points_mm.push_back(triangles.points_mm[v]);
  }
  assert(sorted.points_mm.size() == triangles.points_mm.size());
  sorted.faces = std::move(triangles.faces);
  for (auto& face : sorted.faces) {
    for (std::uint32_t& v : face) v = rank[v];
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
  }
  std::sort(sorted.faces.begin(), sorted.faces.end());
  return sorted;
}

}  // namespace octotomy::brep
