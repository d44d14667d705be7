// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/surface_sizes.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "tests/convert/surfaces.h"

namespace octotomy::convert {
namespace {

using tests::ball;
using tests::box;
using tests::together;

MesherInput input_of(const brep::Triangles& surface) {
  return {surface.points_mm, surface.faces, {}, {}};
}

/// No side along which the sizes of its ends differ by more than the grading allows.
void expect_graded(const MesherInput& surface, const SurfaceSizes& sizes, double grading) {
  for (const auto& corners : surface.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = corners.at(i), b = corners.at((i + 1) % 3);
      EXPECT_LE(sizes.at_points_mm()[a],
                sizes.at_points_mm()[b] +
                    grading * glm::distance(surface.points_mm[a], surface.points_mm[b]) + 1e-12);
    }
}

TEST(SurfaceSizes, ABallsTrianglesHaveTheirSideEverywhere) {
  const MesherInput surface = input_of(ball({0, 0, 0}, 10.0, 4));
  const SurfaceSizes sizes(surface, 0.3);
  const double side_mm = std::sqrt(tests::area_mm2({surface.points_mm, surface.triangles}) /
                                   static_cast<double>(surface.triangles.size()) * 4.0 / std::sqrt(3.0));
  for (const double size_mm : sizes.at_points_mm()) EXPECT_NEAR(size_mm, side_mm, 0.25 * side_mm);
}

TEST(SurfaceSizes, NeitherLargerThanTheMeanNorSmallerThanAnEighthOfIt) {
  // A speck beside a box of large triangles.
  const MesherInput surface = input_of(together(box({0, 0, 0}, {100, 100, 100}), ball({200, 0, 0}, 0.01, 1)));
  const SurfaceSizes sizes(surface, 0.3);
  const auto [least, most] = std::minmax_element(sizes.at_points_mm().begin(), sizes.at_points_mm().end());
  EXPECT_NEAR(*most / *least, 8.0, 1e-9);
}

TEST(SurfaceSizes, HalvedPointsPullTheirNeighboursDownByTheGrading) {
  const MesherInput surface = input_of(ball({0, 0, 0}, 10.0, 4));
  SurfaceSizes sizes(surface, 0.1);
  expect_graded(surface, sizes, 0.1);
  const std::vector<double> before = sizes.at_points_mm();
  for (int i = 0; i < 4; ++i) sizes.halve({17});
  EXPECT_NEAR(sizes.at_points_mm()[17], before[17] / 16.0, 1e-12);
  expect_graded(surface, sizes, 0.1);
  std::size_t lower = 0;
  for (std::size_t i = 0; i < before.size(); ++i) lower += sizes.at_points_mm()[i] < before[i];
  EXPECT_GT(lower, 7u) << "the neighbours follow";
  EXPECT_LT(lower, before.size()) << "and what is far does not";
}

TEST(SurfaceSizes, ThinnedPointsLeaveNoneWithoutOneOfThemNear) {
  const MesherInput surface = input_of(ball({0, 0, 0}, 10.0, 4));
  SurfaceSizes sizes(surface, 0.3);
  sizes.scale(6.0);
  std::vector<std::uint32_t> all(surface.points_mm.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  const std::vector<std::uint32_t> thin = sizes.thinned(all);
  EXPECT_LT(4 * thin.size(), all.size());
  for (const std::uint32_t v : all)
    EXPECT_TRUE(std::any_of(thin.begin(), thin.end(), [&](std::uint32_t k) {
      return glm::distance(surface.points_mm[v], surface.points_mm[k]) <= 0.5 * sizes.at_points_mm()[k];
    })) << v;
}

}  // namespace
}  // namespace octotomy::convert
