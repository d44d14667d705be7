// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/polygon_overlaps.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace octotomy::voxel {
namespace {

using Outline = std::vector<glm::dvec2>;

constexpr double rounding_mm = 0.01;

Outline ring(const glm::dvec2& centre_mm, double radius_mm, int points = 96) {
  Outline outline;
  for (int i = 0; i < points; ++i) {
    const double turn = 2 * std::numbers::pi * i / points;
    outline.push_back(centre_mm + radius_mm * glm::dvec2(std::cos(turn), std::sin(turn)));
  }
  return outline;
}

Outline upright_box(const glm::dvec2& low, const glm::dvec2& high) {
  return {low, {high.x, low.y}, high, {low.x, high.y}};
}

/// As a file of two decimals holds it.
Outline rounded_to_hundredths(Outline outline, double off = 0.0) {
  for (glm::dvec2& p : outline) p = glm::round((p + off) * 100.0) / 100.0;
  return outline;
}

std::vector<std::size_t> crossing(const std::vector<Outline>& outlines) {
  const CrossingPolygons found = crossing_polygons(outlines, rounding_mm);
  EXPECT_TRUE(found.is_complete);
  std::vector<std::size_t> numbers;
  for (const CrossingPolygon& each : found.all) numbers.push_back(each.polygon);
  return numbers;
}

using Numbers = std::vector<std::size_t>;

TEST(PolygonOverlaps, TheSameLineRepeatsWhereverItBeginsAndWhicheverWayItRuns) {
  const Outline first = ring({3, -70}, 20);
  Outline turned = first, back = first, closed = first, between = first;
  std::rotate(turned.begin(), turned.begin() + 31, turned.end());
  std::reverse(back.begin(), back.end());
  closed.push_back(closed.front());
  between.insert(between.begin() + 1, 0.5 * (first[0] + first[1]));
  EXPECT_EQ(repeated_polygons({first, turned, ring({3, -70}, 8), back, closed, between,
                               rounded_to_hundredths(first), ring({3, -70}, 8)},
                              rounding_mm),
            (Numbers{1, 3, 4, 5, 6, 7}));
}

TEST(PolygonOverlaps, LinesThatDifferByMoreThanTheRoundingDoNotRepeat) {
  EXPECT_EQ(repeated_polygons({ring({0, 0}, 20), ring({0, 0}, 20.02), ring({0.02, 0}, 20), ring({0, 0}, 10)},
                              rounding_mm),
            Numbers{});
  // One box, of which two corners are cut in turn: bounds, area and centre are the same.
  EXPECT_EQ(repeated_polygons({{{0, 2}, {2, 0}, {10, 0}, {10, 8}, {8, 10}, {0, 10}},
                               {{0, 0}, {8, 0}, {10, 2}, {10, 10}, {2, 10}, {0, 8}}},
                              rounding_mm),
            Numbers{});
  // Small ones are judged by their own size.
  EXPECT_EQ(repeated_polygons({ring({0, 0}, 0.02), ring({0, 0}, 0.015)}, rounding_mm), Numbers{});
}

TEST(PolygonOverlaps, ContoursThatCrossAreFoundHoweverFinelyTheyAreDrawn) {
  for (const int points : {12, 96, 5000})
    EXPECT_EQ(crossing({ring({0, 0}, 20, points), ring({0.3, 0}, 20, points), ring({0, 0}, 5)}),
              (Numbers{0, 1}))
        << points;
  // No corner of either lies in the other, or sides lie on each other.
  EXPECT_EQ(crossing({upright_box({-10, -2}, {10, 2}), upright_box({-2, -10}, {2, 10})}), (Numbers{0, 1}));
  EXPECT_EQ(crossing({upright_box({0, 0}, {10, 10}), upright_box({5, 0}, {15, 10})}), (Numbers{0, 1}));
  // Of many, all that cross and no other.
  EXPECT_EQ(crossing({ring({0, 0}, 9), ring({40, 0}, 9), ring({8, 0}, 9), ring({80, 0}, 9), ring({8, 8}, 9)}),
            (Numbers{0, 2, 4}));
}

TEST(PolygonOverlaps, NestedTouchingAndApartAreNoCrossing) {
  EXPECT_EQ(crossing({ring({0, 0}, 20), ring({0, 0}, 10), ring({5, 0}, 4), ring({30, 0}, 5)}), Numbers{});
  // They share a side, a part of one, or a corner; a hole touches from within.
  EXPECT_EQ(
      crossing({upright_box({0, 0}, {10, 10}), upright_box({10, 0}, {20, 10}), upright_box({20, 3}, {30, 5}),
                upright_box({30, 5}, {40, 9}), upright_box({0, 3}, {5, 5})}),
      Numbers{});
  // Neighbours whose common side was rounded.
  EXPECT_EQ(crossing({rounded_to_hundredths({{0, 0}, {10.004, 0.3}, {9.996, 5}, {10.003, 9}, {0, 9}}),
                      rounded_to_hundredths({{10, 0.3}, {20, 0}, {20, 9}, {10, 9}, {10, 4}})}),
            Numbers{});
}

TEST(PolygonOverlaps, AKeyholeIsNoCrossingAndALoopIs) {
  // An outline, in by a channel, a hole the other way round, and back by the same channel or one beside it.
  for (const double aside : {0.0, 0.004, -0.004}) {
    Outline keyhole = ring({0, 0}, 20);
    keyhole.push_back({20, 0});
    Outline hole = ring({0, 0}, 10);
    std::reverse(hole.begin(), hole.end());
    keyhole.push_back({10, aside});
    keyhole.insert(keyhole.end(), hole.begin(), hole.end());
    keyhole.push_back({10, 0});
    keyhole.push_back({20, aside});
    EXPECT_EQ(crossing({keyhole}), Numbers{}) << aside;
  }
  // A limacon encloses its inner loop twice; an eight has two lobes.
  Outline limacon, eight;
  for (int i = 0; i < 400; ++i) {
    const double turn = 2 * std::numbers::pi * i / 400;
    limacon.push_back((5.0 + 10.0 * std::cos(turn)) * glm::dvec2(std::cos(turn), std::sin(turn)));
    eight.push_back({10.0 * std::sin(turn + 0.01), 5.0 * std::sin(2.0 * turn + 0.02)});
  }
  EXPECT_EQ(crossing({limacon}), Numbers{0});
  EXPECT_EQ(crossing({eight}), Numbers{0});
  EXPECT_EQ(crossing({{{0, 0}, {10, 10}, {10, 0}, {0, 10}}}), Numbers{0});
}

TEST(PolygonOverlaps, ManyPointsAndManyContoursTakeNoSquareOfThem) {
  EXPECT_EQ(crossing({ring({0, 0}, 200, 100000), ring({0, 0}, 150, 100000)}), Numbers{});
  std::vector<Outline> grid;
  for (int y = 0; y < 70; ++y)
    for (int x = 0; x < 70; ++x) grid.push_back(upright_box({3 * x, 3 * y}, {3 * x + 3, 3 * y + 3}));
  EXPECT_EQ(crossing(grid), Numbers{});
  EXPECT_EQ(repeated_polygons(grid, rounding_mm), Numbers{});
  std::vector<Outline> twice = grid;
  twice.insert(twice.end(), grid.begin(), grid.end());
  EXPECT_EQ(repeated_polygons(twice, rounding_mm).size(), grid.size());
  // Long edges that all lie over each other end the search, which says so.
  Outline comb;
  for (int i = 0; i < 20000; ++i) comb.push_back({i * 1e-3 + (i % 2) * 500.0, i % 2 * 500.0});
  comb.push_back({1000, -1});
  EXPECT_FALSE(crossing_polygons({comb}, 1e-7).is_complete);
}

}  // namespace
}  // namespace octotomy::voxel
