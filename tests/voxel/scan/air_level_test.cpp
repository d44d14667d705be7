// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/air_level.h"

#include <gtest/gtest.h>
#include <random>

namespace octotomy::voxel {
namespace {

Scene scene_of(const std::vector<int>& values) {
  Scene scene;
  scene.lattice =
      axis_aligned_lattice({static_cast<int>(values.size()), 1, 1}, glm::dvec3(1.0), glm::dvec3(0.0));
  scene.samples = Int16Samples(values.begin(), values.end());
  return scene;
}

Scene in_single_precision(const Scene& scene) {
  Scene single = scene;
  const auto& samples = std::get<Int16Samples>(scene.samples);
  single.samples = FloatSamples(samples.begin(), samples.end());
  return single;
}

TEST(AirLevel, EndsItsBandsWhereItSaysAndNeverWrapsBeyondThem) {
  // Of a thousand samples, one of the value is enough to be seen.
  const auto verdict = [](int value) {
    std::vector<int> values(1000, 500);
    values[77] = value;
    return air_level_of_ct(scene_of(values)).finding.verdict;
  };
  for (const int air : {-1100, -1000, -900}) EXPECT_EQ(verdict(air), Verdict::Pass) << air;
  for (const int soft : {-899, -700, -21}) EXPECT_EQ(verdict(soft), Verdict::Warn) << soft;
  for (const int neither : {-32768, -31000, -1101, -20, 0, 32767})
    EXPECT_EQ(verdict(neither), Verdict::Fail) << neither;
}

TEST(AirLevel, CountsIntegersInVectorsAsItCountsFloatsOneByOne) {
  // Longer than what 16 bits count, and no multiple of any vector.
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    std::vector<int> values(70'001 + 1000 * seed);
    const int spread = seed % 2 == 0 ? 65536 : 1500;
    for (int& value : values) value = static_cast<int>(random() % static_cast<unsigned>(spread)) - spread / 2;
    for (std::size_t i = 0; i < values.size() / 3; ++i) values[i] = -1000;  // runs of nothing but air
    const Scene whole = scene_of(values);
    const Scene single = in_single_precision(whole);
    EXPECT_EQ(air_level_of_ct(whole).finding.detail, air_level_of_ct(single).finding.detail)
        << "seed " << seed;
    EXPECT_EQ(air_level_of_unnamed(whole).finding.detail, air_level_of_unnamed(single).finding.detail)
        << "seed " << seed;
    EXPECT_EQ(air_level_of_ct(whole).finding.verdict, Verdict::Pass);
  }
}

}  // namespace
}  // namespace octotomy::voxel
