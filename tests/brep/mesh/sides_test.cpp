// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/sides.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>
#include <tbb/task_arena.h>
#include <tuple>

namespace octotomy::brep {
namespace {

TEST(Sides, StandInTheOrderOfTheirEdgesWhateverTheTriangles) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    std::mt19937 random(seed);
    Triangles triangles;
    triangles.points_mm.resize(1 + seed);
    const auto any_point = [&] { return static_cast<std::uint32_t>(random() % (1 + seed)); };
    for (unsigned f = 0; f < 4 * seed; ++f)
      triangles.faces.push_back({any_point(), any_point(), any_point()});
    const std::vector<Side> sides = sorted_sides(triangles);
    ASSERT_EQ(sides.size(), 3 * triangles.faces.size()) << "seed " << seed;
    std::vector<int> seen(sides.size(), 0);
    for (std::size_t i = 0; i < sides.size(); ++i) {
      const auto& [low, high, corner, upward] = sides[i];
      ++seen[corner];
      const std::uint32_t from = triangles.faces[corner / 3][corner % 3],
                          to = triangles.faces[corner / 3][next_corner(corner) % 3];
      ASSERT_EQ(std::tuple(low, high, upward), std::tuple(std::min(from, to), std::max(from, to), from < to));
      if (i == 0) continue;
      ASSERT_LT(std::tuple(sides[i - 1].low, sides[i - 1].high, sides[i - 1].corner),
                std::tuple(low, high, corner))
          << "seed " << seed;
    }
    ASSERT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(sides.size()));
  }
}

TEST(Sides, OfTrianglesInAnyOrderAreTheSameOnAnyNumberOfThreads) {
  std::mt19937 random(5);
  Triangles triangles;
  triangles.points_mm.resize(9000);
  for (std::uint32_t f = 0; f < 20000; ++f) {
    // First roughly in the order of their points, then in random order.
    const auto point = [&] {
      return static_cast<std::uint32_t>(f < 10000 ? (f * 8999 / 10000 + random() % 40) % 9000
                                                  : random() % 9000);
    };
    triangles.faces.push_back({point(), point(), point()});
  }
  std::vector<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>> expected;
  for (std::uint32_t corner = 0; corner < 3 * triangles.faces.size(); ++corner) {
    const std::uint32_t from = triangles.faces[corner / 3][corner % 3],
                        to = triangles.faces[corner / 3][next_corner(corner) % 3];
    expected.emplace_back(std::min(from, to), std::max(from, to), corner);
  }
  std::sort(expected.begin(), expected.end());
  for (const int threads : {1, 2, 5}) {
    tbb::task_arena arena(threads);
    const std::vector<Side> sides = arena.execute([&] { return sorted_sides(triangles); });
    std::vector<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>> found;
    for (const Side& side : sides) found.emplace_back(side.low, side.high, side.corner);
    EXPECT_TRUE(found == expected) << threads << " threads";
  }
}

TEST(Sides, AreVisitedEdgeByEdge) {
  // Two triangles along the edge from 1 to 2.
  const Triangles triangles{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {2, 1, 3}}};
  std::vector<std::tuple<std::uint32_t, std::uint32_t, std::ptrdiff_t>> edges;
  each_edge(sorted_sides(triangles), [&](const Side* begin, const Side* end) {
    edges.emplace_back(begin->low, begin->high, end - begin);
  });
  EXPECT_EQ(edges, (std::vector<std::tuple<std::uint32_t, std::uint32_t, std::ptrdiff_t>>{
                       {0, 1, 1}, {0, 2, 1}, {1, 2, 2}, {1, 3, 1}, {2, 3, 1}}));
}

TEST(Sides, OfACornerGoRoundItsTriangle) {
  for (const std::uint32_t corner : {0u, 1u, 2u, 3u, 4u, 5u}) {
    EXPECT_EQ(next_corner(corner) / 3, corner / 3);
    EXPECT_EQ(previous_corner(next_corner(corner)), corner);
    EXPECT_EQ(next_corner(next_corner(next_corner(corner))), corner);
  }
}

}  // namespace
}  // namespace octotomy::brep
