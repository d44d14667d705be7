// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/measure/half_width.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <vector>

#include "tests/unit_universe.h"
#include "tests/voxel/field_scene.h"
#include "voxel/measure/flat_parts.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

using tests::universe_about_origin;

TEST(VolumeHalfWidth, HoldsTheTruthOfBallsWhereverTheyLieAndIsNotIdle) {
  int outside_of_a_tenth = 0;
  for (int i = 1; i <= 40; ++i) {
    const glm::dvec3 centre =
        glm::fract(glm::dvec3(i) * glm::dvec3(0.8191725134, 0.6710436067, 0.5497004779));
    const double radius_mm = 9.0 + 0.23 * i;
    const voxel::Measures measures =
        voxel::measure(voxel::combine(universe_about_origin(6), voxel::Sphere{centre, radius_mm}));
    const double truth = 4.0 / 3.0 * std::numbers::pi * radius_mm * radius_mm * radius_mm;
    const HalfWidth found = volume_half_width(measures, {glm::dvec3(1.0)});
    EXPECT_LE(std::abs(measures.volume_mm3 - truth), found.value)
        << "radius " << radius_mm << " mm, number " << i;
    outside_of_a_tenth += std::abs(measures.volume_mm3 - truth) > 0.1 * found.value;
  }
  EXPECT_GT(outside_of_a_tenth, 15);
}

/// Solids with flat parts along the lattice, anywhere between its planes: boxes, and balls cut by a plane.
TEST(VolumeHalfWidth, HoldsTheTruthOfSolidsCutAlongTheLattice) {
  std::mt19937_64 random(1);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution(low, high)(random);
  };
  constexpr int trials = 400;
  std::vector<double> errors, widths;
  int held = 0;
  for (int i = 0; i < trials; ++i) {
    const glm::dvec3 middle(between(-0.5, 0.5), between(-0.5, 0.5), between(-0.5, 0.5));
    voxel::Expression solid = voxel::Sphere{};
    double truth_mm3 = 0.0;
    if (i % 2 == 0) {
      const glm::dvec3 half(between(6, 24), between(6, 24), between(6, 24));
      solid = voxel::Box{middle - half, middle + half};
      truth_mm3 = 8.0 * half.x * half.y * half.z;
    } else {
      const double radius = between(10, 26), height = between(0.4, 1.6) * radius;
      solid = voxel::Expression(voxel::Sphere{middle, radius}) &
              voxel::HalfSpace{{0, 0, 1}, middle.z - radius + height};
      truth_mm3 = std::numbers::pi * height * height * (radius - height / 3.0);
    }
    const voxel::Octree octree = voxel::combine(universe_about_origin(6), solid);
    Digitised digitised{glm::dvec3(1.0)};
    digitised.flat_mm2 = voxel::flat_parts_mm2(octree);
    const voxel::Measures measures = voxel::measure(octree);
    widths.push_back(volume_half_width(measures, digitised).value / truth_mm3);
    errors.push_back(std::abs(measures.volume_mm3 - truth_mm3) / truth_mm3);
    held += errors.back() <= widths.back();
  }
  EXPECT_GE(held, 394) << "of " << trials;
  std::sort(errors.begin(), errors.end());
  std::sort(widths.begin(), widths.end());
  EXPECT_LT(widths[trials / 2], 3.0 * errors[trials * 99 / 100]);
}

TEST(VolumeHalfWidth, CoarseSlicesWidenIt) {
  const voxel::Measures measures =
      voxel::measure(voxel::combine(universe_about_origin(6), voxel::Sphere{glm::dvec3(0.2), 20.0}));
  const double fine = volume_half_width(measures, {glm::dvec3(1.0), glm::dvec3(1.0)}).value;
  const double coarse = volume_half_width(measures, {glm::dvec3(1.0), {1, 1, 5}}).value;
  EXPECT_GT(coarse, 2.0 * fine);
}

TEST(VolumeHalfWidth, IsWhatVoxelsMissOfAnObjectThatTheyPassOver) {
  const Digitised digitised{glm::dvec3(1.0)};
  const voxel::Measures none = voxel::measure(voxel::Octree::empty(universe_about_origin(6)));
  const HalfWidth missed = volume_half_width(none, digitised, SeenSize{"mesh", 320.0});
  EXPECT_EQ(missed.value, 320.0);
  EXPECT_EQ(missed.terms.back().name, "mesh");
  EXPECT_TRUE(missed.is_too_coarse);
  // For less than a voxel no half-width is needed, and two empty answers are certain.
  const HalfWidth sliver = volume_half_width(none, digitised, SeenSize{"mesh", 0.25});
  EXPECT_EQ(sliver.value, 0.25);
  EXPECT_FALSE(sliver.is_too_coarse);
  EXPECT_EQ(volume_half_width(none, digitised, SeenSize{"mesh", 0.0}).value, 0.0);

  const voxel::Measures ball =
      voxel::measure(voxel::combine(universe_about_origin(6), voxel::Sphere{glm::dvec3(0.2), 20.0}));
  const double width = volume_half_width(ball, digitised).value;
  const auto seen_off = [&](double widths) {
    return volume_half_width(ball, digitised, SeenSize{"mesh", ball.volume_mm3 - widths * width});
  };
  EXPECT_EQ(seen_off(2.9).value, width);
  EXPECT_FALSE(seen_off(2.9).is_too_coarse);
  EXPECT_NEAR(seen_off(3.1).value, 3.1 * width, 1e-6);
  EXPECT_TRUE(seen_off(3.1).is_too_coarse);
}

