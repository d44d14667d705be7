// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/smooth.h"

#include <gtest/gtest.h>
#include <random>
#include <tbb/global_control.h>

#include "tests/voxel/field_scene.h"

namespace octotomy::voxel {
namespace {

using tests::field_scene;
using tests::for_each_index;
using tests::sample_at;

// More slices than a slab, so that seams would show; sheared out of no axis, spacings that differ.
const Lattice tall_lattice = axis_aligned_lattice({20, 18, 45}, {1, 0.8, 1.6}, {-9.5, -7, -35});

Scene step_with_noise(double sigma, double height) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, sigma);
  return field_scene<float>(tall_lattice,
                            [&](const glm::dvec3& p) { return (p.x > 0 ? height : 0.0) + noise(random); });
}

struct Spread {
  double mean = 0.0, deviation = 0.0;
};
Spread spread_where(const Scene& scene, const std::function<bool(const glm::dvec3&)>& wanted) {
  double n = 0, sum = 0, squares = 0;
  for_each_index(scene.lattice, 2, [&](const glm::ivec3& p) {
    if (!wanted(scene.lattice.lps_mm(p))) return;
    const double value = sample_at(scene, p);
    n += 1, sum += value, squares += value * value;
  });
  return {sum / n, std::sqrt(squares / n - sum * sum / n / n)};
}

TEST(Median, TakesSpecksAwayAndLeavesAnEdgeWhereItIs) {
  Scene scene =
      field_scene<std::int16_t>(tall_lattice, [](const glm::dvec3& p) { return p.x > 0 ? 1000.0 : -500.0; });
  const Scene clean = scene;
  auto& samples = std::get<Int16Samples>(scene.samples);
  for (std::size_t i = 3; i < samples.size(); i += 97) samples[i] = 3000;
  EXPECT_NE(std::get<Int16Samples>(scene.samples), std::get<Int16Samples>(clean.samples));
  EXPECT_EQ(std::get<Int16Samples>(median(scene, {1, 1, 1}).samples), std::get<Int16Samples>(clean.samples));
  // Radius 0 is the scan itself.
  EXPECT_EQ(std::get<Int16Samples>(median(scene, {0, 0, 0}).samples), samples);
}

TEST(Median, IsTheMiddleSampleOfEveryNeighbourhoodAcrossSlabsToo) {
  std::mt19937 random(3);
  const Scene scene =
      field_scene<std::int16_t>(tall_lattice, [&](const glm::dvec3&) { return random() % 2000; });
  const Scene smooth = median(scene, {1, 0, 2});
  for_each_index(tall_lattice, 2, [&](const glm::ivec3& p) {
    std::vector<double> around;
    for (int z = -2; z <= 2; ++z)
      for (int x = -1; x <= 1; ++x) around.push_back(sample_at(scene, p + glm::ivec3(x, 0, z)));
    std::nth_element(around.begin(), around.begin() + 7, around.end());
    ASSERT_EQ(sample_at(smooth, p), around[7]) << p.x << ' ' << p.y << ' ' << p.z;
  });
}

TEST(Gaussian, LeavesALineAndAddsItsVarianceToASquare) {
  constexpr double sigma_mm = 1.3;
  const auto square = [](const glm::dvec3& p) {
    return 3.0 * p.x + p.x * p.x - 0.5 * p.y * p.y + 2.0 * p.z * p.z;
  };
  const Lattice wide = axis_aligned_lattice({40, 44, 45}, {1, 0.8, 1.6}, {-20, -17, -35});
  const Scene smooth = gaussian(field_scene<float>(wide, square), sigma_mm);
  // The mean of u^2 about u0 is u0^2 + sigma^2: (1 - 0.5 + 2) sigma^2 in all. What the weights leave out, one
  // in a thousand at the ends, takes some per cent of a variance.
  const double added = 2.5 * sigma_mm * sigma_mm;
  int compared = 0;
  for_each_index(wide, 9, [&](const glm::ivec3& p) {
    ASSERT_NEAR(sample_at(smooth, p) - square(wide.lps_mm(p)), added, 0.06 * added);
    ++compared;
  });
  EXPECT_GT(compared, 10000);
}

