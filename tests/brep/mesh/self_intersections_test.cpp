// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/self_intersections.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <tbb/global_control.h>

#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

using FacePairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
constexpr std::size_t all = 1'000'000;

/// The triangles without area, exact for lattice points below 2^20.
std::vector<std::uint8_t> without_area(const Triangles& t) {
  std::vector<std::uint8_t> marks;
  for (const auto& [a, b, c] : t.faces)
    marks.push_back(glm::cross(t.points_mm[b] - t.points_mm[a], t.points_mm[c] - t.points_mm[a]) ==
                    glm::dvec3(0.0));
  return marks;
}

SelfIntersections found(const Triangles& t, std::size_t most_first = all) {
  const MortonTree tree(t);
  const std::vector<std::uint8_t> degenerate = without_area(t);
  return self_intersections({t, tree, degenerate, most_first});
}

/// Whether two triangles meet elsewhere, by exact predicates without our filter.
bool meet_elsewhere(const Triangles& t, std::array<std::uint32_t, 3> f, std::array<std::uint32_t, 3> g) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  const auto point = [&](std::uint32_t v) {
    return Kernel::Point_3(t.points_mm[v].x, t.points_mm[v].y, t.points_mm[v].z);
  };
  const auto triangle = [&](const auto& of) {
    return Kernel::Triangle_3(point(of[0]), point(of[1]), point(of[2]));
  };
  const auto last = [&](const auto& of) { return Kernel::Segment_3(point(of[1]), point(of[2])); };
  // Shared corners first.
  const auto shared =
      std::partition(f.begin(), f.end(),
                     [&](std::uint32_t v) { return std::find(g.begin(), g.end(), v) != g.end(); }) -
      f.begin();
  std::partition(g.begin(), g.end(),
                 [&](std::uint32_t v) { return std::find(f.begin(), f.end(), v) != f.end(); });
  if (shared == 0) return CGAL::do_intersect(triangle(f), triangle(g));
  if (shared == 1)
    return CGAL::do_intersect(triangle(f), last(g)) || CGAL::do_intersect(triangle(g), last(f));
  if (shared == 3) return true;
  const auto p = point(f[0]), q = point(f[1]), r = point(f[2]), s = point(g[2]);
  return CGAL::coplanar(p, q, r, s) && CGAL::coplanar_orientation(p, q, r, s) == CGAL::POSITIVE;
}

FacePairs one_by_one(const Triangles& t) {
  const std::vector<std::uint8_t> degenerate = without_area(t);
  FacePairs pairs;
  for (std::uint32_t f = 0; f < t.faces.size(); ++f)
    for (std::uint32_t g = f + 1; g < t.faces.size(); ++g)
      if (degenerate[f] == 0 && degenerate[g] == 0 && meet_elsewhere(t, t.faces[f], t.faces[g]))
        pairs.emplace_back(f, g);
  return pairs;
}

/// A flat fan of triangles about point 0 on a lattice, one for each pair of neighbouring rim points.
Triangles fan(std::uint32_t count) {
  Triangles t;
  t.points_mm.push_back({0, 0, 0});
  for (std::uint32_t k = 0; k <= count; ++k) {
    const double angle = 6.0 * k / count;
    t.points_mm.push_back({std::round(1e5 * std::cos(angle)), std::round(1e5 * std::sin(angle)), 0});
    if (k > 0) t.faces.push_back({0, k, k + 1});
  }
  return t;
}

TEST(SelfIntersections, AFanOfManyTrianglesHasNone) {
  EXPECT_EQ(found(fan(500)).count, 0u);
}

TEST(SelfIntersections, AFanThatOverlapsItselfMeetsAtTheOverlap) {
  Triangles t = fan(100);
  t.points_mm.push_back({-70000, 3000, 10});
  t.points_mm.push_back({70000, 3000, -10});
  t.faces.push_back({0, 102, 103});
  EXPECT_EQ(found(t).first, one_by_one(t));
  EXPECT_GT(found(t).count, 0u);
}

TEST(SelfIntersections, ABladeThroughAFanIsFound) {
  Triangles t = fan(200);
  const auto v = static_cast<std::uint32_t>(t.points_mm.size());
  t.points_mm.insert(t.points_mm.end(), {{-90000, -5, -7}, {90000, 11, -7}, {0, 0, 100}});
  t.faces.push_back({v, v + 1, v + 2});
  const SelfIntersections crossing = found(t);
  EXPECT_EQ(crossing.first, one_by_one(t));
  EXPECT_GT(crossing.count, 1u);
}

