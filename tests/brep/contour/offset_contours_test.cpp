// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/contour/offset_contours.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

namespace octotomy::brep {
namespace {

using std::numbers::pi;

Contour rectangle(double x0, double y0, double x1, double y1) {
  return {{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}};
}
Contour reversed(Contour contour) {
  std::reverse(contour.points_mm.begin(), contour.points_mm.end());
  return contour;
}

double area(const std::vector<Contour>& contours) {
  double sum = 0;
  for (const Contour& contour : contours) sum += signed_area_mm2(contour);
  return sum;
}

/// The signed distance, negative inside, by the crossing rule over all contours.
double signed_distance(const glm::dvec2& p, const std::vector<Contour>& contours) {
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (const Contour& contour : contours)
    for (std::size_t i = 0; i < contour.points_mm.size(); ++i) {
      const glm::dvec2 a = contour.points_mm[i], b = contour.points_mm[(i + 1) % contour.points_mm.size()];
      const double t = std::clamp(glm::dot(p - a, b - a) / glm::dot(b - a, b - a), 0.0, 1.0);
      nearest = std::min(nearest, glm::distance(p, a + t * (b - a)));
      if ((a.y <= p.y) != (b.y <= p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x))
        inside = !inside;
    }
  return inside ? -nearest : nearest;
}

/// A star with waves, and a wavy hole in its middle.
std::vector<Contour> wavy(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const double lobes = 3.0 + static_cast<double>(random() % 5), depth = 0.1 + 0.25 * uniform(random);
  const auto ring = [&](double radius) {
    Contour contour;
    for (int k = 0; k < 120; ++k) {
      const double angle = 2 * pi * k / 120, r = radius * (1 + depth * std::sin(lobes * angle));
      contour.points_mm.emplace_back(r * std::cos(angle), r * std::sin(angle));
    }
    return contour;
  };
  return {ring(10), reversed(ring(4))};
}

TEST(OffsetContours, ARectangleGrowsBySteinersFormulaAndShrinksToARectangle) {
  const std::vector<Contour> one = {rectangle(1, 2, 7, 6)};
  for (const double d : {0.5, 2.0}) {
    const auto grown = offset(one, d);
    ASSERT_EQ(grown.size(), 1u);
    EXPECT_NEAR(signed_area_mm2(grown[0]), 24 + 20 * d + pi * d * d, 1e-3 * 2 * pi * d * d);
    EXPECT_NEAR(perimeter_mm(grown[0]), 20 + 2 * pi * d, 1e-3 * 2 * pi * d);
  }
  const auto shrunk = offset(one, -1.5);
  ASSERT_EQ(shrunk.size(), 1u);
  EXPECT_NEAR(area(shrunk), 3 * 1, 1e-5);
  EXPECT_TRUE(offset(one, -2.5).empty());
  EXPECT_NEAR(area(offset(one, 0)), 24, 1e-12);
}

TEST(OffsetContours, NeighboursUniteHolesFillAndNecksPart) {
  const std::vector<Contour> two = {rectangle(0, 0, 4, 4), rectangle(5, 0, 9, 4)};
  EXPECT_EQ(offset(two, 0.4).size(), 2u);
  EXPECT_EQ(offset(two, 0.6).size(), 1u);
  const std::vector<Contour> framed = {rectangle(0, 0, 10, 10), reversed(rectangle(4, 4, 6, 6))};
  const auto grown = offset(framed, 0.5);
  ASSERT_EQ(grown.size(), 2u);
  EXPECT_GT(signed_area_mm2(grown[0]), 0.0);
  EXPECT_NEAR(signed_area_mm2(grown[1]), -1, 1e-5);
  EXPECT_EQ(offset(framed, 1.5).size(), 1u);
  const std::vector<Contour> dumb_bell = {{{{0, 0},
                                            {4, 0},
                                            {4, 1.5},
                                            {6, 1.5},
                                            {6, 0},
                                            {10, 0},
                                            {10, 4},
                                            {6, 4},
                                            {6, 2.5},
                                            {4, 2.5},
                                            {4, 4},
                                            {0, 4}}}};
  EXPECT_EQ(offset(dumb_bell, -0.6).size(), 2u);
}

TEST(OffsetContours, EveryPointOfWavyRingsIsAsFarAsAskedAndNoneIsForgotten) {
  int none = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed)
    for (const double by : {0.7, -0.7, 2.5, -1.6}) {
      const std::vector<Contour> rings = wavy(seed), moved = offset(rings, by);
      none += moved.empty();
      for (const Contour& contour : moved)
        for (const glm::dvec2& p : contour.points_mm)
          ASSERT_NEAR(signed_distance(p, rings), by, 2e-3 * std::abs(by)) << "seed " << seed << " by " << by;
      // Samples of the plane detect contours that are missing.
      for (double x = -13.03; x < 13; x += 0.61)
        for (double y = -13.01; y < 13; y += 0.59) {
          const double d = signed_distance({x, y}, rings) - by;
          if (std::abs(d) < 2e-3 * std::abs(by) + 1e-9) continue;
          const bool inside = !moved.empty() && signed_distance({x, y}, moved) < 0.0;
          ASSERT_EQ(inside, d < 0.0) << "seed " << seed << " by " << by << " at " << x << ", " << y;
        }
    }
  EXPECT_LT(none, 40);
}

TEST(OffsetContours, RefusesOpenContoursAndThoseThatCrossThemselves) {
  Contour open = rectangle(0, 0, 1, 1);
  open.closed = false;
  EXPECT_THROW(offset({open}, 1), std::invalid_argument);
  EXPECT_THROW(offset({{{{0, 0}, {2, 2}, {2, 0}, {0, 2}}}}, 1), std::invalid_argument);
  EXPECT_THROW(offset({rectangle(0, 0, 1, 1)}, std::nan("")), std::invalid_argument);
  EXPECT_TRUE(offset({}, 1).empty());
}

}  // namespace
}  // namespace octotomy::brep
