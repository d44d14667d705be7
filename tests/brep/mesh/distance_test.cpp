// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/distance.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <set>
#include <tbb/global_control.h>

#include "brep/mesh/halving.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

std::vector<glm::dvec3> random_points(std::size_t count, double reach, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-reach, reach);
  std::vector<glm::dvec3> points(count);
  for (glm::dvec3& p : points) p = {uniform(random), uniform(random), uniform(random)};
  return points;
}

double distance_to_box(const glm::dvec3& p, const glm::dvec3& half) {
  const glm::dvec3 q = glm::abs(p) - half;
  const double outside = glm::length(glm::max(q, glm::dvec3(0.0)));
  return outside > 0.0 ? outside : std::abs(std::max({q.x, q.y, q.z}));
}

TEST(Segment, IsNearestAtAnEndOrBetweenAndOneWithoutLengthIsAPoint) {
  const glm::dvec3 a(1, 0, 0), b(5, 0, 0);
  EXPECT_EQ(squared_distance_to_segment({3, 3, 4}, a, b), 25.0);
  EXPECT_EQ(squared_distance_to_segment({-2, 4, 0}, a, b), 25.0);
  EXPECT_EQ(squared_distance_to_segment({8, 0, -4}, a, b), 25.0);
  EXPECT_EQ(squared_distance_to_segment({1, 3, 4}, a, a), 25.0);
  EXPECT_EQ(squared_distance_to_segment({0, 3, 4}, {0, 0, 0}, {1e-200, 0, 0}), 25.0);
}

TEST(SurfaceTree, ABoxsDistancesAndInsideHaveClosedForms) {
  const glm::dvec3 half(1, 2, 3);
  const SurfaceTree tree(mesh_of(shapes::box(-half, half)));
  const auto points = random_points(5000, 4.0, 1);
  const auto distances = tree.distances_mm(points);
  const auto inside = tree.inside(points);
  int inside_count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(distances[i], distance_to_box(points[i], half), 1e-14) << "point " << i;
    const glm::dvec3 q = glm::abs(points[i]) - half;
    EXPECT_EQ(inside[i] != 0, std::max({q.x, q.y, q.z}) < 0.0) << "point " << i;
    inside_count += inside[i];
  }
  EXPECT_GT(inside_count, 100);
}

TEST(SurfaceTree, RaysThroughEdgesAndVerticesCountOnce) {
  // Octahedra: rays along x from these points run into vertices and along edges.
  Triangles t;
  t.points_mm = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  t.faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  const SurfaceTree tree(t);
  const auto inside = tree.inside({{0, 0, 0},
                                   {-0.5, 0, 0},
                                   {-2, 0, 0},
                                   {-2, 0.5, 0},
                                   {-2, 0, 0.5},
                                   {-2, 0, 1},
                                   {-2, 1, 0},
                                   {0, 0.25, 0},
                                   {0, 0, 0.25},
                                   {2, 0, 0}});
  EXPECT_EQ(inside, (std::vector<std::uint8_t>{1, 1, 0, 0, 0, 0, 0, 1, 1, 0}));
}

TEST(SurfaceTree, CrossingsTellEnteringFromLeaving) {
  const SurfaceTree tree(shapes::box({0, 0, 0}, {1, 1, 1}));
  const auto crossings = tree.crossings({-1, 0.25, 0.5});
  ASSERT_EQ(crossings.size(), 2u);
  EXPECT_NE(crossings[0].leaving, crossings[1].leaving);
  const auto from_inside = tree.crossings({0.5, 0.25, 0.5});
  ASSERT_EQ(from_inside.size(), 1u);
  EXPECT_TRUE(from_inside[0].leaving);
  EXPECT_GE(from_inside[0].face, 10u);  // the last two triangles of a box face +x
}

