// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/disjoint_sets.h"

#include <gtest/gtest.h>
#include <random>
#include <vector>

namespace octotomy::brep {
namespace {

TEST(DisjointSets, AreNamedByTheirSmallestMemberInAnyOrderOfJoins) {
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    std::mt19937 random(seed);
    const std::uint32_t count = 2 + random() % 60;
    DisjointSets sets(count);
    std::vector<std::uint32_t> flooded(count);  // every joined member relabelled at once
    for (std::uint32_t i = 0; i < count; ++i) flooded[i] = i;
    for (std::uint32_t i = 0; i < count / 2; ++i) {
      const std::uint32_t a = random() % count, b = random() % count;
      sets.join(a, b);
      const std::uint32_t low = std::min(flooded[a], flooded[b]), high = std::max(flooded[a], flooded[b]);
      for (std::uint32_t& label : flooded)
        if (label == high) label = low;
    }
    for (std::uint32_t i = 0; i < count; ++i)
      ASSERT_EQ(sets.set_of(i), flooded[i]) << "member " << i << ", seed " << seed;
  }
}

}  // namespace
}  // namespace octotomy::brep
