// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/lab.h"

#include <gtest/gtest.h>

namespace octotomy::voxel {
namespace {

TEST(Lab, WhiteBlackAndTheGreysBetweenHaveNoHue) {
  EXPECT_NEAR(glm::distance(lab_from_srgb(glm::vec3(1.0f)), {100, 0, 0}), 0.0, 1e-4);
  EXPECT_NEAR(glm::distance(lab_from_srgb(glm::vec3(0.0f)), {0, 0, 0}), 0.0, 1e-9);
  const glm::dvec3 grey = lab_from_srgb(glm::vec3(0.5f));
  EXPECT_NEAR(grey.x, 53.39, 0.01);
  EXPECT_NEAR(glm::length(glm::dvec2(grey.y, grey.z)), 0.0, 1e-4);
}

TEST(Lab, PrimariesAreWhereTheStandardsPutThem) {
  EXPECT_NEAR(glm::distance(lab_from_srgb({1, 0, 0}), {53.24, 80.09, 67.20}), 0.0, 0.03);
  EXPECT_NEAR(glm::distance(lab_from_srgb({0, 1, 0}), {87.73, -86.18, 83.18}), 0.0, 0.03);
  EXPECT_NEAR(glm::distance(lab_from_srgb({0, 0, 1}), {32.30, 79.19, -107.86}), 0.0, 0.03);
}

TEST(Lab, ThereAndBackIsTheSameColour) {
  for (int r = 0; r <= 4; ++r)
    for (int g = 0; g <= 4; ++g)
      for (int b = 0; b <= 4; ++b) {
        const glm::vec3 colour = glm::vec3(r, g, b) / 4.0f;
        EXPECT_NEAR(glm::distance(srgb_from_lab(lab_from_srgb(colour)), colour), 0.0f, 2e-4f);
      }
}

}  // namespace
}  // namespace octotomy::voxel