TEST(SurfaceTree, ASphereOfManyTrianglesAgreesWithEveryTriangleAskedAloneHoweverFarAwayItIs) {
  for (const glm::dvec3& centre : {glm::dvec3(0.1, 0.2, 0.3), glm::dvec3(1e6, -2e6, 3e5)}) {
    const Triangles sphere = shapes::sphere(centre, 1, 3);
    const SurfaceTree tree(sphere);
    auto points = random_points(50, 2.0, 2);
    for (glm::dvec3& p : points) p += centre;
    points.emplace_back(0.0, 0.0, 0.0);
    const auto distances = tree.distances_mm(points);
    std::vector<double> nearest(points.size(), INFINITY);
    for (const auto& face : sphere.faces) {
      Triangles one;
      one.points_mm = sphere.points_mm;
      one.faces = {face};
      const auto alone = SurfaceTree(one).distances_mm(points);
      for (std::size_t i = 0; i < points.size(); ++i) nearest[i] = std::min(nearest[i], alone[i]);
    }
    EXPECT_EQ(distances, nearest);
    const auto inside = tree.inside(points);
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_EQ(inside[i] != 0, is_inside(points[i], sphere)) << "point " << i;
  }
}

TEST(SurfaceTree, OnePointIsAnsweredAsManyAre) {
  const SurfaceTree tree(shapes::sphere({0.1, 0.2, 0.3}, 1, 3));
  const auto points = random_points(500, 1.5, 6);
  const std::vector<Foot> feet = tree.feet(points);
  const auto inside = tree.inside(points);
  std::uint32_t near = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Foot foot = tree.foot(points[i], near);
    EXPECT_EQ(foot.distance_mm, feet[i].distance_mm) << "point " << i;
    EXPECT_NEAR(glm::length(foot.p_mm - feet[i].p_mm), 0.0, 1e-7) << "point " << i;
    EXPECT_EQ(tree.is_inside(points[i]), inside[i] != 0) << "point " << i;
  }
}

TEST(SurfaceTree, ASegmentIsAskedAboutAllTrianglesThatItMeetsAndFewOthers) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  const auto exact = [](const glm::dvec3& p) { return Kernel::Point_3(p.x, p.y, p.z); };
  for (const glm::dvec3& centre : {glm::dvec3(0.1, 0.2, 0.3), glm::dvec3(1e6, -2e6, 3e5)}) {
    const Triangles sphere = shapes::sphere(centre, 1, 4);
    const SurfaceTree tree(sphere, SurfaceTree::Build::ForSegments);
    std::vector<std::pair<glm::dvec3, glm::dvec3>> segments;
    const auto points = random_points(400, 1.5, 5);
    for (std::size_t i = 0; i + 1 < points.size(); i += 2) {
      const glm::dvec3 from = centre + points[i], to = centre + points[i + 1];
      const auto& corners = sphere.points_mm;
      segments.emplace_back(from, to);
      segments.emplace_back(from, from + 0.05 * (to - from));
      segments.emplace_back(from, glm::dvec3(to.x, from.y, from.z));
      segments.emplace_back(from, corners[i % corners.size()]);
      segments.emplace_back(corners[i % corners.size()], corners[(7 * i + 1) % corners.size()]);
      const auto& face = sphere.faces[3 * i % sphere.faces.size()];
      segments.emplace_back(corners[face[0]], corners[face[1]]);
    }
    std::size_t met = 0, asked_about = 0;
    for (const auto& [from, to] : segments) {
      std::set<std::uint32_t> asked;
      EXPECT_FALSE(tree.meets_any(from, to, [&](std::uint32_t face) {
        asked.insert(face);
        return false;
      }));
      asked_about += asked.size();
      const Kernel::Segment_3 segment(exact(from), exact(to));
      for (std::uint32_t f = 0; f < sphere.faces.size(); ++f) {
        const auto& [a, b, c] = sphere.faces[f];
        const Kernel::Triangle_3 triangle(exact(sphere.points_mm[a]), exact(sphere.points_mm[b]),
                                          exact(sphere.points_mm[c]));
        if (!CGAL::do_intersect(triangle, segment)) continue;
        ++met;
        EXPECT_TRUE(asked.contains(f)) << "triangle " << f;
        EXPECT_TRUE(tree.meets_any(from, to, [&](std::uint32_t face) { return face == f; }));
      }
    }
    EXPECT_GT(met, segments.size());
    EXPECT_LT(asked_about, 8 * met);
  }
}