TEST(SelfIntersections, TrianglesAboutHubsMeetAsEachPairSays) {
  std::size_t meeting = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    std::mt19937 random(seed);
    // Few places, so that triangles are coplanar, equal, without area and of both hubs at times. No two points
    // are at one place, as they would count as one corner.
    std::uniform_int_distribution<int> place(-3, 3), number(0, 39), hub(0, 4);
    Triangles t;
    while (t.points_mm.size() < 40) {
      const glm::dvec3 p(place(random), place(random), place(random));
      if (std::find(t.points_mm.begin(), t.points_mm.end(), p) == t.points_mm.end()) t.points_mm.push_back(p);
    }
    const auto any = [&] { return static_cast<std::uint32_t>(number(random)); };
    for (int k = 0; k < 220; ++k) {
      const int of = hub(random);
      t.faces.push_back({of > 3 ? any() : static_cast<std::uint32_t>(of / 2), any(), any()});
    }
    for (const std::uint32_t of : {0u, 1u})
      ASSERT_GE(
          std::count_if(t.faces.begin(), t.faces.end(), [&](const auto& face) { return face[0] == of; }), 64);
    const SelfIntersections crossing = found(t);
    EXPECT_EQ(crossing.first, one_by_one(t)) << "seed " << seed;
    EXPECT_EQ(crossing.count, crossing.first.size()) << "seed " << seed;
    meeting += crossing.count;
  }
  EXPECT_GT(meeting, 0u);
}

TEST(SelfIntersections, FarFromTheOriginAFanIsTheSame) {
  Triangles t = fan(100);
  t.faces.push_back({0, 20, 50});
  const SelfIntersections here = found(t);
  for (glm::dvec3& p : t.points_mm) p += glm::dvec3(1 << 30, -(1 << 30), 1 << 20);
  EXPECT_EQ(found(t).first, here.first);
  EXPECT_GT(here.count, 0u);
}

TEST(SelfIntersections, TheFirstAreKeptOfMany) {
  Triangles t;
  t.points_mm = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  t.faces.assign(90, {0, 1, 2});
  const SelfIntersections crossing = found(t, 100);
  EXPECT_EQ(crossing.count, 90u * 89u / 2);
  FacePairs first = one_by_one(t);
  first.resize(100);
  EXPECT_EQ(crossing.first, first);
}

TEST(SelfIntersections, ThreadsDoNotChangeTheAnswer) {
  Triangles t = shapes::together(fan(300), fan(200));
  for (std::size_t v = 302; v < t.points_mm.size(); ++v) t.points_mm[v].z = t.points_mm[v].x / 4 + 1000;
  const SelfIntersections many = found(t, 100);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const SelfIntersections single = found(t, 100);
  EXPECT_GT(many.count, 100u);
  EXPECT_EQ(many.count, single.count);
  EXPECT_EQ(many.first, single.first);
}

TEST(SelfIntersections, BoxesThatTouchAtACornerOrAlongASideHaveNone) {
  const Triangles box = shapes::box({0, 0, 0}, {2, 2, 2});
  for (const glm::dvec3& low : {glm::dvec3(2, 2, 2), glm::dvec3(2, 2, 0), glm::dvec3(-2, 2, 0)})
    EXPECT_EQ(found(shapes::together(box, shapes::box(low, low + 2.0))).count, 0u) << low.x << low.y << low.z;
}

TEST(SelfIntersections, ACornerOrASideInTheMiddleOfATriangleIsFound) {
  const Triangles box = shapes::box({0, 0, 0}, {4, 4, 4});
  EXPECT_GT(found(shapes::together(box, shapes::box({4, 4, 1}, {6, 6, 3}))).count, 0u);
  EXPECT_GT(found(shapes::together(box, shapes::box({4, 4, 4}, {3, 3, 3}))).count, 0u);
}

/// Two pyramids upon each other about a common triangle, with apexes on the z axis.
Triangles two_pyramids(double low, double high) {
  return {{{4, 0, 0}, {-2, 3, 0}, {-2, -3, 0}, {0, 0, low}, {0, 0, high}},
          {{0, 1, 4}, {1, 2, 4}, {2, 0, 4}, {1, 0, 3}, {2, 1, 3}, {0, 2, 3}}};
}

TEST(SelfIntersections, SolidsThatShareOnlySidesAndOverlapMeetOnceASide) {
  ASSERT_EQ(found(two_pyramids(-2, 2)).count, 0u);
  // The upper half of the second lies within the first one's, its lower half outside.
  EXPECT_EQ(found(shapes::together(two_pyramids(-1, 3), two_pyramids(-2, 2))).count, 3u);
  // Within the first one as a whole it is a shell in a solid, which has alternating sides only if it is turned.
  EXPECT_EQ(found(shapes::together(two_pyramids(-3, 3), two_pyramids(-2, 2))).count, 3u);
  EXPECT_EQ(found(shapes::together(two_pyramids(-3, 3), shapes::inside_out(two_pyramids(-2, 2)))).count, 0u);
}

TEST(SelfIntersections, SidesThatLieOnEachOtherAreFound) {
  const Triangles box = shapes::box({0, 0, 0}, {2, 2, 2});
  EXPECT_GT(found(shapes::together(box, shapes::box({2, 0, 0}, {4, 2, 2}))).count, 0u);
}

}  // namespace
}  // namespace octotomy::brep
