// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/streak_clamp.h"

#include <gtest/gtest.h>

#include "tests/voxel/field_scene.h"

namespace octotomy::voxel {
namespace {

using tests::sample_at;

const Lattice tooth_lattice = axis_aligned_lattice({60, 40, 5}, {1, 1, 2}, {0, 0, 0});

// Soft tissue, a filling at (10, 20) of slice 2, a streak through it along x, bright and dark by turns.
Scene streaked() {
  return tests::field_scene<std::int16_t>(tooth_lattice, [](const glm::dvec3& p) {
    if (p.z != 4 || p.y != 20) return 40.0;
    if (p.x == 10) return 5000.0;
    return static_cast<int>(p.x) % 2 == 0 ? 2800.0 : -1500.0;
  });
}

TEST(StreakClamp, LimitsWhatIsNearMetalInItsSliceAndNothingElse) {
  Scene scene = streaked();
  std::get<Int16Samples>(scene.samples)[5] = 2900;  // bright, but in a slice without metal
  StreakOptions options;
  options.low = -1000;
  options.high = 2000;
  options.reach_mm = 30;
  const StreakClamp clamp = clamp_streaks(scene, options);
  EXPECT_EQ(clamp.metal, 1U);
  EXPECT_EQ(clamp.slices, 1);
  EXPECT_EQ(clamp.raised, 20U);   // odd x from 1 to 39
  EXPECT_EQ(clamp.lowered, 21U);  // even x from 0 to 40, the filling among them
  for (int x = 0; x < 60; ++x) {
    const double before = sample_at(scene, {x, 20, 2});
    EXPECT_EQ(sample_at(clamp.scene, {x, 20, 2}), x <= 40 ? std::clamp(before, -1000.0, 2000.0) : before)
        << x;
  }
  EXPECT_EQ(sample_at(clamp.scene, {5, 0, 0}), 2900);
  EXPECT_EQ(sample_at(clamp.scene, {10, 19, 2}), 40);
}

TEST(StreakClamp, LeavesAScanWithoutMetalAsItIs) {
  Scene scene = streaked();
  StreakOptions options;
  options.metal = 5001;
  const StreakClamp clamp = clamp_streaks(scene, options);
  EXPECT_EQ(clamp.metal + clamp.raised + clamp.lowered, 0U);
  EXPECT_EQ(std::get<Int16Samples>(clamp.scene.samples), std::get<Int16Samples>(scene.samples));
}

TEST(StreakClamp, RefusesBoundsThatAreNone) {
  StreakOptions options;
  options.low = options.high;
  EXPECT_THROW(clamp_streaks(streaked(), options), std::invalid_argument);
  options.low = -1000;
  options.reach_mm = -1;
  EXPECT_THROW(clamp_streaks(streaked(), options), std::invalid_argument);
  options.reach_mm = 1;
  std::stop_source stop;
  stop.request_stop();
  options.progress.stop = stop.get_token();
  EXPECT_THROW(clamp_streaks(streaked(), options), Stopped);
}

}  // namespace
}  // namespace octotomy::voxel
