// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/halving.h"

#include <gtest/gtest.h>

namespace octotomy::brep {
namespace {

std::uint32_t counted(std::uint32_t count, std::uint32_t leaf) {
  return count <= leaf ? 1 : 1 + counted(count / 2, leaf) + counted(count - count / 2, leaf);
}

TEST(Halving, CountsTheNodesOfATreeByItsLevels) {
  for (const std::uint32_t leaf : {1u, 4u, 8u})
    for (std::uint32_t count = 1; count < 300; ++count)
      ASSERT_EQ(halving_nodes(count, leaf), counted(count, leaf)) << count << " items, leaves of " << leaf;
  EXPECT_EQ(halving_nodes(1000003, 4), counted(1000003, 4));
}

}  // namespace
}  // namespace octotomy::brep
