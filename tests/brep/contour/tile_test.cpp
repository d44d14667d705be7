// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/contour/tile.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <random>

#include "brep/mesh/error.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {
namespace {

constexpr TileCost all_costs[] = {TileCost::shortest_span, TileCost::least_area, TileCost::greatest_volume,
                                  TileCost::least_angle};

Ring ellipse(double a, double b, int points, double z, const glm::dvec2& centre = {0, 0}, double turn = 0.0) {
  Ring ring;
  ring.z_mm = z;
  for (int k = 0; k < points; ++k) {
    const double t = turn + 2.0 * std::numbers::pi * k / points;
    ring.points_mm.push_back(centre + glm::dvec2(a * std::cos(t), b * std::sin(t)));
  }
  return ring;
}

/// A star-shaped ring of uneven steps.
Ring wobbly(std::mt19937& random, double z) {
  std::uniform_real_distribution<double> any(0.0, 1.0);
  const int count = 8 + static_cast<int>(random() % 30);
  Ring ring;
  ring.z_mm = z;
  for (int k = 0; k < count; ++k) {
    const double t = 2.0 * std::numbers::pi * (k + 0.8 * any(random)) / count;
    ring.points_mm.push_back((4.0 + any(random)) * glm::dvec2(std::cos(t), std::sin(t)));
  }
  return ring;
}

struct Sums {
  double area = 0.0, cones = 0.0, angle = 0.0;
};

/// Cones have their tip at the lower ring's first point, so the flat ends add nothing, or always the same.
Sums sums_of(const Ring& lower, const Ring& upper, const std::vector<std::array<std::uint32_t, 3>>& faces) {
  const auto at = [&](std::uint32_t v) {
    return v < lower.points_mm.size() ? glm::dvec3(lower.points_mm[v], lower.z_mm)
                                      : glm::dvec3(upper.points_mm[v - lower.points_mm.size()], upper.z_mm);
  };
  Sums sums;
  glm::dvec3 last(0.0);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const glm::dvec3 a = at(faces[f][0]), b = at(faces[f][1]), c = at(faces[f][2]);
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    sums.area += 0.5 * glm::length(normal);
    sums.cones += glm::dot(a - at(0), normal) / 6.0;
    if (f > 0)
      sums.angle += std::acos(std::clamp(glm::dot(glm::normalize(last), glm::normalize(normal)), -1.0, 1.0));
    last = normal;
  }
  return sums;
}

TEST(Tile, EveryCostGivesAClosedStripThatRunsAlongBothRingsOnce) {
  for (const TileCost cost : all_costs) {
    std::mt19937 random(7);
    const Ring lower = wobbly(random, 0.0), upper = wobbly(random, 1.5);
    const auto faces = tile(lower, upper, cost);
    const std::size_t m = lower.points_mm.size(), n = upper.points_mm.size();
    ASSERT_EQ(faces.size(), m + n);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> ways;
    for (const auto& face : faces)
      for (std::size_t k = 0; k < 3; ++k) ++ways[{face[k], face[(k + 1) % 3]}];
    std::size_t border = 0;
    for (const auto& [way, count] : ways) {
      EXPECT_EQ(count, 1);
      border += !ways.contains({way.second, way.first});
    }
    EXPECT_EQ(border, m + n);
    // Sides of the lower ring are run along forwards and of the upper one backwards: the outside is out.
    for (std::uint32_t i = 0; i < m; ++i) EXPECT_EQ((ways[{i, static_cast<std::uint32_t>((i + 1) % m)}]), 1);
  }
}

TEST(Tile, EachCostIsTheLeastOfItsKind) {
  int differ = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937 random(seed);
    const Ring lower = wobbly(random, 0.0), upper = wobbly(random, 1.0);
    std::map<TileCost, Sums> sums;
    for (const TileCost cost : all_costs) sums[cost] = sums_of(lower, upper, tile(lower, upper, cost));
    for (const TileCost cost : all_costs) {
      EXPECT_LE(sums[TileCost::least_area].area, sums[cost].area * (1 + 1e-12)) << "seed " << seed;
      EXPECT_GE(sums[TileCost::greatest_volume].cones, sums[cost].cones * (1 - 1e-12)) << "seed " << seed;
    }
    // Both start at the same span.
    EXPECT_LE(sums[TileCost::least_angle].angle, sums[TileCost::shortest_span].angle + 1e-6)
        << "seed " << seed;
    differ += sums[TileCost::least_area].area < sums[TileCost::shortest_span].area * (1 - 1e-6);
    differ += sums[TileCost::greatest_volume].cones > sums[TileCost::shortest_span].cones * (1 + 1e-6);
    differ += sums[TileCost::least_angle].angle < sums[TileCost::shortest_span].angle - 1e-3;
  }
  EXPECT_GT(differ, 60);
}

