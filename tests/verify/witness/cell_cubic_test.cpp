// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/witness/cell_cubic.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "verify/phantom/chance.h"

namespace octotomy::verify {
namespace {

constexpr double endless = std::numeric_limits<double>::infinity();

double value(const Cubic& cubic, double s) {
  return cubic[0] + s * (cubic[1] + s * (cubic[2] + s * cubic[3]));
}

/// The trilinear interpolant as a sum of weighted corners.
double interpolant(const CellCorners& corners, const glm::dvec3& at) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 8; ++i)
    sum += corners[i] * (i & 1U ? at.x : 1.0 - at.x) * (i & 2U ? at.y : 1.0 - at.y) *
           (i & 4U ? at.z : 1.0 - at.z);
  return sum;
}

CellCorners noise(Chance& chance) {
  CellCorners corners;
  for (double& corner : corners) corner = chance.between(-100.0, 100.0);
  return corners;
}

glm::dvec3 point(Chance& chance) {
  return {chance.between(0.0, 1.0), chance.between(0.0, 1.0), chance.between(0.0, 1.0)};
}

TEST(CellCubic, IsTheInterpolantAlongTheLine) {
  Chance chance(1);
  for (int i = 0; i < 1000; ++i) {
    const CellCorners corners = noise(chance);
    const glm::dvec3 from = point(chance), to = point(chance);
    const Cubic cubic = cubic_along(corners, from, to);
    for (const double s : {0.0, 0.1, 0.5, 0.77, 1.0})
      EXPECT_NEAR(value(cubic, s), interpolant(corners, from + s * (to - from)), 1e-12);
  }
}

TEST(CellCubic, HasThePartsThatDenseSamplesHave) {
  Chance chance(2);
  int several = 0;
  for (int i = 0; i < 3000; ++i) {
    const CellCorners corners = noise(chance);
    const Cubic cubic = cubic_along(corners, point(chance), point(chance));
    const double low = i % 5 == 0 ? -endless : chance.between(-40.0, 10.0),
                 high = i % 7 == 0 ? endless : low + chance.between(0.0, 20.0);
    const Shares shares = shares_within(cubic, low, high);
    several += shares.count > 1 ? 1 : 0;
    for (int k = 0; k <= 1000; ++k) {
      const double s = k / 1000.0, v = value(cubic, s);
      if (std::min(std::abs(v - low), std::abs(v - high)) < 1e-9) continue;
      bool is_inside = false;
      for (const Share& share : shares) is_inside = is_inside || (s >= share.low && s <= share.high);
      EXPECT_EQ(is_inside, v >= low && v <= high) << i << ", " << s;
    }
    // Ends within the line's way lie on a bound, or join two stretches.
    for (const Share& share : shares)
      for (const double end : {share.low, share.high}) {
        const double v = value(cubic, end);
        EXPECT_GE(v, low - 1e-10);
        EXPECT_LE(v, high + 1e-10);
      }
  }
  EXPECT_GT(several, 100);
}

TEST(CellCubic, FindsAPeakThatRisesOverTheBoundByATrifle) {
  // 1 - (s - 0.4)^2, above 1 - 1e-10 for 2e-5.
  const Shares peak = shares_within({1.0 - 0.16, 0.8, -1.0, 0.0}, 1.0 - 1e-10, endless);
  ASSERT_EQ(peak.count, 2U);  // the stretches up to the extremum and behind it
  EXPECT_NEAR(peak.parts[0].low, 0.4 - 1e-5, 1e-10);
  EXPECT_EQ(peak.parts[0].high, peak.parts[1].low);
  EXPECT_NEAR(peak.parts[1].high, 0.4 + 1e-5, 1e-10);
  EXPECT_EQ(shares_within({1.0 - 0.16, 0.8, -1.0, 0.0}, 1.0 + 1e-10, endless).count, 0U);
}

TEST(CellCubic, OfLinesAndConstantsIsExact) {
  const Shares line = shares_within({-1.0, 4.0, 0.0, 0.0}, 0.0, 1.0);
  ASSERT_EQ(line.count, 1U);
  EXPECT_DOUBLE_EQ(line.parts[0].low, 0.25);
  EXPECT_DOUBLE_EQ(line.parts[0].high, 0.5);
  EXPECT_EQ(shares_within({2.0, 0.0, 0.0, 0.0}, 2.0, 2.0).count, 1U);
  EXPECT_EQ(shares_within({2.0, 0.0, 0.0, 0.0}, 2.1, 3.0).count, 0U);
  // A triple root: the slope vanishes at the crossing.
  const Shares flat = shares_within({-0.125, 0.75, -1.5, 1.0}, 0.0, endless);
  ASSERT_EQ(flat.count, 1U);
  EXPECT_NEAR(flat.parts[0].low, 0.5, 1e-5);
}

}  // namespace
}  // namespace octotomy::verify
