// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <glm/glm.hpp>
#include <tbb/parallel_invoke.h>
#include <type_traits>
#include <vector>

namespace octotomy::brep {

/// The number of nodes of a binary tree over `count` items, halved (first half smaller) down to leaves of at
/// most `leaf_size`. With this number, the places of both halves in preorder are known before they are built,
/// so they can be built in parallel. Cost: log n.
inline std::uint32_t halving_nodes(std::uint32_t count, std::uint32_t leaf_size) {
  // Halves differ by at most one, so each level has only two sizes, `small` and `small` + 1.
  std::uint64_t nodes = 0, small = count, small_count = 1, large_count = 0;
  while (small_count + large_count > 0) {
    nodes += small_count + large_count;
    if (small <= leaf_size) small_count = 0;
    if (small + 1 <= leaf_size) large_count = 0;
    const std::uint64_t of_small = small_count, of_large = large_count;
    small_count = small % 2 == 0 ? 2 * of_small + of_large : of_small;
    large_count = small % 2 == 0 ? of_large : of_small + 2 * of_large;
    small /= 2;
  }
  return static_cast<std::uint32_t>(nodes);
}

/// An item of a tree, represented by a point.
struct Centred {
  glm::dvec3 centre_mm{0.0};
  std::uint32_t number = 0;
};

/// Builds a binary tree over items by halving. Each node is split at the median centre along its longest
/// axis; equal centres are ordered by number. Calls leaf(node, begin, end) for each leaf, whose items are
/// begin .. end - 1, and inner(node, second) for each other node, after the calls for its children `node` + 1
/// and `second`; in parallel. Precondition: item numbers are unique. The result is the same on any number of
/// threads. Cost: n log n.
template <typename Leaf, typename Inner>
void halve(std::vector<Centred>& items, std::uint32_t leaf_size, const Leaf& leaf, const Inner& inner,
           std::uint32_t self, std::uint32_t begin, std::uint32_t end) {
  constexpr std::uint32_t parallel_size = 8192;  // smaller halves are built one after the other
  assert(begin < end && end <= items.size());
  if (end - begin <= leaf_size) {
    leaf(self, begin, end);
    return;
  }
  glm::dvec3 low = items[begin].centre_mm, high = low;
  for (std::uint32_t i = begin; i < end; ++i) {
    low = glm::min(low, items[i].centre_mm);
    high = glm::max(high, items[i].centre_mm);
  }
  const glm::dvec3 extent = high - low;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const std::uint32_t middle = begin + (end - begin) / 2;
  const auto part_along = [&]<int axis>(std::integral_constant<int, axis>) {
    std::nth_element(items.begin() + begin, items.begin() + middle, items.begin() + end,
                     [](const Centred& a, const Centred& b) {
                       return a.centre_mm[axis] != b.centre_mm[axis] ? a.centre_mm[axis] < b.centre_mm[axis]
                                                                     : a.number < b.number;
                     });
  };
  // With a constant axis, comparisons need no branch on the axis.
  if (axis == 0)
    part_along(std::integral_constant<int, 0>());
  else if (axis == 1)
    part_along(std::integral_constant<int, 1>());
  else
    part_along(std::integral_constant<int, 2>());
  const std::uint32_t second = self + 1 + halving_nodes(middle - begin, leaf_size);
  const auto first_half = [&] { halve(items, leaf_size, leaf, inner, self + 1, begin, middle); };
  const auto second_half = [&] { halve(items, leaf_size, leaf, inner, second, middle, end); };
  if (end - begin > parallel_size) {
    tbb::parallel_invoke(first_half, second_half);
  } else {
    first_half();
    second_half();
  }
  inner(self, second);
}

}  // namespace octotomy::brep