/// The least area of all strips, computed separately from every start.
double least_area_by_trial(const Ring& lower, const Ring& upper) {
  const std::size_t m = lower.points_mm.size(), n = upper.points_mm.size();
  const auto on = [](const Ring& ring, std::size_t k) {
    return glm::dvec3(ring.points_mm[k % ring.points_mm.size()], ring.z_mm);
  };
  const auto area = [](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return 0.5 * glm::length(glm::cross(b - a, c - a));
  };
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t start = 0; start < n; ++start) {
    std::vector<std::vector<double>> to(m + 1,
                                        std::vector<double>(n + 1, std::numeric_limits<double>::infinity()));
    to[0][0] = 0.0;
    for (std::size_t i = 0; i <= m; ++i)
      for (std::size_t j = 0; j <= n; ++j) {
        const glm::dvec3 p = on(lower, i), q = on(upper, start + j);
        if (i > 0) to[i][j] = std::min(to[i][j], to[i - 1][j] + area(on(lower, i - 1), p, q));
        if (j > 0) to[i][j] = std::min(to[i][j], to[i][j - 1] + area(on(upper, start + j - 1), q, p));
      }
    least = std::min(least, to[m][n]);
  }
  return least;
}

TEST(Tile, LeastAreaIsTheLeastOfAllStartsTheShapesAsideToo) {
  int elsewhere = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    std::mt19937 random(1000 + seed);
    const Ring lower = wobbly(random, 0.0);
    Ring upper = wobbly(random, 1.0 + seed % 3);
    // Laid over each other by their boxes, thin and thick have other starts than by area.
    for (glm::dvec2& p : upper.points_mm)
      p = glm::dvec2(0.3 + 0.1 * (seed % 5), 1.0) * p + glm::dvec2(seed % 4, 2.0);
    const auto faces = tile(lower, upper, TileCost::least_area);
    const double least = least_area_by_trial(lower, upper), found = sums_of(lower, upper, faces).area;
    EXPECT_NEAR(found, least, 1e-12 * least) << "seed " << seed;
    elsewhere += faces.front()[0] != 0 || faces.front()[2] != lower.points_mm.size();
  }
  EXPECT_GT(elsewhere, 30);
}

TEST(Tile, NearTheShortestSpansABandOfNoPointIsTheirStripAndAWiderOneCostsLess) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 20; ++trial) {
    const Ring lower = wobbly(random, 0.0), upper = wobbly(random, 1.5);
    const auto shortest = tile(lower, upper, TileCost::shortest_span);
    for (const TileCost cost : all_costs) EXPECT_EQ(tile_near(lower, upper, cost, 0), shortest) << trial;
    const Sums of_shortest = sums_of(lower, upper, shortest);
    double area = of_shortest.area, angle = of_shortest.angle;
    for (const std::size_t band : {1u, 2u, 4u, 64u}) {
      const double narrow = sums_of(lower, upper, tile_near(lower, upper, TileCost::least_area, band)).area;
      const double flat = sums_of(lower, upper, tile_near(lower, upper, TileCost::least_angle, band)).angle;
      EXPECT_LE(narrow, area + 1e-9) << trial << ", " << band;
      EXPECT_LE(flat, angle + 1e-6) << trial << ", " << band;
      area = narrow;
      angle = flat;
    }
    EXPECT_LE(sums_of(lower, upper, tile(lower, upper, TileCost::least_area)).area, area + 1e-9) << trial;
    EXPECT_EQ(tile_near(lower, upper, TileCost::least_angle, 64), tile(lower, upper, TileCost::least_angle));
  }
}

TEST(Tile, AConesAreaIsItsClosedForm) {
  // Regular polygons of as many points, one turned by half a step: an antiprism.
  const Ring lower = ellipse(3, 3, 64, 0.0), upper = ellipse(2, 2, 64, 2.0, {0, 0}, std::numbers::pi / 64);
  const double cone = std::numbers::pi * 5.0 * std::sqrt(1.0 + 4.0);
  for (const TileCost cost : all_costs)
    EXPECT_NEAR(sums_of(lower, upper, tile(lower, upper, cost)).area, cone, 2e-3 * cone);
}

TEST(Tile, AShiftedShapeIsMatchedByShape) {
  // The same ellipse far aside: every span is the shift.
  const Ring lower = ellipse(6, 2, 40, 0.0), upper = ellipse(6, 2, 40, 1.0, {50, 20});
  for (const auto& face : tile(lower, upper, TileCost::shortest_span)) {
    std::uint32_t on_lower = 0, on_upper = 0;
    for (const std::uint32_t v : face) (v < 40 ? on_lower : on_upper) = v % 40;
    EXPECT_LE((on_upper + 40 - on_lower) % 40 % 39, 1u);
  }
}

TEST(Tile, RefusesWhatIsNoRing) {
  const Ring ring = ellipse(1, 1, 8, 0.0);
  EXPECT_THROW(tile(ring, {{{0, 0}, {1, 1}}, 1.0}, TileCost::least_area), std::invalid_argument);
  EXPECT_THROW(tile(ring, ellipse(1, 1, 8, 0.0), TileCost::least_area), std::invalid_argument);
}

