// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/contour/span_clearance.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace octotomy::brep {
namespace {

Contour circle(double radius, int points) {
  Contour made;
  for (int k = 0; k < points; ++k) {
    const double t = 2.0 * M_PI * (k + 0.31) / points;
    made.points_mm.push_back(radius * glm::dvec2(std::cos(t), std::sin(t)));
  }
  return made;
}

TEST(SpanClearance, CountsTheSidesBetweenTheEndsAndNotThoseAtThem) {
  const std::vector<Contour> lower{circle(10.0, 40), circle(4.0, 16)}, upper{circle(8.0, 32)};
  const SpanClearance sides(lower, upper);
  EXPECT_EQ(sides.crossed({0, 0}, {20, 0.1}, 6), 3);
  EXPECT_EQ(sides.crossed({-20, 0.2}, {20, 0.1}, 6), 6);
  EXPECT_EQ(sides.crossed({-20, 0.2}, {20, 0.1}, 2), 2) << "no more than asked for";
  EXPECT_EQ(sides.crossed({20, 0}, {30, 7}, 6), 0) << "beside them all";
  EXPECT_EQ(sides.crossed(lower[0].points_mm[3], upper[0].points_mm[2], 6), 0) << "from point to point";
  EXPECT_EQ(sides.crossed(lower[0].points_mm[3], lower[1].points_mm[1], 6), 1);
  EXPECT_EQ(SpanClearance({}, {}).crossed({0, 0}, {1, 1}, 6), 0);
}

TEST(SpanClearance, CountsAsATestOfAllSidesDoes) {
  int crossed = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> any(-10.0, 10.0);
    Contour noise;
    for (int k = 0; k < 25; ++k) noise.points_mm.emplace_back(any(random), any(random));
    const SpanClearance sides({noise}, {});
    for (int trial = 0; trial < 100; ++trial) {
      const glm::dvec2 a(any(random), any(random)), b(any(random), any(random));
      const auto side = [](const glm::dvec2& p, const glm::dvec2& q, const glm::dvec2& r) {
        return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x) > 0.0;
      };
      int expected = 0;
      for (std::size_t k = 0; k < noise.points_mm.size(); ++k) {
        const glm::dvec2 &c = noise.points_mm[k], &d = noise.points_mm[(k + 1) % noise.points_mm.size()];
        expected += side(a, b, c) != side(a, b, d) && side(c, d, a) != side(c, d, b) ? 1 : 0;
      }
      ASSERT_EQ(sides.crossed(a, b, 16), std::min(expected, 16)) << "seed " << seed << ", trial " << trial;
      crossed += expected;
    }
  }
  EXPECT_GT(crossed, 1000);
}

}  // namespace
}  // namespace octotomy::brep
