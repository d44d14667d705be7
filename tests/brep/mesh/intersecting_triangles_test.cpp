// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/intersecting_triangles.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <gtest/gtest.h>
#include <random>
#include <set>
#include <tbb/global_control.h>

#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// Every triangle against every other.
IntersectingTriangles by_all_pairs(const Triangles& a, const Triangles& b) {
  const auto exact = [](const Triangles& t, std::size_t f) {
    const auto point = [&](std::size_t k) {
      const glm::dvec3& p = t.points_mm[t.faces[f][k]];
      return Kernel::Point_3(p.x, p.y, p.z);
    };
    return Kernel::Triangle_3(point(0), point(1), point(2));
  };
  std::set<std::uint32_t> of_a, of_b;
  for (std::uint32_t f = 0; f < a.faces.size(); ++f)
    for (std::uint32_t g = 0; g < b.faces.size(); ++g)
      if (CGAL::do_intersect(exact(a, f), exact(b, g))) {
        of_a.insert(f);
        of_b.insert(g);
      }
  return {{of_a.begin(), of_a.end()}, {of_b.begin(), of_b.end()}};
}

TEST(IntersectingTriangles, AreThoseThatAllPairsFind) {
  std::size_t found = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> any(-1.5, 1.5);
    const Triangles a = shapes::sphere({0, 0, 0}, 1.0, 2);
    const Triangles b = seed % 2 == 0 ? shapes::sphere({any(random), any(random), any(random)}, 0.8, 2)
                                      : shapes::box({any(random), any(random), any(random)}, {2, 2, 2});
    const IntersectingTriangles ours = intersecting_triangles(a, b), all = by_all_pairs(a, b);
    EXPECT_EQ(ours.of_a, all.of_a) << "seed " << seed;
    EXPECT_EQ(ours.of_b, all.of_b) << "seed " << seed;
    found += all.of_a.size();
  }
  EXPECT_GT(found, 100u);
}

TEST(IntersectingTriangles, TouchingCountsAndSurfacesApartDoNot) {
  const Triangles a = shapes::box({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(intersecting_triangles(a, shapes::box({1, 1, 1}, {2, 2, 2})).of_a,
            by_all_pairs(a, shapes::box({1, 1, 1}, {2, 2, 2})).of_a);
  EXPECT_FALSE(intersecting_triangles(a, shapes::box({1, 0, 0}, {2, 1, 1})).of_a.empty());
  EXPECT_TRUE(intersecting_triangles(a, shapes::box({1.000001, 0, 0}, {2, 1, 1})).of_a.empty());
  EXPECT_TRUE(intersecting_triangles(a, shapes::box({0.25, 0.25, 0.25}, {0.5, 0.5, 0.5})).of_b.empty());
  EXPECT_TRUE(intersecting_triangles(a, Triangles()).of_a.empty());
}

TEST(IntersectingTriangles, ThreadsDoNotChangeThem) {
  const Triangles a = shapes::sphere({0, 0, 0}, 1.0, 4), b = shapes::sphere({0.7, 0.1, 0.2}, 1.0, 4);
  const IntersectingTriangles many = intersecting_triangles(a, b);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const IntersectingTriangles alone = intersecting_triangles(a, b);
  EXPECT_EQ(many.of_a, alone.of_a);
  EXPECT_EQ(many.of_b, alone.of_b);
  EXPECT_GT(many.of_a.size(), 50u);
}

}  // namespace
}  // namespace octotomy::brep
