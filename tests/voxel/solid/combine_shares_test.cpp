// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/combine_shares.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <utility>

#include "tests/unit_universe.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/digitise.h"

namespace octotomy::voxel {
namespace {

using tests::universe_about_origin;

struct Pair {
  ShareOperand a, b;
};
ShareOperand operand(const Expression& solid) {
  PartialOctree partial = digitise_partial(universe_about_origin(5), solid);
  return {Expression(partial.touching), bracket_of(partial)};
}
Pair two_balls() {
  return {operand(Sphere{{-3.1, 0.2, 0.3}, 8.3}), operand(Sphere{{2.7, 1.4, -0.6}, 7.4})};
}

VolumeBracket volume(const Pair& pair, const Expression& expression) {
  return volume_mm3(combine_shares(expression, {pair.a, pair.b}));
}

TEST(CombineShares, EveryOperationBracketsTheClosedFormsShares) {
  const Pair pair = two_balls();
  const Expression a(Sphere{{-3.1, 0.2, 0.3}, 8.3}), b(Sphere{{2.7, 1.4, -0.6}, 7.4});
  const double va = volume_mm3(digitise_partial(universe_about_origin(5), a));
  const double vb = volume_mm3(digitise_partial(universe_about_origin(5), b));
  const double shared = volume_mm3(digitise_partial(universe_about_origin(5), a & b));
  const std::array<std::pair<Expression, double>, 4> truths{
      {{pair.a.symbol & pair.b.symbol, shared},
       {pair.a.symbol | pair.b.symbol, va + vb - shared},
       {pair.a.symbol - pair.b.symbol, va - shared},
       {pair.a.symbol ^ pair.b.symbol, va + vb - 2 * shared}}};
  for (const auto& [expression, truth] : truths) {
    const VolumeBracket found = volume(pair, expression);
    EXPECT_LE(found.low_mm3, truth + 0.5);
    EXPECT_GE(found.high_mm3, truth - 0.5);
    EXPECT_GT(found.half_width_mm3(), 0.0) << "both boundaries pass through some voxels";
    EXPECT_LT(found.half_width_mm3(), 0.02 * truth);
  }
}

TEST(CombineShares, WhatNoneTouchesIsNotTouched) {
  const ShareOperand a = operand(Sphere{{-8.1, 0.2, 0.3}, 5.3}), b = operand(Sphere{{7.7, 1.4, -0.6}, 4.4});
  EXPECT_TRUE(combine_shares(a.symbol & b.symbol, {a, b}).touching.is_empty());
  EXPECT_TRUE(combine_shares(a.symbol - b.symbol, {a, b}).touching == a.shares.touching);
  EXPECT_TRUE(combine_shares(a.symbol - b.symbol, {a, b}).inside == a.shares.inside);
}

TEST(CombineShares, AnAxisAlignedCutLosesItsCoherentError) {
  // Half a voxel of the cut's area is what a binary count may be off by.
  const ShareOperand ball = operand(Sphere{{0.1, 0.2, 0.3}, 10.2});
  const Expression both = Expression(Sphere{{0.1, 0.2, 0.3}, 10.2}) & HalfSpace{{0, 0, 1}, 2.45};
  const double truth = volume_mm3(digitise_partial(universe_about_origin(5), both));
  const ShareOperand half = operand(HalfSpace{{0, 0, 1}, 2.45});
  const VolumeBracket found = volume_mm3(combine_shares(ball.symbol & half.symbol, {ball, half}));
  EXPECT_LE(found.low_mm3, truth + 0.5);
  EXPECT_GE(found.high_mm3, truth - 0.5);
  const auto counted =
      static_cast<double>(combine(universe_about_origin(5),
                                  Expression(Sphere{{0.1, 0.2, 0.3}, 10.2}) & HalfSpace{{0, 0, 1}, 2.45})
                              .voxel_count());
  EXPECT_GT(std::abs(counted - truth), 100.0);
  EXPECT_LT(std::abs(found.middle_mm3() - truth), 10.0);
  EXPECT_LT(found.half_width_mm3(), 15.0);
}

TEST(CombineShares, WholeVoxelsAreCombinedAsOctreesAreAndLeaveNoInterval) {
  const ShareOperand a = operand(Box{glm::dvec3(-7.0), glm::dvec3(5.0)});
  const ShareOperand b = operand(Box{glm::dvec3(-2.0), glm::dvec3(9.0)});
  EXPECT_DOUBLE_EQ(volume_mm3(combine_shares(a.symbol & b.symbol, {a, b})).low_mm3, 343.0);
  for (const Expression& expression :
       {a.symbol & b.symbol, a.symbol | b.symbol, a.symbol - b.symbol, a.symbol ^ b.symbol, ~a.symbol}) {
    const ShareBracket found = combine_shares(expression, {a, b});
    EXPECT_EQ(found.inside, combine(universe_about_origin(5), expression));
    EXPECT_DOUBLE_EQ(volume_mm3(found).half_width_mm3(), 0.0);
  }
}

TEST(CombineShares, AComplementExchangesTheBoundsAndTwiceIsNone) {
  const Pair pair = two_balls();
  const VolumeBracket once = volume(pair, ~(pair.a.symbol & pair.b.symbol));
  const VolumeBracket shared = volume(pair, pair.a.symbol & pair.b.symbol);
  EXPECT_NEAR(once.low_mm3, 32768.0 - shared.high_mm3, 1e-6);
  EXPECT_NEAR(once.high_mm3, 32768.0 - shared.low_mm3, 1e-6);
  EXPECT_DOUBLE_EQ(volume(pair, ~~pair.a.symbol).low_mm3, volume(pair, pair.a.symbol).low_mm3);
  EXPECT_DOUBLE_EQ(volume_mm3(middle(pair.a.shares)), volume(pair, pair.a.symbol).middle_mm3());
}

TEST(CombineShares, MotionsStrangersAndOtherUniversesAreRefused) {
  const Pair pair = two_balls();
  EXPECT_THROW(combine_shares(moved(pair.a.symbol, glm::dmat4(1.0)), {pair.a}), std::invalid_argument);
  EXPECT_THROW(combine_shares(pair.a.symbol & pair.b.symbol, {pair.a}), std::invalid_argument);
  const PartialOctree coarse =
      digitise_partial(universe_around({glm::dvec3(-16.0), glm::dvec3(16.0)}, 2.0), Expression(Sphere{}));
  const ShareOperand other{Expression(coarse.touching), bracket_of(coarse)};
  EXPECT_THROW(combine_shares(pair.a.symbol & other.symbol, {pair.a, other}), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
