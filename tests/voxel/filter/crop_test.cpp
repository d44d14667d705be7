// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/crop.h"

#include <gtest/gtest.h>

#include "tests/voxel/field_scene.h"
#include "tests/voxel/linear_scene.h"

namespace octotomy::voxel {
namespace {

using tests::for_each_index;
using tests::sample_at;

TEST(Crop, KeepsEverySampleWhereItWas) {
  for (const bool left_handed : {false, true}) {
    const Scene scene = tests::linear_scene(tests::oblique_lattice(left_handed));
    const Scene part = crop(scene, {{3, 5, 7}, {20, 9, 11}});
    EXPECT_EQ(part.lattice.dims, glm::ivec3(18, 5, 5));
    EXPECT_EQ(part.meaning, scene.meaning);
    for_each_index(part.lattice, 0, [&](const glm::ivec3& p) {
      ASSERT_EQ(sample_at(part, p), sample_at(scene, p + glm::ivec3(3, 5, 7)));
      ASSERT_EQ(sample_at(part, p), std::lround(tests::linear_field(part.lattice.lps_mm(p))));
    });
  }
}

TEST(Crop, RefusesWhatIsNotInTheScan) {
  const Scene scene = tests::linear_scene(tests::oblique_lattice());
  EXPECT_THROW(crop(scene, {}), std::invalid_argument);
  EXPECT_THROW(crop(scene, {{-1, 0, 0}, {3, 3, 3}}), std::invalid_argument);
  EXPECT_THROW(crop(scene, {{0, 0, 0}, {40, 3, 3}}), std::invalid_argument);
}

TEST(RangeWithin, HoldsTheCentresInTheBoxAndNoOthers) {
  Lattice lattice = axis_aligned_lattice({20, 20, 20}, {1, 2, 0.5}, {10, -20, 5});
  const VoxelRange range = range_within(lattice, {{12, -16.5, 6.1}, {15.9, -10, 8}});
  EXPECT_EQ(range.low, glm::ivec3(2, 2, 3));
  EXPECT_EQ(range.high, glm::ivec3(5, 5, 6));
  lattice.lps_from_voxel[0][0] = -1;  // x now runs from 10 to the right
  EXPECT_EQ(range_within(lattice, {{4, -100, -100}, {8, 100, 100}}).low.x, 2);
  EXPECT_TRUE(range_within(lattice, {{40, 0, 0}, {50, 1, 1}}).is_empty());
  // Huge boxes are the whole scan.
  EXPECT_EQ(range_within(lattice, {glm::dvec3(-1e12), glm::dvec3(1e12)}).dims(), lattice.dims);
}

TEST(AverageDown, OfALinearFieldIsTheFieldAtTheBlocksMiddles) {
  for (const bool left_handed : {false, true}) {
    const Lattice lattice = tests::oblique_lattice(left_handed);
    const Scene scene = tests::field_scene<float>(lattice, tests::linear_field);
    const Scene small = average_down(scene, {2, 3, 4});
    EXPECT_EQ(small.lattice.dims, glm::ivec3(20, 10, 5));
    EXPECT_NEAR(small.lattice.voxel_mm3(), 24 * lattice.voxel_mm3(), 1e-9);
    for_each_index(small.lattice, 0, [&](const glm::ivec3& p) {
      ASSERT_NEAR(sample_at(small, p), tests::linear_field(small.lattice.lps_mm(p)), 2e-3);
    });
  }
}

TEST(AverageDown, TakesTheMeanOfWhatABlockAtTheEndHasAndRoundsHalvesUpwards) {
  Scene scene;
  scene.lattice = axis_aligned_lattice({5, 1, 1}, {1, 1, 1}, {0, 0, 0});
  scene.samples = Int16Samples{1, 2, -1, -2, 7};
  const Scene small = average_down(scene, {2, 1, 1});
  EXPECT_EQ(std::get<Int16Samples>(small.samples), (Int16Samples{2, -1, 7}));
  scene.meaning = Meaning::Label;
  EXPECT_THROW(average_down(scene, {2, 1, 1}), std::invalid_argument);
  scene.meaning = Meaning::Raw;
  EXPECT_THROW(average_down(scene, {0, 1, 1}), std::invalid_argument);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(average_down(scene, {2, 1, 1}, {stop.get_token(), {}}), Stopped);
}

}  // namespace
}  // namespace octotomy::voxel
