// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/coordinate_order.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <numeric>
#include <vector>

namespace octotomy::brep {

Triangles in_coordinate_order(const Mesh& mesh) {
  Triangles triangles = triangles_of(mesh);
  check_joins(triangles);
  const auto place = [&](std::uint32_t v) {
    const glm::dvec3& p = triangles.points_mm[v];
    return std::array<double, 3>{p.x, p.y, p.z};
  };
  const auto ring = [&](std::uint32_t v) {
    std::vector<std::array<double, 3>> places;
    for (const auto neighbour : mesh.vv_range(Mesh::VertexHandle(static_cast<int>(v))))
      places.push_back(place(static_cast<std::uint32_t>(neighbour.idx())));
    std::sort(places.begin(), places.end());
    return places;
  };
  std::vector<std::uint32_t> order(triangles.points_mm.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t v, std::uint32_t w) {
    const auto at_v = place(v), at_w = place(w);
    return at_v != at_w ? at_v < at_w : v != w && ring(v) < ring(w);
  });

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
