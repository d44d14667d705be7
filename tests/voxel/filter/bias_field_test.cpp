// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/bias_field.h"

#include <cmath>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/voxel/field_scene.h"

namespace octotomy::voxel {
namespace {

using tests::field_scene;
using tests::for_each_index;
using tests::sample_at;

constexpr double brain_radius_mm = 60.0;

Lattice head_lattice() {
  return axis_aligned_lattice({64, 64, 56}, {2.2, 2.2, 2.5}, {-69.3, -69.3, -68.75});
}

/// A field that changes by a third across the head, along a direction of no axis.
double field_at(const glm::dvec3& p) {
  return std::exp(0.25 * (p.x + 0.5 * p.y - 0.3 * p.z) / brain_radius_mm -
                  0.15 * glm::dot(p, p) / (brain_radius_mm * brain_radius_mm));
}

/// A ball of two tissues of 100 and 180 in eight layers along x, in air of 2.
double tissue_at(const glm::dvec3& p) {
  if (glm::length(p) > brain_radius_mm) return 2.0;
  return static_cast<int>(std::floor((p.x + 80.0) / 20.0)) % 2 == 0 ? 100.0 : 180.0;
}

Scene head(bool has_field) {
  Scene scene = field_scene<std::int16_t>(
      head_lattice(), [&](const glm::dvec3& p) { return tissue_at(p) * (has_field ? field_at(p) : 1.0); });
  scene.meaning = Meaning::Raw;
  scene.modality = "MR";
  return scene;
}

/// The standard deviation over the mean, of samples inside of one tissue.
double variation(const Scene& scene, double tissue) {
  double count = 0.0, sum = 0.0, squares = 0.0;
  for_each_index(scene.lattice, 1, [&](const glm::ivec3& at) {
    const glm::dvec3 p = scene.lattice.lps_mm(at);
    if (tissue_at(p) != tissue || glm::length(p) > brain_radius_mm - 3.0) return;
    const double sample = sample_at(scene, at);
    count += 1.0;
    sum += sample;
    squares += sample * sample;
  });
  EXPECT_GT(count, 5000.0);
  const double mean = sum / count;
  return std::sqrt(std::max(0.0, squares / count - mean * mean)) / mean;
}

TEST(BiasField, OfAPhantomIsFoundAndTheVariationWithinATissueFalls) {
  const Scene spoiled = head(true);
  const BiasCorrection even = correct_bias_field(spoiled, {.threshold = 30.0});
  for (const double tissue : {100.0, 180.0}) {
    EXPECT_GT(variation(spoiled, tissue), 0.10);
    EXPECT_LT(variation(even.scene, tissue), 0.25 * variation(spoiled, tissue)) << tissue;
  }
  // The field that was divided out is the known one, but for its scale.
  double low = 1e9, high = 0.0;
  for_each_index(spoiled.lattice, 1, [&](const glm::ivec3& at) {
    const glm::dvec3 p = spoiled.lattice.lps_mm(at);
    if (glm::length(p) > brain_radius_mm - 3.0) return;
    const double error = sample_at(spoiled, at) / sample_at(even.scene, at) / field_at(p);
    low = std::min(low, error);
    high = std::max(high, error);
  });
  EXPECT_LT(high / low, 1.2);
  EXPECT_LT(even.field_low, 0.85);
  EXPECT_GT(even.field_high, 1.1);
}

TEST(BiasField, OfAnEvenScanChangesLittle) {
  const Scene scene = head(false);
  const BiasCorrection even = correct_bias_field(scene, {.threshold = 30.0});
  EXPECT_GT(even.field_low, 0.97);
  EXPECT_LT(even.field_high, 1.03);
}

TEST(BiasField, GuessesAThresholdBetweenAirAndTissue) {
  const BiasCorrection even = correct_bias_field(head(true), {.levels = 1, .iterations = 1});
  EXPECT_GT(even.threshold, 2.0);
  EXPECT_LT(even.threshold, 100.0);
}

TEST(BiasField, IsTheSameOnAnyThreadsAndKeepsPadding) {
  Scene scene = head(true);
  auto& samples = std::get<Int16Samples>(scene.samples);
  for (std::size_t i = 0; i < 64; ++i) samples[i] = -1;
  scene.padding = -1.0;
  const auto on = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return std::get<FloatSamples>(
        correct_bias_field(scene, {.threshold = 30.0, .levels = 2, .iterations = 5}).scene.samples);
  };
  const FloatSamples one = on(1);
  EXPECT_EQ(one, on(2));
  EXPECT_EQ(one[3], -1.0F);
}

TEST(BiasField, RefusesWhatNoMagneticFieldMade) {
  Scene scene = head(true);
  EXPECT_THROW(correct_bias_field(scene, {.threshold = -1.0}), std::invalid_argument);
  EXPECT_THROW(correct_bias_field(scene, {.knots_mm = 0.0}), std::invalid_argument);
  EXPECT_THROW(correct_bias_field(scene, {.levels = 0}), std::invalid_argument);
  EXPECT_THROW(correct_bias_field(scene, {.iterations = 0}), std::invalid_argument);
  EXPECT_THROW(correct_bias_field(scene, {.threshold = 5000.0}), Error);
  Scene bright = head(true);
  FloatSamples samples;
  for (const std::int16_t sample : std::get<Int16Samples>(bright.samples))
    samples.push_back(std::min(3.4e38F, 3e36F * static_cast<float>(sample)));
  bright.samples = std::move(samples);
  EXPECT_THROW(correct_bias_field(bright, {}), Error)
      << "a sample that the field raises leaves single precision";
  std::stop_source stop;
  stop.request_stop();
  BiasFieldOptions stopped;
  stopped.progress.stop = stop.get_token();
  EXPECT_THROW(correct_bias_field(scene, stopped), Stopped);
  scene.meaning = Meaning::Hounsfield;
  EXPECT_THROW(correct_bias_field(scene, {}), std::invalid_argument);
  scene.meaning = Meaning::Label;
  EXPECT_THROW(correct_bias_field(scene, {}), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
