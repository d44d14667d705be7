// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/scene.h"

#include <gtest/gtest.h>

namespace octotomy::voxel {
namespace {

Scene scene_with(const Lattice& lattice) {
  Scene scene;
  scene.lattice = lattice;
  scene.samples = Int16Samples(8);
  return scene;
}

TEST(Scene, StepsWhoseSquaresOverflowOrVanishAreRefusedAndLargeOnesAreNot) {
  const glm::ivec3 dims(2);
  EXPECT_NO_THROW(check(scene_with(axis_aligned_lattice(dims, {1e100, 1e-100, 1.0}, {}))));
  EXPECT_THROW(check(scene_with(axis_aligned_lattice(dims, {1e200, 1.0, 1.0}, {}))), std::invalid_argument);
  EXPECT_THROW(check(scene_with(axis_aligned_lattice(dims, {1e-200, 1e200, 1.0}, {}))),
               std::invalid_argument);
  EXPECT_THROW(check(scene_with(axis_aligned_lattice(dims, {1.0, 1e-200, 1.0}, {}))), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
