// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/separate_regions.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

namespace octotomy::convert {

Tetrahedra separate_regions(const Tetrahedra& tetrahedra) {
  if (!tetrahedra.mid_nodes.empty())
    throw std::invalid_argument("separate_regions: nodes on sides come after");
  if (tetrahedra.region_of_tet.empty()) return tetrahedra;
  using Use = std::pair<std::uint32_t, std::uint32_t>;  // of a node by a region
  std::vector<Use> uses;
  uses.reserve(4 * tetrahedra.tets.size());
  for (std::size_t t = 0; t < tetrahedra.tets.size(); ++t)
    for (const std::uint32_t node : tetrahedra.tets[t]) uses.emplace_back(node, tetrahedra.region_of_tet[t]);
  std::sort(uses.begin(), uses.end());
  uses.erase(std::unique(uses.begin(), uses.end()), uses.end());

  Tetrahedra apart = tetrahedra;
  std::vector<std::uint32_t> number(uses.size());
  for (std::size_t i = 0; i < uses.size(); ++i) {
    number[i] = uses[i].first;
    if (i == 0 || uses[i - 1].first != uses[i].first) continue;
    if (apart.nodes_mm.size() == std::numeric_limits<std::uint32_t>::max())
      throw std::invalid_argument("separate_regions: more nodes than 32-bit numbers can name");
    number[i] = static_cast<std::uint32_t>(apart.nodes_mm.size());
    apart.nodes_mm.push_back(tetrahedra.nodes_mm[uses[i].first]);
  }
  for (std::size_t t = 0; t < apart.tets.size(); ++t)
    for (std::uint32_t& node : apart.tets[t]) {
      const auto use = std::lower_bound(uses.begin(), uses.end(), Use(node, apart.region_of_tet[t]));
      node = number[static_cast<std::size_t>(use - uses.begin())];
    }
  apart.boundary_nodes = boundary_nodes(apart.tets);
  return apart;
}

}  // namespace octotomy::convert
