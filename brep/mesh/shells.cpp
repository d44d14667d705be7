// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/shells.h"

#include "brep/mesh/disjoint_sets.h"

namespace octotomy::brep {

std::vector<std::vector<std::uint32_t>> shells(const Linked& surface) {
  const std::size_t count = surface.triangles.faces.size();
  DisjointSets sets(count);
  for (std::uint32_t side = 0; side < surface.opposite.size(); ++side)
    if (surface.is_inner_edge(side)) sets.join(side / 3, surface.opposite[side] / 3);
  std::vector<std::vector<std::uint32_t>> shells;
  std::vector<std::size_t> number(count, 0);
  for (std::uint32_t f = 0; f < count; ++f) {
    const std::uint32_t first = sets.set_of(f);
    if (first == f) {
      number[f] = shells.size();
      shells.emplace_back();
    }
    shells[number[first]].push_back(f);
  }
  return shells;
}

void append(const Triangles& more, Triangles& all) {
  const auto first = static_cast<std::uint32_t>(all.points_mm.size());
  all.points_mm.insert(all.points_mm.end(), more.points_mm.begin(), more.points_mm.end());
  for (const auto& face : more.faces)
    all.faces.push_back({face[0] + first, face[1] + first, face[2] + first});
}

}  // namespace octotomy::brep
