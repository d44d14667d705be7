// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/edge_tree.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>
#include <set>

#include "voxel/solid/polygon.h"
#include "voxel/solid/region_mask.h"

namespace octotomy::voxel {
namespace {

using Polygons = std::vector<std::vector<glm::dvec2>>;

double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random()) / 0x1p32;
}

/// Of several kinds, by seed: contours, stars, polygons on whole numbers, many small ones; up to a few
/// hundred edges.
Polygons polygons_of(unsigned seed, std::mt19937& random) {
  Polygons polygons;
  const std::size_t count = seed % 4 == 3 ? 1 + random() % 60 : random() % 4;
  for (std::size_t k = 0; k < count; ++k) {
    const glm::dvec2 centre(uniform(random, -30, 30), uniform(random, -30, 30));
    const double size = seed % 4 == 3 ? 3.0 : 25.0;
    const std::size_t points = 3 + random() % (seed % 4 == 3 ? 6 : 200);
    polygons.emplace_back();
    for (std::size_t i = 0; i < points; ++i) {
      const double turn = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(points);
      const double radius = size * (seed % 4 == 1 ? uniform(random, 0, 1) : uniform(random, 0.8, 1));
      glm::dvec2 p = centre + radius * glm::dvec2(std::cos(turn), std::sin(turn));
      if (seed % 4 == 2) p = glm::round(p / 4.0) * 4.0;  // level and upright edges, and points twice
      polygons.back().push_back(p);
    }
  }
  return polygons;
}

/// Anywhere, on a corner, at the height of one, or on an edge but for rounding.
glm::dvec2 place_about(const Polygons& polygons, std::mt19937& random) {
  glm::dvec2 p(uniform(random, -70, 70), uniform(random, -70, 70));
  if (polygons.empty()) return p;
  const auto& polygon = polygons[random() % polygons.size()];
  const glm::dvec2 corner = polygon[random() % polygon.size()];
  switch (random() % 5) {
    case 0:
      return corner;
    case 1:
      return {p.x, corner.y};
    case 2:
      return {corner.x, p.y};
    case 3:
      return 0.5 * (polygon[0] + polygon[1]);
    default:
      return p;
  }
}

TEST(EdgeTree, AnswersAsTheDefinitionsOverAllEdgesToTheBit) {
  std::size_t inside = 0, on_edges = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    const Polygons polygons = polygons_of(seed, random);
    const EdgeTree tree(polygons);
    for (int asked = 0; asked < 200; ++asked) {
      const glm::dvec2 p = place_about(polygons, random);
      double least = std::numeric_limits<double>::infinity();
      for_each_edge(polygons, [&](const glm::dvec2& a, const glm::dvec2& b) {
        least = std::min(least, square_to_segment(p, a, b));
      });
      ASSERT_EQ(tree.square_to(p), least) << "seed " << seed << " at " << p.x << ", " << p.y;
      ASSERT_EQ(tree.contains(p), contains(polygons, p)) << "seed " << seed << " at " << p.x << ", " << p.y;
      inside += contains(polygons, p);
      on_edges += least == 0.0;
    }
  }
  EXPECT_GT(inside, 4000U);
  EXPECT_GT(on_edges, 4000U);
}

TEST(EdgeTree, EdgesAboutARectangleDecideAsAllEdgesWhichOfItsPointsAreInside) {
  std::size_t fewer = 0, stand_ins = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    const Polygons polygons = polygons_of(seed, random);
    std::set<std::array<double, 4>> drawn;
    for_each_edge(polygons, [&](const glm::dvec2& a, const glm::dvec2& b) {
      drawn.insert({a.x, a.y, b.x, b.y});
    });
    const EdgeTree tree(polygons);
    for (int asked = 0; asked < 20; ++asked) {
      const glm::dvec2 one = place_about(polygons, random), other = place_about(polygons, random);
      const glm::dvec2 low = glm::min(one, other), high = glm::max(one, other);
      const std::vector<Edge> about = tree.edges_about(low, high);
      fewer += about.size() < drawn.size();
      for (const auto& [a, b] : about)
        if (!drawn.contains({a.x, a.y, b.x, b.y})) {
          ++stand_ins;
          ASSERT_TRUE(a.x == b.x && a.x > high.x) << "seed " << seed;
        }
      for (int k = 0; k < 10; ++k) {
        const glm::dvec2 p =
            k == 0   ? low
            : k == 1 ? high
                     : low + (high - low) * glm::dvec2(uniform(random, 0, 1), uniform(random, 0, 1));
        bool is_inside = false;
        for (const auto& [a, b] : about) is_inside ^= crosses_ray_from(a, b, p);
        ASSERT_EQ(is_inside, contains(polygons, p)) << "seed " << seed << " at " << p.x << ", " << p.y;
      }
    }
  }
  EXPECT_GT(fewer, 1000U);
  EXPECT_GT(stand_ins, 1000U);
}

TEST(EdgeTree, AVisitToARectangleMeetsEveryEdgeWithAPointInItByItsNumber) {
  std::size_t spared = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    std::mt19937 random(seed);
    const Polygons polygons = polygons_of(seed, random);
    const EdgeTree tree(polygons);
    const glm::dvec2 low(uniform(random, -40, 20), uniform(random, -40, 20)), high = low + 12.0;
    std::set<std::array<double, 4>> met;
    std::set<std::uint32_t> numbers;
    tree.visit(low, high, [&](const glm::dvec2& a, const glm::dvec2& b, std::uint32_t number) {
      EXPECT_TRUE(numbers.insert(number).second) << "seed " << seed;
      met.insert({a.x, a.y, b.x, b.y});
    });
    for_each_edge(polygons, [&](const glm::dvec2& a, const glm::dvec2& b) {
      bool is_within = false;
      for (int k = 0; k <= 64; ++k) {
        const glm::dvec2 p = a + k / 64.0 * (b - a);
        is_within =
            is_within || (glm::all(glm::greaterThanEqual(p, low)) && glm::all(glm::lessThanEqual(p, high)));
      }
      const bool is_met = met.contains({a.x, a.y, b.x, b.y});
      EXPECT_TRUE(is_met || !is_within) << "seed " << seed;
      spared += !is_met;
    });
  }
  EXPECT_GT(spared, 1000U);
}

TEST(EdgeTree, WithoutEdgesNothingIsNearAndNothingInside) {
  const EdgeTree tree(Polygons{{}, {}});
  EXPECT_EQ(tree.square_to({1, 2}), std::numeric_limits<double>::infinity());
  EXPECT_FALSE(tree.contains({1, 2}));
  EXPECT_TRUE(tree.edges_about({-1, -1}, {1, 1}).empty());
  EXPECT_EQ(tree.farthest_mm(), 0.0);
}

}  // namespace
}  // namespace octotomy::voxel
