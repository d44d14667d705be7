// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/expression.h"

#include <gtest/gtest.h>
#include <stdexcept>

#include "voxel/combine.h"

namespace octotomy::voxel {
namespace {

const Universe universe = universe_around({{-16, -16, -16}, {16, 16, 16}}, 1.0);

Names names() {
  Names result;
  result.object = [](std::string_view name) -> Expression {
    if (name == "a") return Sphere{{-4, 0, 0}, 7};
    if (name == "b") return Sphere{{4, 0, 0}, 7};
    if (name == "c") return Box{{-9, -3, -3}, {9, 12, 3}};
    throw std::invalid_argument("nothing is called '" + std::string(name) + "'");
  };
  result.motion = [](std::string_view name) {
    if (name != "up") throw std::invalid_argument("no motion is called '" + std::string(name) + "'");
    Motion motion;
    motion.translate_mm = {0, 0, 5};
    return moved_from_still(motion);
  };
  return result;
}

Octree evaluated(std::string_view text) {
  return combine(universe, parse_expression(text, names()));
}

std::string refusal(std::string_view text) {
  try {
    parse_expression(text, names());
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ParseExpression, BindsTildeThenMinusThenAndThenXorThenOr) {
  EXPECT_TRUE(evaluated("a | b & c") == evaluated("a | (b & c)"));
  EXPECT_FALSE(evaluated("a | b & c") == evaluated("(a | b) & c"));
  EXPECT_TRUE(evaluated("a & b - c") == evaluated("a & (b - c)"));
  EXPECT_TRUE(evaluated("a - b - c") == evaluated("(a - b) - c"));
  EXPECT_FALSE(evaluated("a - b - c") == evaluated("a - (b - c)"));
  EXPECT_TRUE(evaluated("a ^ b | c") == evaluated("(a ^ b) | c"));
  EXPECT_TRUE(evaluated("a ^ b & c") == evaluated("a ^ (b & c)"));
  EXPECT_TRUE(evaluated("~a & b") == evaluated("(~a) & b"));
  EXPECT_FALSE(evaluated("~a & b") == evaluated("~(a & b)"));
}

TEST(ParseExpression, MovesAnyPartOfAnExpression) {
  const Octree moved_lens = evaluated("(a - c) | move(a & b, up)");
  EXPECT_TRUE(moved_lens == evaluated("a - c | move(a, up) & move(b, up)"));
  EXPECT_TRUE(moved_lens.contains({16, 16, 23}));
  EXPECT_FALSE(evaluated("a & b").contains({16, 16, 23}));
}

TEST(ParseExpression, SaysWhereAndWhatItExpected) {
  EXPECT_EQ(refusal("a & "), "expression \"a & \", character 5: expected a name, '~', 'move(' or '('");
  EXPECT_EQ(refusal("(a | b"), "expression \"(a | b\", character 7: expected ')'");
  EXPECT_EQ(refusal("a b"), "expression \"a b\", character 3: expected an operator & | - ^ or the end");
  EXPECT_EQ(refusal("a & skul"), "expression \"a & skul\", character 5: nothing is called 'skul'");
  EXPECT_EQ(refusal("move(a, down)"),
            "expression \"move(a, down)\", character 9: no motion is called 'down'");
  EXPECT_EQ(refusal("move(a)"), "expression \"move(a)\", character 7: expected ',' and the name of a motion");
  EXPECT_EQ(refusal(""), "expression \"\", character 1: expected a name, '~', 'move(' or '('");
  EXPECT_NE(refusal(std::string(100000, '(')).find("nested more than 200 deep"), std::string::npos);
  EXPECT_NE(refusal(std::string(100000, '~')).find("nested more than 200 deep"), std::string::npos);
}

TEST(NamesIn, ListsEachObjectOnceInOrderAndNoMotion) {
  EXPECT_EQ(names_in("(skull - cut) | move(skull & cut, advance)"),
            (std::vector<std::string>{"skull", "cut"}));
  EXPECT_THROW(names_in("skull &"), std::invalid_argument);
}

TEST(Moved, RefusesWhatIsNotRigid) {
  const Expression a = Sphere{};
  glm::dmat4 scaled(1.0);
  scaled[0][0] = 1.001;
  EXPECT_THROW(moved(a, scaled), std::invalid_argument);
  glm::dmat4 mirrored(1.0);
  mirrored[0][0] = -1.0;
  EXPECT_THROW(moved(a, mirrored), std::invalid_argument);
}

TEST(MovedFromStill, TurnsAboutThePointAndThenTranslates) {
  Motion motion;
  motion.degrees = 90;
  motion.axis = {0, 0, 2};
  motion.about_mm = {10, 0, 0};
  motion.translate_mm = {0, 0, 3};
  const glm::dvec3 p(moved_from_still(motion) * glm::dvec4(11, 0, 0, 1));
  EXPECT_NEAR(glm::distance(p, glm::dvec3(10, 1, 3)), 0.0, 1e-14);
  motion.axis = {0, 0, 0};
  EXPECT_THROW(moved_from_still(motion), std::invalid_argument);
}

TEST(RegionMask, SaysWhichPolygonOfWhichRegionIsWrong) {
  const auto refusal_of = [](const RegionMask& mask) -> std::string {
    try {
      check(mask);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  RegionMask mask;
  EXPECT_EQ(refusal_of(mask), "a mask needs at least one region drawn in a view");
  mask.regions.push_back({parse_view("left"), {{{0, 0}, {1, 0}, {0, 1}}}});
  EXPECT_EQ(refusal_of(mask), "accepted");
  mask.regions.push_back({parse_view("anterior"), {{{0, 0}, {1, 0}, {0, 1}}, {{0, 0}, {1, 1}}}});
  EXPECT_EQ(refusal_of(mask), "polygon 2 of region 2 of the mask has 2 points: draw at least three");
  mask.regions.back().polygons_mm.back() = {{0, 0}, {1, 1}, {3, 3}};
  EXPECT_EQ(refusal_of(mask), "polygon 2 of region 2 of the mask encloses no area");
}

}  // namespace
}  // namespace octotomy::voxel
