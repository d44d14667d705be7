// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/io/polygons.h"

#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <random>

#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

struct Split {
  Triangles triangles;
  PolygonCounts counts;
};

Split split_of(const std::vector<glm::dvec3>& points, const std::vector<long long>& corners) {
  Split made;
  made.triangles.points_mm = points;
  PolygonSplitter(made.triangles, made.counts).add(corners);
  return made;
}
Split split_of(const std::vector<glm::dvec3>& points) {
  std::vector<long long> corners(points.size());
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<long long>(i);
  return split_of(points, corners);
}

/// The sum of the triangles' areas, which exceeds the polygon's area if triangles overlap.
double area(const Triangles& t) {
  double sum = 0.0;
  for (const auto& f : t.faces)
    sum += 0.5 * glm::length(glm::cross(t.points_mm[f[1]] - t.points_mm[f[0]],
                                        t.points_mm[f[2]] - t.points_mm[f[0]]));
  return sum;
}

/// The sides that one triangle alone has are those of the polygon, in its direction.
void expect_sides(const Triangles& t, const std::vector<long long>& corners) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  for (const auto& f : t.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::pair side{f[k], f[(k + 1) % 3]}, turned{side.second, side.first};
      if (auto found = sides.find(turned); found != sides.end() && found->second > 0)
        --found->second;
      else
        ++sides[side];
    }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::pair side{static_cast<std::uint32_t>(corners[i]),
                         static_cast<std::uint32_t>(corners[(i + 1) % corners.size()])};
    if (const auto found = sides.find(side); found != sides.end())
      --found->second;
    else
      ADD_FAILURE() << "side " << side.first << " " << side.second << " is missing";
  }
  for (const auto& [side, count] : sides) EXPECT_EQ(count, 0) << side.first << " " << side.second;
}

std::vector<long long> in_order(std::size_t count) {
  std::vector<long long> made(count);
  for (std::size_t i = 0; i < count; ++i) made[i] = static_cast<long long>(i);
  return made;
}

TEST(Polygons, AConvexOneIsTheFanFromItsFirstCorner) {
  const Split made = split_of({{0, 0, 0}, {2, 0, 0}, {3, 1, 0}, {2, 2, 0}, {0, 2, 0}});
  const std::vector<std::array<std::uint32_t, 3>> fan{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}};
  EXPECT_EQ(made.triangles.faces, fan);
  EXPECT_EQ(made.counts.polygons, 1u);
  EXPECT_EQ(made.counts.bent + made.counts.crossing + made.counts.repeating + made.counts.without_area, 0u);
}

TEST(Polygons, AnLHasItsOwnAreaWhicheverCornerComesFirst) {
  const std::vector<glm::dvec3> l{{20, 0, 3}, {20, 5, 3}, {5, 5, 3}, {5, 20, 3}, {0, 20, 3}, {0, 0, 3}};
  for (std::size_t first = 0; first < l.size(); ++first) {
    std::vector<glm::dvec3> turned = l;
    std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(first), turned.end());
    for (const bool from_below : {false, true}) {
      if (from_below) std::reverse(turned.begin(), turned.end());
      const Split made = split_of(turned);
      EXPECT_DOUBLE_EQ(area(made.triangles), 175.0);
      expect_sides(made.triangles, in_order(6));
    }
  }
}

TEST(Polygons, CornersWithinAStraightSideStayForTheNeighbours) {
  const std::vector<glm::dvec3> points{{0, 0, 0},   {1, 0, 0},     {2, 0, 0}, {3, 0, 0}, {3, 3, 0},
                                       {3, 1.5, 0}, {1.5, 1.5, 0}, {0, 3, 0}, {0, 1, 0}};
  const Split made = split_of(
      {points[0], points[1], points[2], points[3], points[5], points[4], points[6], points[7], points[8]});
  EXPECT_NEAR(area(made.triangles), 9.0 - 0.5 * 3 * 1.5, 1e-12);
  expect_sides(made.triangles, in_order(9));
  for (const auto& f : made.triangles.faces) {
    const auto& p = made.triangles.points_mm;
    EXPECT_GT(glm::cross(p[f[1]] - p[f[0]], p[f[2]] - p[f[0]]).z, 0.0);
  }
}

TEST(Polygons, AHoleJoinedByADoubleSideStaysAHole) {
  // A square of 4 with a hole of 2, both reached over the side from corner 0 to corner 4.
  const std::vector<glm::dvec3> points{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0},
                                       {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}};
  const std::vector<long long> corners{0, 1, 2, 3, 0, 4, 5, 6, 7, 4};
  const Split made = split_of(points, corners);
  EXPECT_DOUBLE_EQ(area(made.triangles), 12.0);
  EXPECT_EQ(made.triangles.faces.size(), 8u);
  EXPECT_EQ(made.counts.crossing, 0u);
}

