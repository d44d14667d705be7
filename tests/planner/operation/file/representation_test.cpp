// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/representation.h"

#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

TEST(Representation, OfEveryNameReadsBackAsTheSameOctree) {
  ASSERT_EQ(representation_names().size(), 13u);
  for (const std::string& name : representation_names())
    for (int depth = 2; depth <= 5; ++depth) {
      SCOPED_TRACE(name + ", depth " + std::to_string(depth));
      const voxel::Octree octree =
          tests::octree_of(tests::universe_of(depth), tests::random_dense(1 << depth, 11));
      const std::string content = represented({octree}, name);
      EXPECT_TRUE(octree_of_representation(octree.universe(), name, content) == octree);
      EXPECT_THROW(octree_of_representation(octree.universe(), name, content + "Q"), std::invalid_argument);
    }
}

TEST(Representation, OfSeveralObjectsIsMultivaluedAndEachReadsBack) {
  const voxel::Universe universe = tests::universe_of(4);
  const voxel::Octree first = tests::octree_of(universe, tests::random_dense(16, 3));
  const voxel::Octree second = tests::octree_of(universe, tests::random_dense(16, 4));
  const std::string content = represented({first, second}, "multivalued");
  EXPECT_TRUE(octree_of_representation(universe, "multivalued", content) == first);
  // A voxel of both belongs to the first.
  const voxel::Octree rest = voxel::combine(universe, voxel::Expression(second) - voxel::Expression(first));
  EXPECT_TRUE(octree_of_representation(universe, "multivalued", content, 2) == rest);
  EXPECT_TRUE(octree_of_representation(universe, "multivalued", content, 3).is_empty());
  EXPECT_NE(tests::refusal([&] {
              represented({first, second}, "linear");
            }).find("multivalued"),
            std::string::npos);
}

TEST(Representation, MaskedNodesWithOtherFacesThanTheirNeighboursCoverAreRefused) {
  const voxel::Octree octree = tests::figure_3_1();
  std::string content = represented({octree}, "masked");
  EXPECT_EQ(content.substr(0, 4), "P00(");
  const std::size_t full = content.find('F');
  const char before = content[full + 2];
  content[full + 2] = before == '0' ? '1' : '0';
  const std::string why =
      tests::refusal([&] { octree_of_representation(octree.universe(), "masked", content); });
  EXPECT_NE(why.find("masked octree, character " + std::to_string(full + 1) +
                     ": the covered faces of this node are"),
            std::string::npos)
      << why;
  const auto refused = [&](const char* text) {
    return tests::refusal([&] { octree_of_representation(octree.universe(), "masked", text); });
  };
  EXPECT_NE(refused("P00(E00E00E00E00E00E00E00E00)").find("eight equal children"), std::string::npos);
  EXPECT_NE(refused("P0g(").find("character 3"), std::string::npos);
  EXPECT_NE(refused("P00").find("character 4"), std::string::npos);
  EXPECT_NE(refused("X00").find("a node, E, F or P"), std::string::npos);
  EXPECT_NE(refused("").find("a node, E, F or P"), std::string::npos);
}

TEST(Representation, OfNoNameIsRefusedWithTheNearest) {
  EXPECT_NE(
      tests::refusal([] { represented({tests::figure_3_1()}, "treecod"); }).find("did you mean 'treecode'"),
      std::string::npos);
}

TEST(Representation, ThatHoldsEveryVoxelIsRefusedForTheLargestUniverse) {
  const voxel::Octree octree = voxel::Octree::empty(tests::universe_of(12));
  for (const char* name : {"explicit", "array", "bits", "bitree"})
    EXPECT_THROW(represented({octree}, name), std::length_error) << name;
  for (const char* name :
       {"treecode", "linear", "masked", "multivalued", "runs", "segments", "marginal", "faces", "packed"})
    EXPECT_TRUE(octree_of_representation(octree.universe(), name, represented({octree}, name)) == octree)
        << name;
}

}  // namespace
}  // namespace octotomy::planner