TEST(SurfaceTree, SignedDistancesAreDistancesWithTheSignOfRaysWhereverASearchStarts) {
  // A box has edges and corners, where no one triangle decides; the ball within is a cavity.
  const Triangles surface = shapes::together(shapes::box({-4, -5, -6}, {4, 5, 6}),
                                             shapes::inside_out(shapes::sphere({0.1, 0.2, 0.3}, 3.0, 3)));
  const SurfaceTree tree(surface);
  std::vector<glm::dvec3> points = random_points(20000, 8.0, 7);
  for (const glm::dvec3& p : surface.points_mm) points.insert(points.end(), {p, 1.1 * p, p + 1e-9});
  const std::vector<double> distances = tree.distances_mm(points);
  const std::vector<std::uint8_t> inside = tree.inside(points);
  std::vector<std::uint32_t> nearest(points.size(), SurfaceTree::unknown_triangle);
  for (int round = 0; round < 2; ++round) {
    const std::vector<double> found = tree.signed_distances_mm(points, nearest);
    for (std::size_t i = 0; i < points.size(); ++i)
      ASSERT_EQ(found[i], inside[i] != 0 ? -distances[i] : distances[i]) << i;
    std::reverse(nearest.begin(), nearest.end());
  }
  EXPECT_GT(std::count(inside.begin(), inside.end(), 1), 1000);
}

TEST(SurfaceTree, ThreadsDoNotChangeTheBits) {
  const SurfaceTree tree(shapes::sphere({0, 0, 0}, 1, 4));
  const auto points = random_points(2000, 1.5, 3);
  const auto many = tree.distances_mm(points);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(tree.distances_mm(points), many);
}

TEST(SurfaceTree, OfNothingHasNoDistanceAndNoInside) {
  const SurfaceTree tree{Triangles{}};
  EXPECT_THROW(tree.distances_mm({{0, 0, 0}}), std::invalid_argument);
  EXPECT_EQ(tree.inside({{0, 0, 0}}), std::vector<std::uint8_t>{0});
  EXPECT_FALSE(tree.is_inside({0, 0, 0}));
  EXPECT_FALSE(tree.meets_any({0, 0, 0}, {1, 1, 1}, [](std::uint32_t) { return true; }));
}

/// The search by which SurfaceTree's answers are defined: one box and one triangle at a time.
class PlainSearch {
 public:
  explicit PlainSearch(const Triangles& surface)
      : surface_(surface), nodes_(halving_nodes(static_cast<std::uint32_t>(surface.faces.size()), 4)) {
    for (std::uint32_t f = 0; f < surface.faces.size(); ++f) {
      const auto [low, high] = box_of(f);
      items_.push_back({0.5 * low + 0.5 * high, f});
    }
    halve(
        items_, 4,
        [&](std::uint32_t self, std::uint32_t begin, std::uint32_t end) {
          nodes_[self].first = begin;
          nodes_[self].count = end - begin;
          for (std::uint32_t i = begin; i < end; ++i) nodes_[self].add(box_of(items_[i].number));
        },
        [&](std::uint32_t self, std::uint32_t second) {
          nodes_[self].first = second;
          for (const std::uint32_t half : {self + 1, second}) nodes_[self].add(nodes_[half].box);
        },
        0, 0, static_cast<std::uint32_t>(items_.size()));
  }

  /// Returns the face; the search starts with, and leaves, the place of a triangle among the leaves.
  std::uint32_t nearest(const glm::dvec3& p, std::uint32_t& place) const {
    double squared = squared_to(p, place);
    visit(p, 0, squared, place);
    return items_[place].number;
  }