TEST(Tile, RefusesRingsWhoseTablesWouldNotFitTheMemory) {
  for (const TileCost cost : {TileCost::least_area, TileCost::greatest_volume, TileCost::least_angle}) try {
      tile(ellipse(1, 1, 30000, 0.0), ellipse(1, 1, 30000, 1.0), cost);
      ADD_FAILURE() << "done";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Resource);
    }
}

std::vector<std::array<std::uint32_t, 3>> clear(const Ring& lower, const Ring& upper, TileCost cost,
                                                const SpanClearance& sides) {
  std::vector<std::uint8_t> scores;
  return tile_clear(lower, upper, cost, sides, scores);
}

TEST(TileClear, KeepsToTheAreaBetweenTheRingsWhateverTheCost) {
  // A ring with a deep bay around another ring that follows it: the strip of greatest volume closes the bay.
  const auto bay = [](double out, double z) {
    Ring made{{}, z};
    for (int k = 0; k < 80; ++k) {
      const double t = 2.0 * M_PI * k / 80,
                   depth = std::exp(-t * t * 3.0) + std::exp(-(t - 2.0 * M_PI) * (t - 2.0 * M_PI) * 3.0);
      made.points_mm.push_back((out + 10.0 - 7.0 * depth) * glm::dvec2(std::cos(t), std::sin(t)));
    }
    return made;
  };
  const Ring lower = bay(1.0, 0.0), upper = bay(0.0, 1.0);
  const SpanClearance sides({{lower.points_mm}}, {{upper.points_mm}});
  const auto crossed = [&](const std::vector<std::array<std::uint32_t, 3>>& faces) {
    int count = 0;
    for (const auto& face : faces)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t a = face[k], b = face[(k + 1) % 3], m = lower.points_mm.size();
        if (a < m && b >= m) count += sides.crossed(lower.points_mm[a], upper.points_mm[b - m], 6);
      }
    return count;
  };
  for (const TileCost cost : all_costs) EXPECT_EQ(crossed(clear(lower, upper, cost, sides)), 0);
  const auto best = clear(lower, upper, TileCost::greatest_volume, sides);
  EXPECT_GT(crossed(tile(lower, upper, TileCost::greatest_volume)), 0) << "the bay matters";
  // Among the clear strips it is the best by its cost, as far as the other strips can show.
  for (const TileCost cost : all_costs) {
    const auto other = clear(lower, upper, cost, sides);
    EXPECT_GE(sums_of(lower, upper, best).cones, sums_of(lower, upper, other).cones * (1 - 1e-12));
    EXPECT_LE(sums_of(lower, upper, clear(lower, upper, TileCost::least_area, sides)).area,
              sums_of(lower, upper, other).area * (1 + 1e-12));
  }
}

bool has_double_span(const std::vector<std::array<std::uint32_t, 3>>& faces) {
  std::map<std::array<std::uint32_t, 2>, int> edges;
  for (const auto& face : faces)
    for (std::size_t k = 0; k < 3; ++k)
      if (++edges[{face[k], face[(k + 1) % 3]}] > 1) return true;
  return false;
}

TEST(Tile, TheBestClearStripIsASurfaceWhereTwoConesHaveLessArea) {
  const Ring lower = ellipse(1.0, 1.0, 4, 0.0), upper = ellipse(0.9, 1.1, 6, 5.0, {1.2, 0.1});
  const SpanClearance sides({{lower.points_mm}}, {{upper.points_mm}});
  EXPECT_TRUE(has_double_span(tile(lower, upper, TileCost::least_area))) << "the cones matter";
  const auto best = clear(lower, upper, TileCost::least_area, sides);
  EXPECT_EQ(best.size(), 10u);
  EXPECT_FALSE(has_double_span(best));
}

TEST(Tile, TrianglesToAvoidAreAvoidedByEachCostWhereOthersAreAsClear) {
  std::mt19937 random(3);
  const Ring lower = wobbly(random, 0.0), upper = wobbly(random, 1.5);
  const SpanClearance sides({{lower.points_mm}}, {{upper.points_mm}});
  for (const TileCost cost : all_costs) {
    std::vector<std::uint8_t> scores;
    const auto before = tile_clear(lower, upper, cost, sides, scores);
    EXPECT_EQ(tile_clear(lower, upper, cost, sides, scores), before) << "with all scores that were kept";
    const std::vector<std::array<std::uint32_t, 3>> avoided(8, before[3]);
    const auto after = tile_clear(lower, upper, cost, sides, scores, avoided);
    EXPECT_EQ(after.size(), before.size());
    EXPECT_EQ(std::count(after.begin(), after.end(), before[3]), 0) << static_cast<int>(cost);
    EXPECT_FALSE(has_double_span(after)) << static_cast<int>(cost);
  }
}

}  // namespace
}  // namespace octotomy::brep
