// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/picture/removed_picture.h"

#include <gtest/gtest.h>

#include "tests/planner/ct_scene.h"

namespace octotomy::planner {
namespace {

/// A cube of 50 mm, without a box of 10 mm in it where that is gone.
voxel::Scene cube(bool is_gone) {
  return tests::ct_scene({50, 50, 50}, {1, 1, 1}, {0, 0, 0}, [&](const glm::ivec3& p, const glm::dvec3&) {
    const bool in_box = p.x >= 10 && p.x < 20 && p.y >= 30 && p.y < 40 && p.z >= 20 && p.z < 30;
    return is_gone && in_box ? -1000 : 40;
  });
}

bool is_red(const RemovedPicture& picture, int x, int y) {
  const std::size_t at = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.size_px.x) +
                              static_cast<std::size_t>(x));
  return picture.rgb[at] > picture.rgb[at + 1];
}

/// Red pixels in a tile of 280 pixels: row 0 is axial, 1 coronal, 2 sagittal.
int red(const RemovedPicture& picture, int column, int row) {
  int count = 0;
  for (int y = 0; y < 280; ++y)
    for (int x = 0; x < 280; ++x) count += is_red(picture, 280 * column + x, 280 * row + y);
  return count;
}

TEST(RemovedPicture, ShowsInRedTheSamplesThatWereOverwrittenInTheSlicesThatHoldThem) {
  const RemovedPicture picture = removed_picture(cube(false), cube(true));
  ASSERT_EQ(picture.size_px, glm::ivec2(5 * 280, 3 * 280));
  // 10 mm are 56 pixels. Slices lie at samples 5, 15, 25, 35 and 45.
  for (int column = 0; column < 5; ++column) {
    EXPECT_EQ(red(picture, column, 0), column == 2 ? 56 * 56 : 0) << "axial " << column;
    EXPECT_EQ(red(picture, column, 1), column == 3 ? 56 * 56 : 0) << "coronal " << column;
    EXPECT_EQ(red(picture, column, 2), column == 1 ? 56 * 56 : 0) << "sagittal " << column;
  }
  // The patient's back is down in axial slices, the head up in the others.
  EXPECT_TRUE(is_red(picture, 2 * 280 + 57, 169));
  EXPECT_TRUE(is_red(picture, 3 * 280 + 57, 280 + 113));
  EXPECT_FALSE(is_red(picture, 2 * 280 + 57, 280 - 169));
}

TEST(RemovedPicture, ShowsNothingInRedWhereNothingWasRemovedAndRefusesOtherVoxels) {
  const RemovedPicture picture = removed_picture(cube(true), cube(true));
  EXPECT_EQ(red(picture, 2, 0) + red(picture, 3, 1) + red(picture, 1, 2), 0);
  voxel::Scene other = cube(true);
  other.lattice.lps_from_voxel[3].x += 1.0;
  EXPECT_THROW(removed_picture(cube(false), other), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::planner