 private:
  using Box = std::pair<glm::dvec3, glm::dvec3>;
  struct Node {
    Box box{glm::dvec3(INFINITY), glm::dvec3(-INFINITY)};
    std::uint32_t first = 0, count = 0;
    void add(const Box& other) {
      box = {glm::min(box.first, other.first), glm::max(box.second, other.second)};
    }
    double squared_to(const glm::dvec3& p) const {
      const glm::dvec3 d = glm::max(glm::max(box.first - p, p - box.second), glm::dvec3(0.0));
      return glm::dot(d, d);
    }
  };
  const glm::dvec3& corner(std::uint32_t face, std::size_t k) const {
    return surface_.points_mm[surface_.faces[face][k]];
  }
  Box box_of(std::uint32_t face) const {
    const glm::dvec3 &a = corner(face, 0), &b = corner(face, 1), &c = corner(face, 2);
    return {glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))};
  }
  double squared_to(const glm::dvec3& p, std::uint32_t place) const {
    const std::uint32_t face = items_[place].number;
    const glm::dvec3 &a = corner(face, 0), &b = corner(face, 1), &c = corner(face, 2);
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double normal2 = glm::dot(normal, normal);
    const double v = glm::dot(glm::cross(p - a, c - a), normal),
                 w = glm::dot(glm::cross(b - a, p - a), normal);
    if (normal2 > 0.0 && v >= 0.0 && w >= 0.0 && v + w <= normal2) {
      const double height = glm::dot(p - a, normal);
      return height * height / normal2;
    }
    const auto to_side = [&](const glm::dvec3& from, const glm::dvec3& to) {
      const glm::dvec3 along = to - from;
      const double length2 = glm::dot(along, along);
      const double share = length2 > 0.0 ? std::clamp(glm::dot(p - from, along) / length2, 0.0, 1.0) : 0.0;
      const glm::dvec3 d = p - (from + share * along);
      return glm::dot(d, d);
    };
    return std::min({to_side(a, b), to_side(b, c), to_side(c, a)});
  }
  void visit(const glm::dvec3& p, std::uint32_t node, double& squared, std::uint32_t& place) const {
    const Node& own = nodes_[node];
    for (std::uint32_t i = own.first; i < own.first + own.count; ++i)
      if (const double here = squared_to(p, i); here < squared) squared = here, place = i;
    if (own.count > 0) return;
    std::array<std::uint32_t, 2> halves{node + 1, own.first};
    if (nodes_[halves[1]].squared_to(p) < nodes_[halves[0]].squared_to(p)) std::swap(halves[0], halves[1]);
    for (const std::uint32_t half : halves) visit(p, half, squared, place);
  }

  const Triangles& surface_;
  std::vector<Node> nodes_;
  std::vector<Centred> items_;
};

TEST(SurfaceTree, OfTrianglesEquallyNearItNamesTheOneThatAPlainSearchMeetsFirst) {
  for (const Triangles& surface :
       {shapes::sphere({0.1, 0.2, 0.3}, 1, 3), shapes::box({-1, -1, -1}, {1, 1, 1}),
        shapes::together(shapes::sphere({0, 0, 0}, 1, 2), shapes::sphere({0, 0, 0}, 1, 2))}) {
    std::vector<glm::dvec3> points = surface.points_mm;  // each as near to all triangles about it
    for (const auto& face : surface.faces)
      points.push_back(0.6 * (surface.points_mm[face[0]] + surface.points_mm[face[1]]));
    for (const glm::dvec3& p : random_points(300, 2.0, 3)) points.push_back(p);
    const std::vector<Foot> feet = SurfaceTree(surface).feet(points);
    const PlainSearch plain(surface);
    std::uint32_t place = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (i % 256 == 0) place = 0;  // as SurfaceTree's blocks do
      ASSERT_EQ(feet[i].face, plain.nearest(points[i], place)) << "point " << i;
    }
  }
}

}  // namespace
}  // namespace octotomy::brep
