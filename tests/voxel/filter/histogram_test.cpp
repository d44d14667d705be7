// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/histogram.h"

#include <gtest/gtest.h>
#include <numeric>
#include <stdexcept>

namespace octotomy::voxel {
namespace {

Scene scene_of(const std::vector<int>& values) {
  Scene scene;
  scene.lattice = axis_aligned_lattice({static_cast<int>(values.size()), 1, 1}, {1, 1, 1}, {0, 0, 0});
  scene.samples = Int16Samples(values.begin(), values.end());
  return scene;
}

TEST(Histogram, CountsEverySampleInTheBinNearestToIt) {
  const Histogram counted = histogram(scene_of({0, 1, 2, 3, 4, 4, 4, 8, 8}), 5);  // bins at 0, 2, 4, 6, 8
  EXPECT_EQ(counted.low, 0);
  EXPECT_EQ(counted.high, 8);
  EXPECT_EQ(counted.counts, (std::vector<std::uint64_t>{1, 2, 4, 0, 2}));  // halves away from zero
  EXPECT_EQ(counted.width(), 2);
  EXPECT_EQ(counted.lower_edge(2), 3);
}

TEST(Histogram, IsNotStretchedByMetalOrPadding) {
  std::vector<int> values(10000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<int>(i % 100);
  for (std::size_t i = 0; i < 5; ++i) values[i] = 30000, values[i + 5] = -30000;
  Scene scene = scene_of(values);
  const Histogram whole = histogram(scene, 100);
  EXPECT_EQ(whole.low, 0);
  EXPECT_EQ(whole.high, 99);
  EXPECT_EQ(std::accumulate(whole.counts.begin(), whole.counts.end(), std::uint64_t{0}), 10000U);
  // As floats, the same.
  const auto& samples = std::get<Int16Samples>(scene.samples);
  scene.samples = FloatSamples(samples.begin(), samples.end());
  const Histogram floats = histogram(scene, 100);
  EXPECT_EQ(floats.low, whole.low);
  EXPECT_EQ(floats.counts, whole.counts);
}

TEST(Histogram, SaysWhereThereIsNothingToTellApart) {
  EXPECT_THROW(histogram(scene_of({7, 7, 7})), std::runtime_error);
  EXPECT_THROW(histogram(scene_of({1, 2, 3}), 1), std::invalid_argument);
  // Nearly all alike: the percentiles are the same, the range is not.
  std::vector<int> values(5000, 3);
  values.front() = 11;
  EXPECT_EQ(histogram(scene_of(values)).high, 11);
}

}  // namespace
}  // namespace octotomy::voxel