TEST(Polygons, RandomStarsKeepTheirAreaInAnyPlane) {
  int concave = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> radius(1.0, 9.0), turn(-1.0, 1.0);
    const std::size_t count = 4 + seed % 60;
    const glm::dvec3 n = glm::normalize(glm::dvec3(turn(random), turn(random), turn(random) + 1.5));
    const glm::dvec3 u = glm::normalize(glm::cross(n, glm::dvec3(1, 0.3, 0))), v = glm::cross(n, u);
    std::vector<glm::dvec3> points;
    std::vector<glm::dvec2> flat;
    for (std::size_t i = 0; i < count; ++i) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
      flat.push_back(radius(random) * glm::dvec2(std::cos(angle), std::sin(angle)));
      points.push_back(glm::dvec3(40, -60, 10) + flat.back().x * u + flat.back().y * v);
    }
    double right = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const glm::dvec2 &a = flat[i], &b = flat[(i + 1) % count];
      right += 0.5 * (a.x * b.y - a.y * b.x);
    }
    const Split made = split_of(points);
    ASSERT_NEAR(area(made.triangles), right, 1e-9) << "seed " << seed;
    expect_sides(made.triangles, in_order(count));
    EXPECT_EQ(made.triangles.faces.size(), count - 2);
    EXPECT_EQ(made.counts.bent + made.counts.crossing, 0u) << "seed " << seed;
    double fan = 0.0;
    for (std::size_t i = 1; i + 1 < count; ++i)
      fan += 0.5 * glm::length(glm::cross(points[i] - points[0], points[i + 1] - points[0]));
    concave += fan > right + 1e-6 ? 1 : 0;
  }
  EXPECT_GT(concave, 200);
}

TEST(Polygons, ACombOfThousandsOfCornersIsFilled) {
  std::vector<glm::dvec3> comb;
  const int teeth = 2000;
  for (int i = 0; i < teeth; ++i) {
    comb.emplace_back(2 * i, 0, 0);
    comb.emplace_back(2 * i + 1, 10, 0);
  }
  comb.emplace_back(2 * teeth, 0, 0);
  comb.emplace_back(2 * teeth, 20, 0);
  comb.emplace_back(0, 20, 0);
  const Split made = split_of(comb);
  EXPECT_NEAR(area(made.triangles), 2.0 * teeth * 20.0 - teeth * 10.0, 1e-6);
  EXPECT_EQ(made.triangles.faces.size(), comb.size() - 2);
}

TEST(Polygons, WhatIsBentCrossesItselfOrHasNoAreaIsCounted) {
  const Split bent = split_of({{0, 0, 0}, {10, 0, 0}, {10, 10, 2}, {0, 10, 0}});
  EXPECT_EQ(bent.counts.bent, 1u);
  EXPECT_NEAR(bent.counts.most_bent, 0.5, 0.05);
  // Rounded to six digits, a plane is still one.
  EXPECT_EQ(split_of({{100.001, 0, 33.3333}, {110, 0, 36.6667}, {110, 10, 36.6667}, {100.001, 10, 33.3337}})
                .counts.bent,
            0u);
  const Split bow = split_of({{0, 0, 0}, {4, 4, 0}, {5, 0, 0}, {0, 3, 0}});
  EXPECT_EQ(bow.counts.crossing, 1u);
  EXPECT_EQ(bow.triangles.faces.size(), 2u);
  const Split line = split_of({{0, 0, 0}, {1, 1, 1}, {3, 3, 3}, {2, 2, 2}});
  EXPECT_EQ(line.counts.without_area, 1u);
  const Split repeated = split_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, {0, 1, 1, 2, 0});
  EXPECT_EQ(repeated.counts.repeating, 1u);
  EXPECT_EQ(repeated.triangles.faces.size(), 1u);
  for (const Split* each : {&bent, &bow, &line}) {
    bool warned = false;
    for (const MeshFinding& finding : each->counts.findings(1.0))
      warned = warned || finding.verdict == MeshVerdict::Warn;
    EXPECT_TRUE(warned);
  }
  EXPECT_THROW(split_of({{0, 0, 0}, {1, 0, 0}}, {0, 1}), Error);
  EXPECT_THROW(split_of({{0, 0, 0}, {1, 0, 0}}, {0, 1, 2, 0}), Error);
}

TEST(Polygons, AStripTurnsEverySecondTriangle) {
  Split made;
  made.triangles.points_mm = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}};
  PolygonSplitter(made.triangles, made.counts).add_strip(std::vector<long long>{0, 1, 2, 3, 3, 4});
  const std::vector<std::array<std::uint32_t, 3>> wanted{{0, 1, 2}, {2, 1, 3}};
  ASSERT_GE(made.triangles.faces.size(), 2u);
  EXPECT_EQ(made.triangles.faces[0], wanted[0]);
  EXPECT_EQ(made.triangles.faces[1], wanted[1]);
  EXPECT_DOUBLE_EQ(area(made.triangles), 1.0);
}

}  // namespace
}  // namespace octotomy::brep