/// Points picked on samples of 0.7 x 0.7 x 3 mm, as far from the truth as chance has it.
struct Picking {
  glm::dvec3 step_mm{0.7, 0.7, 3.0};
  int number = 0;
  glm::dvec3 operator()(const glm::dvec3& truth_mm) {
    ++number;
    const glm::dvec3 off =
        glm::fract(glm::dvec3(number) * glm::dvec3(0.8191725134, 0.6710436067, 0.5497004779));
    return truth_mm + (off - 0.5) * step_mm;
  }
};

TEST(DistanceHalfWidth, HoldsTheTruthOfPickedPointsInEveryDirectionAndIsNotIdle) {
  for (const glm::dvec3& along : {glm::dvec3(50, 0, 0), {0, 0, 50}, {20, 30, 40}, {3, 0, 4}}) {
    Picking picked;
    const std::array<glm::dvec3, 2> truth{glm::dvec3(1, 2, 3), glm::dvec3(1, 2, 3) + along};
    const double half_mm = distance_half_width(truth, {glm::dvec3(0.5), picked.step_mm}).value;
    int beyond = 0, beyond_half = 0;
    constexpr int trials = 4000;
    for (int i = 0; i < trials; ++i) {
      const glm::dvec3 a = picked(truth[0]), b = picked(truth[1]);
      const double error = std::abs(glm::distance(a, b) - glm::length(along));
      beyond += error > half_mm;
      beyond_half += error > 0.5 * half_mm;
    }
    EXPECT_LE(beyond, trials / 100) << "along " << along.x << ", " << along.y << ", " << along.z;
    EXPECT_GT(beyond_half, trials / 20);
  }
}

TEST(AngleHalfWidth, HoldsTheTruthOfPickedPointsAndIsNotIdle) {
  const std::array<std::array<glm::dvec3, 3>, 3> cases{{{{{40, 0, 0}, {0, 0, 0}, {0, 0, 30}}},
                                                        {{{40, 10, 5}, {0, 0, 0}, {35, -20, 5}}},
                                                        {{{0, 60, 0}, {0, 0, 0}, {-30, -20, 50}}}}};
  for (const auto& truth : cases) {
    const auto angle = [](const std::array<glm::dvec3, 3>& p) {
      return glm::degrees(std::acos(glm::dot(glm::normalize(p[0] - p[1]), glm::normalize(p[2] - p[1]))));
    };
    Picking picked;
    const double half_deg = angle_half_width(truth, {glm::dvec3(0.5), picked.step_mm}).value;
    int beyond = 0, beyond_half = 0;
    constexpr int trials = 4000;
    for (int i = 0; i < trials; ++i) {
      const glm::dvec3 a = picked(truth[0]), b = picked(truth[1]), c = picked(truth[2]);
      const double error = std::abs(angle({a, b, c}) - angle(truth));
      beyond += error > half_deg;
      beyond_half += error > 0.5 * half_deg;
    }
    EXPECT_LE(beyond, trials / 100) << angle(truth) << " degrees";
    EXPECT_GT(beyond_half, trials / 20);
  }
}

TEST(AreaHalfWidth, GrowsWithTheWindowsShiftByTwiceTheMeanCurvature) {
  // A sphere of 10 mm: M = 4 pi r, and dS / dr = 8 pi r.
  const SurfaceSize sphere{400.0 * std::numbers::pi, 40.0 * std::numbers::pi};
  const HalfWidth found = area_half_width(sphere, {glm::dvec3(1.0), glm::dvec3(1.0), 0.25});
  ASSERT_EQ(found.terms.size(), 3U);
  EXPECT_NEAR(found.terms[2].half_width, 0.25 * 80.0 * std::numbers::pi, 1e-9);
}

TEST(WindowShift, OfARampIsTenUnitsByItsSlope) {
  // A ball whose samples fall by 40 a millimetre moves by a quarter of a millimetre for ten.
  const voxel::Scene scene = tests::field_scene<std::int16_t>(
      voxel::axis_aligned_lattice({64, 64, 64}, glm::dvec3(1.0), glm::dvec3(-31.5)),
      [](const glm::dvec3& p_mm) { return 40.0 * (20.0 - glm::length(p_mm - glm::dvec3(0.3))); });
  const voxel::GreyOctree grey = voxel::grey_octree_of(universe_about_origin(6), scene, -2000);
  const std::optional<double> shift_mm = window_shift_mm({grey, 0.0});
  ASSERT_TRUE(shift_mm);
  EXPECT_NEAR(*shift_mm, 0.25, 0.03);
  EXPECT_FALSE(window_shift_mm({grey, 30000.0}));
}

}  // namespace
}  // namespace octotomy::planner
