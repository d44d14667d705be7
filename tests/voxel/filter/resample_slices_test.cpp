// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/resample_slices.h"

#include <gtest/gtest.h>
#include <numbers>
#include <tbb/global_control.h>

#include "tests/voxel/field_scene.h"
#include "tests/voxel/linear_scene.h"

namespace octotomy::voxel {
namespace {

using tests::field_scene;
using tests::for_each_index;
using tests::sample_at;

const Lattice coarse = axis_aligned_lattice({6, 5, 24}, {1, 1, 3}, {-2, 4, -35});

double largest_error(SliceKernel kernel, int margin, const std::function<double(const glm::dvec3&)>& field) {
  const Scene fine = resample_slices(field_scene<float>(coarse, field), 0.75, kernel);
  double largest = 0.0;
  for_each_index(fine.lattice, 0, [&](const glm::ivec3& p) {
    if (p.z < 4 * margin || p.z > fine.lattice.dims.z - 1 - 4 * margin) return;
    largest = std::max(largest, std::abs(sample_at(fine, p) - field(fine.lattice.lps_mm(p))));
  });
  return largest;
}

TEST(ResampleSlices, KernelsReproduceThePolynomialsTheyShouldAndNoMore) {
  const auto line = [](const glm::dvec3& p) { return 5.0 - 2.0 * p.z + p.x; };
  const auto square = [](const glm::dvec3& p) { return 0.5 * p.z * p.z - p.z; };
  const auto cube = [](const glm::dvec3& p) { return 0.02 * p.z * p.z * p.z; };
  EXPECT_LT(largest_error(SliceKernel::Linear, 0, line), 1e-4);
  EXPECT_LT(largest_error(SliceKernel::Cubic, 1, line), 1e-4);
  EXPECT_LT(largest_error(SliceKernel::Cubic, 1, square), 1e-3);
  EXPECT_GT(largest_error(SliceKernel::Linear, 1, square), 1.0);  // 9 / 8 half-way between slices
  EXPECT_GT(largest_error(SliceKernel::Cubic, 1, cube), 0.01);
  EXPECT_GT(largest_error(SliceKernel::Nearest, 0, line), 2.9);  // half a spacing times the slope
}

TEST(ResampleSlices, LanczosIsNearerToASineThanCubicAndCubicThanLinear) {
  // A period of six slices.
  const auto sine = [](const glm::dvec3& p) { return 100.0 * std::sin(2 * std::numbers::pi * p.z / 18.0); };
  const double linear = largest_error(SliceKernel::Linear, 3, sine);
  const double cubic = largest_error(SliceKernel::Cubic, 3, sine);
  const double lanczos = largest_error(SliceKernel::Lanczos, 3, sine);
  EXPECT_LT(cubic, 0.5 * linear);
  EXPECT_LT(lanczos, 0.8 * cubic);
}

TEST(ResampleSlices, LeaveSampledSlicesAsTheyAreAndPutTheOthersWhereTheyBelong) {
  const Scene scene = tests::linear_scene(tests::oblique_lattice(true));
  for (const SliceKernel kernel :
       {SliceKernel::Nearest, SliceKernel::Linear, SliceKernel::Cubic, SliceKernel::Lanczos}) {
    const Scene fine = resample_slices(scene, 2.1 / 3, kernel);
    ASSERT_EQ(fine.lattice.dims, glm::ivec3(40, 30, 58));
    for_each_index(scene.lattice, 0, [&](const glm::ivec3& p) {
      const glm::ivec3 there(p.x, p.y, 3 * p.z);
      ASSERT_EQ(sample_at(fine, there), sample_at(scene, p));
      ASSERT_LT(glm::distance(fine.lattice.lps_mm(there), scene.lattice.lps_mm(p)), 1e-9);
    });
  }
  EXPECT_EQ(with_slice_spacing(coarse, 5.0).dims.z, 14);  // 69 mm hold 13 steps and a bit
  EXPECT_EQ(with_slice_spacing(coarse, 69.0).dims.z, 2);
  EXPECT_EQ(with_slice_spacing(coarse, 70.0).dims.z, 1);
}

TEST(ResampleSlices, OvershootEndsAtTheRangeOfIntegers) {
  Scene scene;
  scene.lattice = axis_aligned_lattice({1, 1, 6}, {1, 1, 2}, {0, 0, 0});
  scene.samples = Int16Samples{-32768, -32768, -32768, 32767, 32767, 32767};
  const Scene fine = resample_slices(scene, 1.0, SliceKernel::Cubic);
  EXPECT_EQ(std::get<Int16Samples>(fine.samples)[3], -32768);  // -36863 but for that
  EXPECT_EQ(std::get<Int16Samples>(fine.samples)[7], 32767);
}

TEST(ResampleSlices, RefuseWhatCannotBe) {
  Scene scene = tests::linear_scene(coarse);
  EXPECT_THROW(resample_slices(scene, 0.0, SliceKernel::Linear), std::invalid_argument);
  EXPECT_THROW(resample_slices(scene, NAN, SliceKernel::Linear), std::invalid_argument);
  EXPECT_THROW(resample_slices(scene, 1e-6, SliceKernel::Linear), std::invalid_argument);
  scene.meaning = Meaning::Label;
  EXPECT_THROW(resample_slices(scene, 1.0, SliceKernel::Linear), std::invalid_argument);
  EXPECT_NO_THROW(resample_slices(scene, 1.0, SliceKernel::Nearest));
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(resample_slices(scene, 1.0, SliceKernel::Nearest, {stop.get_token(), {}}), Stopped);
}

// Circles about the z axis whose radius grows with z: a cone of samples, 1 inside and 0 outside.
Scene cone(double slope) {
  const Lattice lattice = axis_aligned_lattice({64, 64, 9}, {0.5, 0.5, 4}, {-15.75, -15.75, -16});
  return field_scene<std::int16_t>(lattice, [&](const glm::dvec3& p) {
    return std::hypot(p.x, p.y) <= 8.0 + slope * p.z ? 1000.0 : -1000.0;
  });
}

double worst_radius_error(const Scene& shape, double slope) {
  double worst = 0.0;
  for (int k = 0; k < shape.lattice.dims.z; ++k) {
    double pixels = 0.0;
    for (int y = 0; y < shape.lattice.dims.y; ++y)
      for (int x = 0; x < shape.lattice.dims.x; ++x) pixels += sample_at(shape, {x, y, k});
    const double radius = std::sqrt(pixels * 0.25 / std::numbers::pi);
    worst = std::max(worst, std::abs(radius - (8.0 + slope * shape.lattice.lps_mm({0, 0, k}).z)));
  }
  return worst;
}

TEST(InterpolateShape, MakesAConeOfCirclesWhereGreyInterpolationMakesSteps) {
  constexpr double slope = 0.35;
  const Scene scene = cone(slope);
  ShapeOptions options;
  options.spacing_mm = 0.5;
  options.low = 0.0;
  const Scene shape = interpolate_shape(scene, options);
  EXPECT_EQ(shape.meaning, Meaning::Label);
  EXPECT_EQ(shape.lattice.dims, glm::ivec3(64, 64, 65));
  EXPECT_LT(worst_radius_error(shape, slope), 0.25);  // half a pixel
  // The spoiled twin: samples interpolated, then thresholded, jump half-way by 0.35 x 4 mm.
  Scene grey = resample_slices(scene, 0.5, SliceKernel::Linear);
  for (std::int16_t& sample : std::get<Int16Samples>(grey.samples)) sample = sample >= 0 ? 1 : 0;
  EXPECT_GT(worst_radius_error(grey, slope), 0.6);
}

TEST(InterpolateShape, KeepsSampledSlicesAndEndsHalfWayToEmptyOnes) {
  Scene scene = cone(0.0);
  auto& samples = std::get<Int16Samples>(scene.samples);
  for (std::size_t i = 0; i < 3 * 64 * 64; ++i) samples[i] = -1000;  // slices 0 to 2 are empty
  ShapeOptions options;
  options.spacing_mm = 1.0;
  const Scene shape = interpolate_shape(scene, options);
  for_each_index(scene.lattice, 0, [&](const glm::ivec3& p) {
    ASSERT_EQ(sample_at(shape, {p.x, p.y, 4 * p.z}), sample_at(scene, p) >= 0 ? 1 : 0);
  });
  for (int k = 0; k < 33; ++k) EXPECT_EQ(sample_at(shape, {32, 32, k}), k > 10 ? 1 : 0) << k;
}

TEST(InterpolateShape, IsTheSameOnOneThreadAndOnTwo) {
  const Scene scene = cone(0.2);
  ShapeOptions options;
  options.spacing_mm = 1.5;
  const auto on = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return std::get<Int16Samples>(interpolate_shape(scene, options).samples);
  };
  EXPECT_EQ(on(1), on(2));
}

}  // namespace
}  // namespace octotomy::voxel
