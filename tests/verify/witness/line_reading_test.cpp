// SPDX-License-Identifier: AGPL-3.0-or-later
// Lines through the window of a scan against the trilinear interpolant at dense points.
#include "verify/witness/line_reading.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <optional>

#include "verify/phantom/chance.h"
#include "voxel/space/scene.h"

namespace octotomy::verify {
namespace {

constexpr double endless = std::numeric_limits<double>::infinity();
constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

voxel::Scene noise(const glm::ivec3& dims, std::optional<double> padding = {}) {
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice(dims, {1.0, 0.7, 1.9}, {-3.0, 2.0, 5.0});
  voxel::Int16Samples samples(scene.lattice.sample_count());
  Chance chance(5);
  for (std::int16_t& sample : samples)
    sample = static_cast<std::int16_t>(
        padding && chance.between(0.0, 1.0) < 0.1 ? *padding : chance.between(0.0, 100.0));
  scene.samples = std::move(samples);
  scene.padding = padding;
  return scene;
}

/// The interpolant at a place in samples. Beside padding the nearest sample; not a number outside the scan.
double interpolant(const voxel::Scene& scene, const glm::dvec3& place) {
  const glm::ivec3 dims = scene.lattice.dims;
  if (glm::any(glm::lessThan(place, glm::dvec3(-0.5))) ||
      glm::any(glm::greaterThan(place, glm::dvec3(dims) - 0.5)))
    return no_number;
  const glm::dvec3 u = glm::clamp(place, glm::dvec3(0.0), glm::dvec3(dims - 1));
  const glm::ivec3 first = glm::clamp(glm::ivec3(u), glm::ivec3(0), glm::max(dims - 2, 0));
  const glm::dvec3 part = u - glm::dvec3(first);
  double sum = 0.0, nearest = 0.0;
  bool has_padding = false;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 step(corner & 1, corner >> 1 & 1, corner >> 2 & 1), p = glm::min(first + step, dims - 1);
    const double value = std::get<voxel::Int16Samples>(
        scene.samples)[static_cast<std::size_t>(p.x + dims.x * (p.y + dims.y * p.z))];
    const glm::dvec3 weight = glm::mix(1.0 - part, part, glm::dvec3(step));
    sum += weight.x * weight.y * weight.z * value;
    const bool is_padding = scene.padding && value == *scene.padding;
    has_padding = has_padding || is_padding;
    if (glm::ivec3(glm::greaterThanEqual(part, glm::dvec3(0.5))) == step)
      nearest = is_padding ? no_number : value;
  }
  return has_padding ? nearest : sum;
}

/// Lines in all directions through the scan; every fourth is parallel to an axis, some of these in a plane of samples.
Line line_through(const voxel::Scene& scene, int number, Chance& chance) {
  const glm::dvec3 dims(scene.lattice.dims);
  glm::dvec3 u = dims * glm::dvec3(chance.between(0, 1), chance.between(0, 1), chance.between(0, 1)) - 0.5;
  glm::dvec3 along = glm::normalize(glm::dvec3(chance.even(), chance.even(), chance.even()));
  if (number % 4 == 0) {
    along = glm::dvec3(0.0);
    along[number / 4 % 3] = number % 8 == 0 ? 1.0 : -1.0;
    if (number % 16 == 0) u = glm::floor(glm::max(u, 0.0));
  }
  return {scene.lattice.lps_mm(u) - 30.0 * along, along};
}

bool holds(const Spans& spans, double at_mm) {
  return std::any_of(spans.begin(), spans.end(),
                     [at_mm](const Span& s) { return at_mm >= s.low_mm && at_mm <= s.high_mm; });
}

void expect_dense_samples(const voxel::Scene& scene, double low, double high) {
  const LineReading reading = lines_in_window(std::make_shared<const voxel::Scene>(scene), low, high);
  const glm::dmat4 scan_from_lps = glm::inverse(scene.lattice.lps_from_voxel);
  Chance chance(3);
  int inside = 0, wrong = 0;
  for (int number = 0; number < 400; ++number) {
    const Line line = line_through(scene, number, chance);
    const Spans spans = reading.inside(line, {{0.0, 60.0}});
    const auto value = [&](double at_mm) {
      return interpolant(scene, scan_from_lps * glm::dvec4(line.from_mm + at_mm * line.along, 1.0));
    };
    for (int k = 0; k < 3000; ++k) {
      const double at_mm = 0.02 * k + 0.0071;
      const bool is_inside = value(at_mm) >= low && value(at_mm) <= high;
      inside += is_inside ? 1 : 0;
      if (is_inside == holds(spans, at_mm)) continue;
      // A point on the border is on either side.
      const auto at = [&](double mm) { return value(mm) >= low && value(mm) <= high; };
      wrong += at(at_mm - 1e-9) == is_inside && at(at_mm + 1e-9) == is_inside ? 1 : 0;
    }
  }
  EXPECT_GT(inside, 1000);
  EXPECT_EQ(wrong, 0);
}

TEST(LinesInWindow, AreInsideWhereDenseSamplesAre) {
  expect_dense_samples(noise({11, 12, 9}), 50.0, endless);
  expect_dense_samples(noise({11, 12, 9}), 40.0, 55.0);
  expect_dense_samples(noise({11, 12, 9}), -endless, 20.0);
  expect_dense_samples(noise({17, 1, 5}), 30.0, 70.0);
}

TEST(LinesInWindow, AreInsideWhereTheNearestSampleIsBesidePadding) {
  expect_dense_samples(noise({11, 12, 9}, -1000.0), 40.0, 80.0);
  expect_dense_samples(noise({9, 5, 8}, -1000.0), -endless, 50.0);
}

TEST(LinesInWindow, HaveTheSameEndsWhicheverPartIsRead) {
  const voxel::Scene scene = noise({11, 12, 9});
  const LineReading reading = lines_in_window(std::make_shared<const voxel::Scene>(scene), 45.0, 60.0);
  Chance chance(9);
  for (int number = 0; number < 200; ++number) {
    const Line line = line_through(scene, number, chance);
    const Spans whole = reading.inside(line, {{0.0, 60.0}});
    for (int k = 0; k < 20; ++k) {
      const double low_mm = chance.between(0.0, 60.0), high_mm = low_mm + chance.between(0.0, 5.0);
      Spans wanted;
      for (const Span& span : whole)
        if (std::min(span.high_mm, high_mm) > std::max(span.low_mm, low_mm))
          wanted.push_back({std::max(span.low_mm, low_mm), std::min(span.high_mm, high_mm)});
      const Spans part = reading.inside(line, {{low_mm, high_mm}});
      ASSERT_EQ(part.size(), wanted.size()) << number;
      for (std::size_t i = 0; i < part.size(); ++i) {
        EXPECT_EQ(part[i].low_mm, wanted[i].low_mm);
        EXPECT_EQ(part[i].high_mm, wanted[i].high_mm);
      }
    }
  }
}

TEST(LinesInWindow, FindALayerOfAThousandthOfASample) {
  // One cell whose samples are alternately 0 and 1000 along x, y and z.
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice({2, 2, 2}, glm::dvec3(1.0), glm::dvec3(0.0));
  scene.samples = voxel::FloatSamples{0, 1000, 1000, 0, 1000, 0, 0, 1000};
  const Line diagonal{glm::dvec3(0.0), glm::normalize(glm::dvec3(1.0))};
  // Across a face the interpolant is 1000 (2 s - 2 s^2) and has a peak of 500.
  const Line across{glm::dvec3(0.0), glm::normalize(glm::dvec3(1.0, 1.0, 0.0))};
  const auto scan = std::make_shared<const voxel::Scene>(scene);
  const double below = 0.004;  // the peak's width at this depth is 2 sqrt(0.004 / 2000) of the way
  const Spans layer = lines_in_window(scan, 500.0 - below, endless).inside(across, {{0.0, 1.4}});
  ASSERT_EQ(layer.size(), 1U);
  const double half_mm = std::sqrt(2.0) * std::sqrt(below / 2000.0);
  EXPECT_NEAR(layer[0].low_mm, std::sqrt(0.5) - half_mm, 1e-9);
  EXPECT_NEAR(layer[0].high_mm, std::sqrt(0.5) + half_mm, 1e-9);
  EXPECT_TRUE(lines_in_window(scan, 500.0 + below, endless).inside(across, {{0.0, 1.4}}).empty());
  // Along the diagonal it is 500 (1 - (1 - 2 s)^3) and crosses 500 -+ 4 where (1 - 2 s)^3 is +- 0.008.
  const Spans crossed = lines_in_window(scan, 496.0, 504.0).inside(diagonal, {{0.0, 1.7}});
  ASSERT_EQ(crossed.size(), 1U);
  EXPECT_NEAR(crossed[0].low_mm, 0.4 * std::sqrt(3.0), 1e-9);
  EXPECT_NEAR(crossed[0].high_mm, 0.6 * std::sqrt(3.0), 1e-9);
}

}  // namespace
}  // namespace octotomy::verify
