// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/slice_contour.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

#include "voxel/solid/combine.h"
#include "voxel/solid/polygon.h"
#include "voxel/solid/region_mask.h"

namespace octotomy::voxel {
namespace {

// A field on a lattice of slices, in float.
template <typename Field>
Scene scene_of(const Lattice& lattice, const Field& field) {
  Scene scene;
  scene.lattice = lattice;
  FloatSamples samples;
  for (int z = 0; z < lattice.dims.z; ++z)
    for (int y = 0; y < lattice.dims.y; ++y)
      for (int x = 0; x < lattice.dims.x; ++x)
        samples.push_back(static_cast<float>(field(glm::ivec3(x, y, z))));
  scene.samples = std::move(samples);
  return scene;
}

const Lattice one_slice = axis_aligned_lattice({64, 48, 1}, {1, 1, 1}, {0, 0, 0});

double cone(const glm::ivec3& p, double radius) {
  return radius - std::hypot(p.x - 30.3, p.y - 23.6);
}

TEST(SliceContours, OfAConeIsItsCircleToWithinTheInterpolation) {
  const Scene scene = scene_of(one_slice, [](const glm::ivec3& p) { return cone(p, 17.0); });
  const std::vector<SliceContour> contours = slice_contours(scene, 0, 0.0);
  ASSERT_EQ(contours.size(), 1U);
  // Along a row or column the cone is bent by at most 1 / (8 r) of a voxel between two samples.
  for (const glm::dvec2& p : contours[0])
    ASSERT_NEAR(std::hypot(p.x - 30.3, p.y - 23.6), 17.0, 1.0 / (8 * 16));
  EXPECT_NEAR(signed_area(contours[0]), std::numbers::pi * 17 * 17, 2.0);
  EXPECT_GT(signed_area(contours[0]), 0.0);
}

TEST(SliceContours, RunRoundHolesTheOtherWay) {
  const Scene scene = scene_of(one_slice, [](const glm::ivec3& p) { return 4.0 - std::abs(cone(p, 14.0)); });
  const std::vector<SliceContour> contours = slice_contours(scene, 0, 0.0);
  ASSERT_EQ(contours.size(), 2U);
  EXPECT_NEAR(signed_area(contours[0]), std::numbers::pi * 18 * 18, 2.0);
  EXPECT_NEAR(signed_area(contours[1]), -std::numbers::pi * 10 * 10, 2.0);
}

TEST(SliceContours, KeepApartWhatTouchesByACornerAndCloseAtTheBorder) {
  // Two squares that share a corner, one of them in the slice's corner.
  const Scene scene = scene_of(one_slice, [](const glm::ivec3& p) {
    return (p.x < 5 && p.y < 4) || (p.x >= 5 && p.x < 8 && p.y >= 4 && p.y < 6) ? 100.0 : -100.0;
  });
  const std::vector<SliceContour> contours = slice_contours(scene, 0, 0.0);
  ASSERT_EQ(contours.size(), 2U);
  // Half-way between samples all round: the voxels' own edges, corners cut off by an eighth of a voxel each.
  EXPECT_DOUBLE_EQ(signed_area(contours[0]), 5 * 4 - 4 / 8.0);
  EXPECT_DOUBLE_EQ(signed_area(contours[1]), 3 * 2 - 4 / 8.0);
  EXPECT_EQ(contours[0][0], glm::dvec2(0, -0.5));
  // The twin: everything inside.
  const Scene full = scene_of(one_slice, [](const glm::ivec3&) { return 1.0; });
  ASSERT_EQ(slice_contours(full, 0, 0.0).size(), 1U);
  EXPECT_DOUBLE_EQ(signed_area(slice_contours(full, 0, 0.0)[0]), 64 * 48 - 4 / 8.0);
  EXPECT_TRUE(slice_contours(full, 0, 2.0).empty());
}

TEST(SliceContours, BoundExactlyTheSamplesInsideOnNoise) {
  std::size_t contours_seen = 0, holes = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> noise(-1, 1);
    const double threshold = seed % 2 == 0 ? 0.1 : -0.5;  // few holes, many holes
    const Lattice lattice = axis_aligned_lattice({37, 29, 1}, {1, 1, 1}, {0, 0, 0});
    const Scene scene = scene_of(lattice, [&](const glm::ivec3&) { return noise(random); });
    const std::vector<SliceContour> contours = slice_contours(scene, 0, threshold);
    contours_seen += contours.size();
    for (const SliceContour& contour : contours) holes += signed_area(contour) < 0;
    const auto& samples = std::get<FloatSamples>(scene.samples);
    // Inside by the even-odd rule: a sample is inside the contours where it is at least the threshold.
    for (int y = 0; y < 29; ++y)
      for (int x = 0; x < 37; ++x) {
        std::vector<std::vector<glm::dvec2>> polygons(contours.begin(), contours.end());
        ASSERT_EQ(contains(polygons, glm::dvec2(x, y)),
                  samples[static_cast<std::size_t>(x + 37 * y)] >= threshold)
            << x << ' ' << y;
      }
    // The spoiled twin: without its first contour the slice is another.
    std::vector<std::vector<glm::dvec2>> fewer(contours.begin() + 1, contours.end());
    bool differs = false;
    for (int y = 0; y < 29; ++y)
      for (int x = 0; x < 37; ++x)
        differs |=
            contains(fewer, glm::dvec2(x, y)) != (samples[static_cast<std::size_t>(x + 37 * y)] >= threshold);
    EXPECT_TRUE(differs);
  }
  EXPECT_GT(contours_seen, 400U);
  EXPECT_GT(holes, 50U);
}

TEST(SliceContours, NeedASliceAndAFiniteThreshold) {
  const Scene scene = scene_of(one_slice, [](const glm::ivec3& p) { return cone(p, 20.0); });
  EXPECT_THROW(slice_contours(scene, 1, 0.0), std::invalid_argument);
  EXPECT_THROW(slice_contours(scene, 0, NAN), std::invalid_argument);
}

TEST(Thinned, LeavesCornersAndStraysNoFartherThanAllowed) {
  SliceContour square;
  for (int i = 0; i < 10; ++i) square.emplace_back(i, 0);
  for (int i = 0; i < 10; ++i) square.emplace_back(10, i);
  for (int i = 0; i < 10; ++i) square.emplace_back(10 - i, 10);
  for (int i = 0; i < 10; ++i) square.emplace_back(0, 10 - i);
  EXPECT_EQ(thinned(square, 1e-9), (SliceContour{{0, 0}, {10, 0}, {10, 10}, {0, 10}}));
  const Scene scene = scene_of(one_slice, [](const glm::ivec3& p) { return cone(p, 17.0); });
  const SliceContour circle = slice_contours(scene, 0, 0.0)[0];
  const SliceContour thin = thinned(circle, 0.2);
  EXPECT_LT(thin.size(), circle.size() / 3);
  EXPECT_NEAR(signed_area(thin) / signed_area(circle), 1.0, 0.02);
  EXPECT_EQ(thinned({{0, 0}, {1, 0}, {0, 1}}, 9).size(), 3U);
}

TEST(ContourRegions, EncloseABallInEveryOrientationOfSlices) {
  const glm::dvec3 centre_mm(3, -4, 5);
  int views = 0;
  for (const int normal : {0, 1, 2})
    for (const double sign : {1.0, -1.0}) {
      Lattice lattice{{48, 48, 24}, glm::dmat4(0.0)};
      lattice.lps_from_voxel[0][(normal + 1) % 3] = 1.0;
      lattice.lps_from_voxel[1][(normal + 2) % 3] = 1.0;
      lattice.lps_from_voxel[2][normal] = 2.0 * sign;
      const glm::dmat3 axes(lattice.lps_from_voxel);
      lattice.lps_from_voxel[3] = glm::dvec4(centre_mm - axes * glm::dvec3(23.5, 23.5, 11.5), 1);
      const Scene scene = scene_of(
          lattice, [&](const glm::ivec3& p) { return 15.0 - glm::distance(lattice.lps_mm(p), centre_mm); });
      const SliceMask mask = contour_regions(scene, {.threshold = 0.0});
      views += contour_view(lattice) == std::string(normal == 0   ? "right"
                                                    : normal == 1 ? "anterior"
                                                                  : "inferior");
      const Universe universe = universe_around({centre_mm - 20.0, centre_mm + 20.0}, 1.0);
      const Octree ball = combine(universe, mask);
      const double truth = 4.0 / 3.0 * std::numbers::pi * 15 * 15 * 15;
      EXPECT_NEAR(static_cast<double>(ball.voxel_count()) / truth, 1.0, 0.02) << normal << ' ' << sign;
      EXPECT_TRUE(ball.contains(glm::ivec3(glm::round(universe.lattice().voxel(centre_mm)))));
    }
  EXPECT_EQ(views, 6);
  Lattice oblique = one_slice;
  oblique.lps_from_voxel[1] = glm::dvec4(0, 0.8, 0.6, 0);
  EXPECT_THROW(contour_regions(scene_of(oblique, [](const glm::ivec3&) { return 1.0; }), {}),
               std::invalid_argument);
  EXPECT_THROW(contour_regions(scene_of(one_slice, [](const glm::ivec3&) { return -1.0; }), {}),
               std::runtime_error);
}

}  // namespace
}  // namespace octotomy::voxel
