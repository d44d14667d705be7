// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/cuberille_faces.h"

#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"

namespace octotomy::voxel {
namespace {

using tests::refusal;
using tests::universe_of;

// Section 3.1.2.2, each list x fastest. The thesis prints (3,0,1) among the x- faces, which is no voxel of
// the object: (3,1,1) is meant, as its y- and z- faces say.
const std::string faces_of_figure =
    "x+ (1,2,0), (1,3,0), (3,1,1), (2,2,1), (1,3,1), (1,2,2), (0,3,2), (1,2,3)\n"
    "x- (0,2,0), (0,3,0), (3,1,1), (0,2,1), (0,3,1), (1,2,2), (0,3,2), (1,2,3)\n"
    "y+ (0,3,0), (1,3,0), (3,1,1), (2,2,1), (0,3,1), (1,3,1), (1,2,2), (0,3,2), (1,2,3)\n"
    "y- (0,2,0), (1,2,0), (3,1,1), (0,2,1), (1,2,1), (2,2,1), (1,2,2), (0,3,2), (1,2,3)\n"
    "z+ (3,1,1), (0,2,1), (2,2,1), (1,3,1), (0,3,2), (1,2,3)\n"
    "z- (0,2,0), (1,2,0), (0,3,0), (1,3,0), (3,1,1), (2,2,1)\n";

Octree decoded_faces(int depth, const std::string& lists) {
  return octree_of(parse_cuberille_faces(universe_of(depth), lists));
}

TEST(CuberilleFaces, OfFigure31AreTheThesiss) {
  EXPECT_EQ(text(cuberille_faces(tests::figure_3_1())), faces_of_figure);
  EXPECT_TRUE(decoded_faces(2, faces_of_figure) == tests::figure_3_1());
}

TEST(CuberilleFaces, AreThoseOfAPlainArrayAndBoundTheSameObject) {
  tests::for_each_subject([](const tests::Dense& dense, const Octree& octree) {
    const CuberilleFaces faces = cuberille_faces(octree);
    for (int number = 0; number < direction_count; ++number) {
      std::vector<glm::ivec3> expected;
      const glm::ivec3 across = step(static_cast<Direction>(number));
      dense.for_each([&](const glm::ivec3& v) {
        const glm::ivec3 n = v + across;
        const bool outside = glm::any(glm::lessThan(n, glm::ivec3(0))) ||
                             glm::any(glm::greaterThanEqual(n, glm::ivec3(dense.side)));
        if (dense.at(v) != 0 && (outside || dense.at(n) == 0)) expected.push_back(v);
      });
      ASSERT_EQ(faces.lists[static_cast<std::size_t>(number)], expected) << "direction " << number;
    }
    ASSERT_TRUE(octree_of(faces) == octree);
    ASSERT_EQ(parse_cuberille_faces(octree.universe(), text(faces)).lists, faces.lists);
  });
}

TEST(CuberilleFaces, ReachTheFarCornersOfTheLargestUniverse) {
  for (const Octree& octree : tests::sparse_subjects()) {
    const CuberilleFaces faces = cuberille_faces(octree);
    EXPECT_TRUE(octree_of(faces) == octree);
    EXPECT_TRUE(decoded_faces(12, text(faces)) == octree);
  }
}

TEST(CuberilleFaces, DirectionsStepAlongTheirAxis) {
  EXPECT_EQ(step(Direction::PlusX), glm::ivec3(1, 0, 0));
  EXPECT_EQ(step(Direction::MinusY), glm::ivec3(0, -1, 0));
  EXPECT_EQ(step(Direction::PlusZ), glm::ivec3(0, 0, 1));
}

TEST(CuberilleFaces, ThatAreWrongAreRefusedWithTheFaceOrTheCharacter) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string lists = faces_of_figure;
    lists.replace(lists.find(from), from.size(), to);
    return refusal([&] { decoded_faces(2, lists); });
  };
  EXPECT_EQ(with("(1,2,0)", "(1;2,0)"), "cuberille, character 6: expected ',', found ';'");
  EXPECT_EQ(with("(1,2,0)", "(1,4,0)"), "cuberille, character 7: a number of at most 3 was expected");
  // The thesis's own misprint, a lost face of each kind, one too many, and two that changed places.
  EXPECT_EQ(with("(0,3,0), (3,1,1)", "(0,3,0), (3,0,1)"),
            "cuberille, x- face of voxel (3,0,1): no x+ face ends its run");
  EXPECT_EQ(with("x+ (1,2,0), ", "x+ "), "cuberille, x- face of voxel (0,2,0): no x+ face ends its run");
  EXPECT_EQ(with("x- (0,2,0), ", "x- "), "cuberille, x+ face of voxel (1,2,3): no x- face begins its run");
  EXPECT_EQ(with("y+ (0,3,0), ", "y+ "),
            "cuberille, y+ face of voxel (0,3,0): is missing: the x faces make it part of the boundary");
  EXPECT_EQ(with("z- (0,2,0)", "z- (3,0,0), (0,2,0)"),
            "cuberille, z- face of voxel (3,0,0): is not on the boundary of the object between the x faces");
  EXPECT_EQ(with("z- (0,2,0), (1,2,0)", "z- (1,2,0), (0,2,0)"),
            "cuberille, z- face of voxel (0,2,0): does not come after its predecessor, x fastest");
  CuberilleFaces outside{universe_of(2), {}};
  outside.lists[0].emplace_back(0, 0, -1);
  EXPECT_NE(refusal([&] { octree_of(outside); }).find("outside the universe"), std::string::npos);
}

TEST(CuberilleFaces, MutatedAreRefusedOrAnotherObject) {
  // Each object has one text, and hardly any mutation of it is another's: the empty object's are let in by
  // spaces alone.
  tests::fuzz_text(
      faces_of_figure, "cuberille", "0123(), xyz+-\n",
      [](const std::string& lists) { return decoded_faces(2, lists); },
      [](const Octree& octree) { return text(cuberille_faces(octree)); });
}

}  // namespace
}  // namespace octotomy::voxel
