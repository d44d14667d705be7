// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/multivalued_octree.h"

#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"

namespace octotomy::voxel {
namespace {

using tests::refusal;
using tests::universe_of;

TEST(MultivaluedOctree, GivesEachObjectBackLessThoseBeforeIt) {
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    std::vector<tests::Dense> dense;
    std::vector<Octree> objects;
    for (std::uint64_t i = 0; i < 3; ++i) {
      dense.push_back(tests::random_dense(16, 50 * seed + i));
      objects.push_back(tests::octree_of(universe_of(4), dense.back()));
    }
    const MultivaluedOctree tree = multivalued_octree(objects);
    EXPECT_EQ(parse_multivalued_octree(universe_of(4), text(tree)).nodes, tree.nodes);
    for (std::size_t number = 0; number <= 3; ++number) {
      const Octree object = object_of(tree, static_cast<int>(number));
      dense.front().for_each([&](const glm::ivec3& v) {
        std::size_t owner = 0;
        for (std::size_t i = 3; i > 0; --i)
          if (dense[i - 1].at(v) != 0) owner = i;
        ASSERT_EQ(object.contains(v), owner == number);
      });
    }
  }
}

TEST(MultivaluedOctree, OfOneObjectIsItsTreecode) {
  EXPECT_EQ(text(multivalued_octree({tests::figure_3_1()})),
            "P(0 P(0 0 0 0 0 0 0 1) 1 P(0 0 0 0 1 0 0 0) 0 0 P(0 1 1 0 0 1 0 0) 0)");
  EXPECT_EQ(text(multivalued_octree({Octree::empty(universe_of(3)), Octree::full(universe_of(3))})), "2");
}

TEST(MultivaluedOctree, ThatIsWrongIsRefused) {
  const auto decoded = [](const std::string& nodes) {
    object_of(parse_multivalued_octree(universe_of(2), nodes), 1);
  };
  EXPECT_NE(refusal([&] { decoded("P(0 0 0)"); }).find("character 8"), std::string::npos);
  EXPECT_NE(refusal([&] { decoded("P(1 1 1 1 1 1 1 1)"); }).find("node 9: is the last of eight children"),
            std::string::npos);
  EXPECT_NE(refusal([&] { decoded("255"); }).find("at most 254"), std::string::npos);
  EXPECT_NE(refusal([&] {
              object_of({universe_of(2), {0, 0}}, 1);
            }).find("node 2: comes after"),
            std::string::npos);
  EXPECT_NE(refusal([&] { object_of({universe_of(2), {255, 0}}, 1); }).find("is missing"), std::string::npos);
  EXPECT_THROW(multivalued_octree({}), std::invalid_argument);
  EXPECT_THROW(multivalued_octree({Octree::full(universe_of(2)), Octree::full(universe_of(3))}),
               std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
