// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/morton_tree.h"

#include <gtest/gtest.h>
#include <mutex>
#include <random>
#include <set>
#include <utility>

namespace octotomy::brep {
namespace {

/// Triangles of one unit's size in a cube of ten, some at one place.
Triangles scattered(unsigned seed, std::size_t count) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0.0, 10.0), size(-0.5, 0.5);
  Triangles triangles;
  for (std::size_t f = 0; f < count; ++f) {
    const glm::dvec3 at =
        f % 7 == 6 ? triangles.points_mm[0] : glm::dvec3(place(random), place(random), place(random));
    const auto first = static_cast<std::uint32_t>(triangles.points_mm.size());
    for (int k = 0; k < 3; ++k)
      triangles.points_mm.push_back(at + glm::dvec3(size(random), size(random), size(random)));
    triangles.faces.push_back({first, first + 1, first + 2});
  }
  return triangles;
}

OuterBox box_of(const Triangles& triangles, std::uint32_t face) {
  OuterBox box;
  for (const std::uint32_t v : triangles.faces[face]) box.add(triangles.points_mm[v]);
  return box;
}

using Pairs = std::multiset<std::pair<std::uint32_t, std::uint32_t>>;

TEST(MortonTree, FindsEachPairOfOverlappingBoxesOnce) {
  for (const std::size_t count : {0u, 1u, 3u, 5u, 400u}) {
    const Triangles triangles = scattered(static_cast<unsigned>(count), count);
    Pairs found, expected;
    std::mutex guard;
    MortonTree(triangles).visit_own_pairs([&](std::uint32_t f, std::uint32_t g) {
      const std::lock_guard lock(guard);
      found.insert(std::minmax(f, g));
    });
    for (std::uint32_t f = 0; f < count; ++f)
      for (std::uint32_t g = f + 1; g < count; ++g)
        if (box_of(triangles, f).overlaps(box_of(triangles, g))) expected.emplace(f, g);
    EXPECT_EQ(found, expected) << count << " triangles";
  }
}

TEST(MortonTree, FindsThePairsOfTwoSurfacesAndOfSomeOfTheirTriangles) {
  const Triangles a = scattered(1, 300), b = scattered(2, 20);
  const std::vector<std::uint32_t> some{3, 4, 17, 19};
  Pairs found, expected;
  std::mutex guard;
  MortonTree(a).visit_pairs(MortonTree(b, some), [&](std::uint32_t f, std::uint32_t g) {
    const std::lock_guard lock(guard);
    found.emplace(f, g);
  });
  for (std::uint32_t f = 0; f < 300; ++f)
    for (const std::uint32_t g : some)
      if (box_of(a, f).overlaps(box_of(b, g))) expected.emplace(f, g);
  EXPECT_FALSE(expected.empty());
  EXPECT_EQ(found, expected);
}

TEST(MortonTree, VisitsWhatABoxReaches) {
  const Triangles triangles = scattered(3, 500);
  OuterBox room;
  room.add({2.0, 3.0, 4.0});
  room.add({4.0, 5.0, 6.0});
  std::set<std::uint32_t> found, expected;
  MortonTree(triangles).visit([&](const OuterBox& box) { return box.overlaps(room); },
                              [&](std::uint32_t f) { EXPECT_TRUE(found.insert(f).second); });
  for (std::uint32_t f = 0; f < 500; ++f)
    if (box_of(triangles, f).overlaps(room)) expected.insert(f);
  EXPECT_FALSE(expected.empty());
  EXPECT_EQ(found, expected);
}

TEST(MortonOrder, IsACurveThroughCubesAndPartsAtTheirFaces) {
  // The eight corners of a cube, given from the last, in the order x, then y, then z.
  std::vector<glm::dvec3> corners;
  for (int i = 7; i >= 0; --i) corners.emplace_back(i & 1, (i >> 1) & 1, i >> 2);
  const MortonOrder order = morton_order(corners);
  EXPECT_EQ(order.numbers, (std::vector<std::uint32_t>{7, 6, 5, 4, 3, 2, 1, 0}));
  EXPECT_EQ(order.split(0, 8), 4u);
  EXPECT_EQ(order.split(0, 7), 4u);
  EXPECT_EQ(order.split(3, 5), 4u);
  EXPECT_EQ(morton_order({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}}).split(0, 4), 2u);
}

TEST(OuterBox, IsNeverInsideOfItsPoints) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(-1e3, 1e3);
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 p(place(random), 1e-30 * place(random), 1e30 * place(random));
    OuterBox box;
    box.add(p);
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_LE(box.low[axis], p[axis]);
      ASSERT_GE(box.high[axis], p[axis]);
      ASSERT_LE(box.high[axis], std::nextafter(box.low[axis], std::numeric_limits<float>::infinity()));
    }
  }
}

}  // namespace
}  // namespace octotomy::brep
