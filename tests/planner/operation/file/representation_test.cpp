// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/representation.h"

#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"

namespace octotomy::planner {
namespace {

TEST(Representation, OfEveryNameReadsBackAsTheSameOctree) {
  ASSERT_EQ(representation_names().size(), 10u);
  for (const std::string& name : representation_names())
    for (int depth = 2; depth <= 5; ++depth) {
      SCOPED_TRACE(name + ", depth " + std::to_string(depth));
      const voxel::Octree octree =
          tests::octree_of(tests::universe_of(depth), tests::random_dense(1 << depth, 11));
      const std::string content = represented(octree, name);
      EXPECT_TRUE(octree_of_representation(octree.universe(), name, content) == octree);
      EXPECT_THROW(octree_of_representation(octree.universe(), name, content + "Q"), std::invalid_argument);
    }
}

TEST(Representation, OfNoNameIsRefusedWithTheNearest) {
  EXPECT_NE(
      tests::refusal([] { represented(tests::figure_3_1(), "treecod"); }).find("did you mean 'treecode'"),
      std::string::npos);
}

TEST(Representation, ThatHoldsEveryVoxelIsRefusedForTheLargestUniverse) {
  const voxel::Octree octree = voxel::Octree::empty(tests::universe_of(12));
  for (const char* name : {"explicit", "array", "bits"})
    EXPECT_THROW(represented(octree, name), std::length_error) << name;
  for (const char* name : {"treecode", "linear", "runs", "segments", "marginal", "faces", "packed"})
    EXPECT_TRUE(octree_of_representation(octree.universe(), name, represented(octree, name)) == octree)
        << name;
}

}  // namespace
}  // namespace octotomy::planner
