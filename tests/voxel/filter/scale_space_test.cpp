// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/scale_space.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <set>
#include <tbb/global_control.h>

#include "tests/voxel/field_scene.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

using tests::field_scene;
using tests::for_each_index;
using tests::sample_at;

/// Two balls of 8 mm whose middles are 14 mm apart, so that they overlap in a lens, with noise.
Scene touching_balls(double noise) {
  std::mt19937 random(7);
  const auto ball = [](const glm::dvec3& p, double x) { return glm::distance(p, {x, 0, 0}) < 8.0; };
  return field_scene<std::int16_t>(
      axis_aligned_lattice({40, 26, 26}, {1, 1, 1}, {-19.5, -12.5, -12.5}), [&](const glm::dvec3& p) {
        const double off = noise * (static_cast<double>(random() % 2001) / 1000.0 - 1.0);
        return (ball(p, -7.0) || ball(p, 7.0) ? 1000.0 : 0.0) + off;
      });
}

TEST(ScaleSpace, PartsTwoBallsThatTouchAtTheirNeck) {
  const Scene scene = touching_balls(0.0);
  const ScaleSpace space = scale_space(scene, {.sigma_mm = 4.0, .low = 500.0, .high = 1e9});
  ASSERT_EQ(space.samples.size(), 2u);
  EXPECT_NEAR(static_cast<double>(space.samples[0]), static_cast<double>(space.samples[1]), 60.0);
  int wrong = 0, inside = 0;
  const double of_left = sample_at(space.labels, {13, 13, 13});
  for_each_index(scene.lattice, 0, [&](const glm::ivec3& at) {
    const double label = sample_at(space.labels, at);
    EXPECT_EQ(label != 0.0, sample_at(scene, at) >= 500.0);
    if (label == 0.0) return;
    ++inside;
    wrong += (label == of_left) != (scene.lattice.lps_mm(at).x < 0.0);
  });
  EXPECT_GT(inside, 3500);
  EXPECT_LT(wrong, 40) << "the ties at the plane between the balls";
}

TEST(ScaleSpace, NoiseMakesManyMaximaButNoRegions) {
  const ScaleSpace space = scale_space(touching_balls(300.0), {.sigma_mm = 4.0, .low = 500.0, .high = 1e9});
  EXPECT_GT(space.maxima.back(), 500u);
  ASSERT_GE(space.samples.size(), 2u);
  // Specks of noise far from the balls may climb elsewhere; the balls keep all but a few of the samples.
  const double all = static_cast<double>(std::get<Int16Samples>(space.labels.samples).size());
  double labelled = 0.0;
  for (const std::uint64_t samples : space.samples) labelled += static_cast<double>(samples);
  EXPECT_LT(labelled, all);
  EXPECT_GT(static_cast<double>(space.samples[0] + space.samples[1]), 0.98 * labelled);
  EXPECT_GT(static_cast<double>(space.samples[1]), 0.4 * labelled);
}

TEST(ScaleSpace, AWiderBlurMakesOneRegionAndMaximaFallWithTheBlur) {
  const ScaleSpace space = scale_space(touching_balls(300.0), {.sigma_mm = 12.0, .low = 500.0, .high = 1e9});
  EXPECT_EQ(space.samples.size(), 1u);
  ASSERT_GT(space.sigmas_mm.size(), 4u);
  EXPECT_EQ(space.sigmas_mm.front(), 12.0);
  EXPECT_EQ(space.sigmas_mm.back(), 0.0);
  for (std::size_t level = 1; level < space.maxima.size(); ++level)
    EXPECT_LE(space.maxima[level - 1], space.maxima[level]);
}

TEST(ScaleSpace, OfDarkObjectsIsThatOfTheirNegative) {
  const Scene scene = touching_balls(50.0);
  Scene negative = scene;
  for (std::int16_t& sample : std::get<Int16Samples>(negative.samples))
    sample = static_cast<std::int16_t>(-sample);
  const ScaleSpace bright = scale_space(scene, {.sigma_mm = 4.0, .low = 500.0, .high = 1e9});
  const ScaleSpace dark =
      scale_space(negative, {.sigma_mm = 4.0, .low = -1e9, .high = -500.0, .is_dark = true});
  EXPECT_EQ(std::get<Int16Samples>(bright.labels.samples), std::get<Int16Samples>(dark.labels.samples));
}

TEST(ScaleSpace, LeavesPaddingOutIsTheSameOnAnyThreadsAndRefusesWhatHasNone) {
  Scene scene = touching_balls(50.0);
  scene.padding = -2000.0;
  std::get<Int16Samples>(scene.samples)[5] = -2000;
  const auto on = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return scale_space(scene, {.sigma_mm = 3.0, .low = -1e9, .high = 1e9});
  };
  const ScaleSpace one = on(1);
  EXPECT_EQ(std::get<Int16Samples>(one.labels.samples), std::get<Int16Samples>(on(2).labels.samples));
  EXPECT_EQ(sample_at(one.labels, {5, 0, 0}), 0.0);
  EXPECT_THROW(scale_space(scene, {.sigma_mm = 3.0, .low = 8000.0, .high = 1e9}), Error);
  EXPECT_THROW(scale_space(scene, {.sigma_mm = 0.0, .low = 0.0, .high = 1e9}), std::invalid_argument);
  EXPECT_THROW(scale_space(scene, {.sigma_mm = 99.0, .low = 0.0, .high = 1e9}), std::invalid_argument);
  scene.meaning = Meaning::Label;
  EXPECT_THROW(scale_space(scene, {.sigma_mm = 3.0, .low = 0.0, .high = 1e9}), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
