// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/picture/relief.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>

namespace octotomy::planner {
namespace {

/// A square picture of 64 pixels of 1 mm: background, but for a block of 32 pixels at the depths of `depth`.
voxel::Picture block(float (*depth)(int x)) {
  voxel::Picture picture;
  picture.size_px = glm::ivec2(64);
  picture.pixel_mm = 1.0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      picture.depth_mm.push_back(
          x >= 16 && x < 48 && y >= 16 && y < 48 ? depth(x) : std::numeric_limits<float>::infinity());
  return picture;
}

TEST(Relief, CountsTheCornersOnObjectsAndTheirDepths) {
  const Relief flat = relief_of(block([](int) { return 7.0f; }), 16);
  EXPECT_EQ(flat.corners, 64u);
  EXPECT_EQ(flat.levels, 1u);
  const Relief steps = relief_of(block([](int x) { return static_cast<float>(x / 16); }), 16);
  EXPECT_EQ(steps.corners, 64u);
  EXPECT_EQ(steps.levels, 2u);
}

TEST(Relief, HidesFarLinesBehindNearCellsAndIsBlackOnWhite) {
  const auto dark = [](const Relief& relief) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < relief.rgb.size(); i += 3) count += relief.rgb[i] < 128 ? 1 : 0;
    return count;
  };
  const voxel::Picture plane = block([](int) { return 7.0f; });
  const Relief flat = relief_of(plane, 8);
  ASSERT_EQ(flat.rgb.size(), 3u * 64u * 64u);
  EXPECT_GT(dark(flat), 100u);
  EXPECT_EQ(flat.rgb[0], 255);
  // A picture without an object is the same plane.
  voxel::Picture nothing = plane;
  std::fill(nothing.depth_mm.begin(), nothing.depth_mm.end(), std::numeric_limits<float>::infinity());
  EXPECT_EQ(relief_of(nothing, 8).rgb, flat.rgb);
  EXPECT_EQ(relief_of(nothing, 8).corners, 0u);
  // A step towards the observer is another picture.
  EXPECT_NE(relief_of(block([](int x) { return x < 32 ? 0.0f : 20.0f; }), 8).rgb, flat.rgb);
}

}  // namespace
}  // namespace octotomy::planner
