// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/separate_regions.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <set>
#include <stdexcept>

#include "voxel/space/error.h"

namespace octotomy::convert {
namespace {

using AreApart = std::function<bool(std::uint32_t, std::uint32_t)>;
using Use = std::pair<std::uint32_t, std::uint32_t>;  // of a node by a region

/// Nodes with the regions that use them, ascending.
std::vector<Use> uses_of(const Tetrahedra& tetrahedra) {
  std::vector<Use> uses;
  uses.reserve(4 * tetrahedra.tets.size());
  for (std::size_t t = 0; t < tetrahedra.tets.size(); ++t)
    for (const std::uint32_t node : tetrahedra.tets[t]) uses.emplace_back(node, tetrahedra.region_of_tet[t]);
  std::sort(uses.begin(), uses.end());
  uses.erase(std::unique(uses.begin(), uses.end()), uses.end());
  return uses;
}

/// For each region at a node, the first region with which it shares the node; the region itself if there is
/// no earlier one.
std::vector<std::size_t> sharers(const Use* first, std::size_t count, const AreApart& are_apart) {
  std::vector<std::size_t> with(count);
  std::iota(with.begin(), with.end(), std::size_t{0});
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i + 1; j < count; ++j) {
      if (with[i] == with[j] || are_apart(first[i].second, first[j].second)) continue;
      const auto [low, high] = std::minmax(with[i], with[j]);
      std::replace(with.begin(), with.end(), std::size_t{high}, std::size_t{low});
    }
  return with;
}

Tetrahedra separated(const Tetrahedra& tetrahedra, const AreApart& are_apart) {
  if (!tetrahedra.mid_nodes.empty())
    throw std::invalid_argument("separate_regions: separate the regions before adding nodes on sides");
  if (tetrahedra.region_of_tet.empty()) return tetrahedra;
  const std::vector<Use> uses = uses_of(tetrahedra);
  Tetrahedra apart = tetrahedra;
  std::vector<std::uint32_t> number(uses.size());
  for (std::size_t first = 0; first < uses.size();) {
    std::size_t count = 1;
    while (first + count < uses.size() && uses[first + count].first == uses[first].first) ++count;
    const std::vector<std::size_t> with = sharers(&uses[first], count, are_apart);
    for (std::size_t i = 0; i < count; ++i) {
      if (with[i] == 0) {
        number[first + i] = uses[first].first;
      } else if (with[i] < i) {
        number[first + i] = number[first + with[i]];
      } else {
        if (apart.nodes_mm.size() == std::numeric_limits<std::uint32_t>::max())
          throw voxel::Error(
              voxel::ErrorCode::Resource,
              "separate_regions: more nodes than 32-bit numbers can name: take larger elements");
        number[first + i] = static_cast<std::uint32_t>(apart.nodes_mm.size());
        apart.nodes_mm.push_back(tetrahedra.nodes_mm[uses[first].first]);
      }
    }
    first += count;
  }
  for (std::size_t t = 0; t < apart.tets.size(); ++t)
    for (std::uint32_t& node : apart.tets[t]) {
      const auto use = std::lower_bound(uses.begin(), uses.end(), Use(node, apart.region_of_tet[t]));
      node = number[static_cast<std::size_t>(use - uses.begin())];
    }
  apart.boundary_nodes = boundary_nodes(apart.tets);
  return apart;
}

}  // namespace

Tetrahedra separate_regions(const Tetrahedra& tetrahedra) {
  return separated(tetrahedra, [](std::uint32_t, std::uint32_t) { return true; });
}

Tetrahedra separate_regions(const Tetrahedra& tetrahedra, const std::vector<RegionPair>& apart) {
  std::set<RegionPair> pairs;
  for (const auto& [a, b] : apart) pairs.insert(std::minmax(a, b));
  return separated(tetrahedra,
                   [&](std::uint32_t a, std::uint32_t b) { return pairs.contains(std::minmax(a, b)); });
}

}  // namespace octotomy::convert
