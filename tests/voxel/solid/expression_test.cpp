// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/expression.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <random>
#include <stdexcept>

#include "tests/unit_universe.h"
#include "voxel/solid/combine.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

const Universe universe_of_32 = tests::universe_about_origin(5);

Names names() {
  Names result;
  result.object = [](std::string_view name) -> Expression {
    if (name == "a") return Sphere{{-4, 0, 0}, 7};
    if (name == "b") return Sphere{{4, 0, 0}, 7};
    if (name == "c") return Box{{-9, -3, -3}, {9, 12, 3}};
    throw InvalidInput("nothing is called '" + std::string(name) + "'");
  };
  result.motion = [](std::string_view name) {
    if (name != "up") throw InvalidInput("no motion is called '" + std::string(name) + "'");
    Motion motion;
    motion.translate_mm = {0, 0, 5};
    return moved_from_still(motion);
  };
  return result;
}

Octree evaluated(std::string_view text) {
  return combine(universe_of_32, parse_expression(text, names()));
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

// Labels that undo names(): primitives are told apart by where they are.
Labels labels() {
  Labels result;
  result.object = [](const Expression::Leaf& leaf) -> std::string {
    if (const auto* sphere = std::get_if<Sphere>(&leaf)) return sphere->centre_mm.x < 0 ? "a" : "b";
    return "c";
  };
  result.motion = [](const glm::dmat4&) { return "up"; };
  return result;
}

// Every bracket written out: two expressions of one structure and no others have it in common.
std::string structure(const Expression::Term& term) {
  using Kind = Expression::Kind;
  switch (term.kind) {
    case Kind::Leaf:
      return labels().object(*term.leaf);
    case Kind::Not:
      return "~(" + structure(*term.left) + ")";
    case Kind::Moved:
      return "move(" + structure(*term.left) + ")";
    default:
      return "(" + structure(*term.left) + std::to_string(static_cast<int>(term.kind)) +
             structure(*term.right) + ")";
  }
}

Expression random_expression(std::mt19937_64& random, int depth) {
  const auto choice = random() % (depth == 0 ? 3 : 10);
  const auto inner = [&] { return random_expression(random, depth - 1); };
  switch (choice) {
    case 0:
      return names().object("a");
    case 1:
      return names().object("b");
    case 2:
      return names().object("c");
    case 3:
      return ~inner();
    case 4:
      return moved(inner(), names().motion("up"));
    case 5:
      return inner() & inner();
    case 6:
      return inner() | inner();
    case 7:
      return inner() ^ inner();
    default:
      return inner() - inner();
  }
}

TEST(PrintExpression, IsReadBackAsTheSameTerms) {
  std::size_t brackets = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    std::mt19937_64 random(seed);
    const Expression expression = random_expression(random, 6);
    const std::string text = print_expression(expression, labels());
    ASSERT_EQ(structure(parse_expression(text, names()).term()), structure(expression.term()))
        << "seed " << seed << ": " << text;
    brackets += text.find('(') != std::string::npos;
  }
  EXPECT_GT(brackets, 500U);
}

TEST(PrintExpression, BracketsNoMoreThanItTakes) {
  for (const char* text : {"a | b & c", "(a | b) & c", "a - b - c", "a - (b - c)", "~a & b", "~(a & b)",
                           "move(a | b, up) - c", "a ^ b | c", "a ^ (b | c)"})
    EXPECT_EQ(print_expression(parse_expression(text, names()), labels()), text);
}

// Names joined by one operator, which is read from the left: a tree as deep as it is long.
std::string long_text(std::size_t count, const std::string& joint) {
  std::string text = "a";
  for (std::size_t i = 1; i < count; ++i) text += joint + "abc"[i % 3];
  return text;
}

constexpr std::size_t many_terms = 50'000;

TEST(ParseExpression, OfFiftyThousandOperandsIsPrintedEvaluatedAndDropped) {
  const std::map<std::string, Expression> objects{
      {"a", Sphere{{-4, 0, 0}, 7}}, {"b", Sphere{{4, 0, 0}, 7}}, {"c", Box{{-9, -3, -3}, {9, 12, 3}}}};
  Names shared = names();
  shared.object = [&](std::string_view name) { return objects.at(std::string(name)); };
  const std::string text = long_text(many_terms, " | ");
  const Expression expression = parse_expression(text, shared);
  EXPECT_EQ(print_expression(expression, labels()), text);
  EXPECT_TRUE(combine(universe_of_32, expression) == evaluated("a | b | c"));
  EXPECT_EQ(names_in(text), (std::vector<std::string>{"a", "b", "c"}));
  // An even number of each leaves nothing of an exclusive or.
  EXPECT_TRUE(combine(universe_of_32, parse_expression(long_text(6 * many_terms, " ^ "), shared)).is_empty());
}

TEST(Expression, OfFiftyThousandDifferentOperandsIsEvaluated) {
  const Universe small = universe_around({{-8, -8, -8}, {8, 8, 8}}, 1.0);
  Expression expression = HalfSpace{{0, 0, 1}, -100};
  for (std::size_t i = 1; i < many_terms; ++i)
    expression = expression | HalfSpace{{0, 0, 1}, -100 + 100.0 * static_cast<double>(i) / many_terms};
  EXPECT_TRUE(combine(small, expression) == combine(small, HalfSpace{{0, 0, 1}, -0.002}));
}

TEST(Expression, NestedFiftyThousandDeepToTheRightIsEvaluatedAndDropped) {
  const Expression a = names().object("a");
  const Expression b = names().object("b");
  Expression deep = a;
  for (std::size_t i = 0; i < many_terms; ++i) deep = b - deep;
  for (std::size_t i = 0; i < many_terms; ++i) deep = ~deep;
  for (std::size_t i = 0; i < many_terms; ++i) deep = moved(deep, glm::dmat4(1.0));
  // b - (b - (b - ... a)) alternates between b & a and b - a.
  EXPECT_TRUE(combine(universe_of_32, deep) == evaluated("b & a"));
  EXPECT_GT(print_expression(deep, labels()).size(), 8 * many_terms);
}

TEST(Expression, OfMoreOperandsThanAWalkMeetsIsRefusedWithTheirNumber) {
  Expression doubled = names().object("a");
  for (int i = 0; i < 60; ++i) doubled = doubled | doubled;
  try {
    combine(universe_of_32, doubled);
    FAIL() << "walked 2^60 operands";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Input);
    EXPECT_NE(std::string(error.what()).find("4194304"), std::string::npos);
  }
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
  EXPECT_EQ(carried(a, scaled).term().moved_from_still, scaled);
  for (const double factor : {0.0, std::numeric_limits<double>::infinity(), std::nan("")}) {
    glm::dmat4 wrong(1.0);
    wrong[1][1] = factor;
    EXPECT_THROW(carried(a, wrong), std::invalid_argument) << factor;
  }
  glm::dmat4 flat(1.0);
  flat[1] = flat[0];
  EXPECT_THROW(carried(a, flat), std::invalid_argument);
  EXPECT_EQ(carried(a, mirrored).term().moved_from_still, reflected(a, mirrored).term().moved_from_still);
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
