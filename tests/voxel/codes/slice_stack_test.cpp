// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/slice_stack.h"

#include <gtest/gtest.h>
#include <random>

#include "voxel/filter/resample_slices.h"

namespace octotomy::voxel {
namespace {

std::shared_ptr<const Scene> noise_scene() {
  auto scene = std::make_shared<Scene>();
  scene->lattice = axis_aligned_lattice({5, 4, 7}, {1.0, 1.0, 4.0}, glm::dvec3(0.0));
  std::mt19937_64 random(5);
  Int16Samples samples;
  for (std::size_t i = 0; i < scene->lattice.sample_count(); ++i)
    samples.push_back(static_cast<std::int16_t>(static_cast<int>(random() % 2000) - 1000));
  scene->samples = std::move(samples);
  return scene;
}

TEST(SliceStack, ReadsWhatInterpolatedSlicesHold) {
  const auto scene = noise_scene();
  const SliceStack stack(scene);
  const Scene fine = resample_slices(*scene, 1.0, SliceKernel::Linear);
  const auto& samples = std::get<Int16Samples>(fine.samples);
  ASSERT_EQ(fine.lattice.dims, glm::ivec3(5, 4, 25));
  std::size_t i = 0;
  for (int z = 0; z < 25; ++z)
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 5; ++x, ++i) EXPECT_NEAR(*stack.sample(x, y, z / 4.0), samples[i], 0.501);
  EXPECT_EQ(stack.bytes(), 2U * 5 * 4 * 7);
  EXPECT_EQ(stack.bytes_interpolated(25), 2U * 5 * 4 * 25);
}

TEST(SliceStack, FindsTheFirstCrossingFromEitherSide) {
  const SliceStack stack(noise_scene());
  int found = 0;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 5; ++x)
      for (const auto& [from, to] : {std::pair(0.3, 5.8), std::pair(5.8, 0.3)}) {
        const auto z = stack.first_at_least(x, y, 200.0, from, to);
        // The same in small steps.
        std::optional<double> expected;
        for (int i = 0; i <= 5500 && !expected; ++i) {
          const double at = from + (to - from) * i / 5500.0;
          if (*stack.sample(x, y, at) >= 200.0) expected = at;
        }
        ASSERT_EQ(z.has_value(), expected.has_value());
        if (!z) continue;
        EXPECT_NEAR(*z, *expected, 0.0011);
        found += *z != from;
      }
  EXPECT_GT(found, 10);
}

TEST(SliceStack, HasNoSampleOutsideAndNoFloats) {
  const SliceStack stack(noise_scene());
  EXPECT_FALSE(stack.sample(5, 0, 0.0));
  EXPECT_FALSE(stack.sample(0, 0, 6.1));
  EXPECT_TRUE(stack.sample(4, 3, 6.0));
  auto floats = std::make_shared<Scene>(*noise_scene());
  floats->samples = FloatSamples(floats->lattice.sample_count(), 1.0f);
  EXPECT_THROW(SliceStack{floats}, std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