TEST(Gaussian, HasLindebergsWeights) {
  Scene impulse = field_scene<float>(tall_lattice, [](const glm::dvec3&) { return 0.0; });
  std::get<FloatSamples>(impulse.samples)[10 + 20 * (9 + 18 * 22)] = 1000.0F;
  const Scene smooth = gaussian(impulse, 1.6);
  double sum = 0.0, squares = 0.0;
  for (const float sample : std::get<FloatSamples>(smooth.samples)) {
    sum += static_cast<double>(sample);
    squares += std::pow(static_cast<double>(sample), 2);
  }
  EXPECT_NEAR(sum, 1000.0, 0.1);
  // Weights exp(-t) I_n(t) of variance t, in samples, have squares that sum to exp(-2 t) I_0(2 t); so much of
  // white noise is left.
  double left = 1e6;
  for (const double t : {std::pow(1.6 / 1.0, 2), std::pow(1.6 / 0.8, 2), std::pow(1.6 / 1.6, 2)})
    left *= std::exp(-2 * t) * std::cyl_bessel_i(0.0, 2 * t);
  EXPECT_NEAR(squares / left, 1.0, 0.01);
}

TEST(Diffusion, SmoothsBesideAnEdgeAndLeavesItSteepWhereAGaussianDoesNot) {
  const Scene noisy = step_with_noise(10.0, 1000.0);
  DiffusionOptions options;
  options.iterations = 8;
  options.conductance = 0.5;
  const Scene kept = diffuse(noisy, options);
  const auto left = [](const glm::dvec3& p) { return p.x < -2; };
  EXPECT_LT(spread_where(kept, left).deviation, 5.0);
  const auto jump = [&](const Scene& scene) {
    return spread_where(scene, [](const glm::dvec3& p) { return p.x > 0 && p.x < 1; }).mean -
           spread_where(scene, [](const glm::dvec3& p) { return p.x < 0 && p.x > -1; }).mean;
  };
  EXPECT_GT(jump(kept), 950.0);
  EXPECT_LT(jump(gaussian(noisy, 1.6)), 500.0);
}

TEST(Smoothing, IsTheSameOnOneThreadAndOnTwoStopsAndReports) {
  const Scene scene = step_with_noise(10.0, 300.0);
  const auto all_on = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return std::vector{std::get<FloatSamples>(median(scene, {1, 1, 1}).samples),
                       std::get<FloatSamples>(gaussian(scene, 1.0).samples),
                       std::get<FloatSamples>(diffuse(scene, {}).samples)};
  };
  EXPECT_EQ(all_on(1), all_on(2));
  // The stop is requested half-way, at a report.
  for (int which = 0; which < 3; ++which) {
    std::stop_source stop;
    int reports = 0;
    const Progress progress{stop.get_token(), [&](double fraction) {
                              EXPECT_GE(fraction, 0.0);
                              EXPECT_LE(fraction, 1.0);
                              if (++reports == 2) stop.request_stop();
                            }};
    const auto work = [&] {
      if (which == 0) median(scene, {1, 1, 1}, progress);
      if (which == 1) gaussian(scene, 1.0, progress);
      if (which == 2) diffuse(scene, {5, 1.0, progress});
    };
    EXPECT_THROW(work(), Stopped) << which;
    EXPECT_EQ(reports, 2) << which;
  }
}

TEST(Smoothing, RefusesLabelsAndOptionsOutOfRange) {
  Scene scene = step_with_noise(1.0, 1.0);
  EXPECT_THROW(median(scene, {17, 0, 0}), std::invalid_argument);
  EXPECT_THROW(median(scene, {0, -1, 0}), std::invalid_argument);
  EXPECT_THROW(gaussian(scene, 0.0), std::invalid_argument);
  EXPECT_THROW(gaussian(scene, 1000.0), std::invalid_argument);
  EXPECT_THROW(gaussian(scene, NAN), std::invalid_argument);
  EXPECT_THROW(diffuse(scene, {0, 1.0}), std::invalid_argument);
  EXPECT_THROW(diffuse(scene, {5, -1.0}), std::invalid_argument);
  scene.meaning = Meaning::Label;
  EXPECT_THROW(median(scene, {1, 1, 1}), std::invalid_argument);
  EXPECT_THROW(gaussian(scene, 1.0), std::invalid_argument);
  EXPECT_THROW(diffuse(scene, {}), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
