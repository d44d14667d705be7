// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/label_map.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/voxel/linear_scene.h"
#include "voxel/solid/combine.h"

namespace octotomy::voxel {
namespace {

TEST(UniverseOn, HoldsTheLatticeSampleByVoxel) {
  const Lattice lattice = tests::oblique_lattice(true);
  const Universe universe = universe_on(lattice);
  EXPECT_EQ(universe.depth, 6);
  EXPECT_EQ(universe.lps_from_voxel, lattice.lps_from_voxel);
  Lattice huge = lattice;
  huge.dims.y = 5000;
  EXPECT_THROW(universe_on(huge), std::length_error);
}

TEST(LabelMap, ComesBackAsTheObjectsItWasMadeOf) {
  for (const bool left_handed : {false, true}) {
    const Lattice lattice = tests::oblique_lattice(left_handed);
    const Universe universe = universe_on(lattice);
    const glm::dvec3 a = lattice.lps_mm({12, 10, 8});
    const glm::dvec3 b = lattice.lps_mm({28, 18, 12});
    const Octree small = combine(universe, Sphere{a, 7.0});
    const Octree large = combine(universe, Expression(Sphere{b, 9.5}) - Sphere{a, 7.0});
    const std::vector<Octree> objects{small, large};
    const LabelMap map = label_map(lattice, objects);
    EXPECT_EQ(map.overlaps, 0U);
    EXPECT_EQ(map.scene.meaning, Meaning::Label);
    const std::vector<Label> found = labels(map.scene);
    ASSERT_EQ(found.size(), 2U);
    for (int i = 0; i < 2; ++i) {
      const Octree& truth = objects[static_cast<std::size_t>(i)];
      EXPECT_EQ(found[static_cast<std::size_t>(i)].number, i + 1);
      EXPECT_EQ(found[static_cast<std::size_t>(i)].samples, truth.voxel_count());
      EXPECT_TRUE(octree_of_label(universe, map.scene, i + 1) == truth);
    }
    EXPECT_GT(small.voxel_count(), 300U);
    EXPECT_FALSE(octree_of_label(universe, map.scene, 1) == large);  // the spoiled twin
    EXPECT_TRUE(octree_of_label(universe, map.scene, 3).is_empty());
  }
}

TEST(ChosenSamples, AreTheBasesOwnWhereNothingWasChosenAndTheChosenPartsWhereSomethingWas) {
  for (const bool left_handed : {false, true}) {
    // Finer voxels beside an oblique lattice: no sample is a voxel's centre.
    const Lattice lattice = tests::oblique_lattice(left_handed);
    const Universe own = universe_on(lattice), fine = universe_around(bounds(lattice), 0.4);
    const glm::dvec3 a = lattice.lps_mm({12, 10, 8}), b = lattice.lps_mm({28, 18, 12});
    const Expression balls = Expression(Sphere{a, 4.0}) | Sphere{b, 5.0};
    const Octree samples = combine(own, balls), base = combine(fine, balls);
    EXPECT_TRUE(chosen_samples(lattice, samples, base, base) == samples);
    const Octree one = chosen_samples(lattice, samples, base, combine(fine, Sphere{b, 5.0}));
    EXPECT_TRUE(one == combine(own, Sphere{b, 5.0}));
    EXPECT_GT(one.voxel_count(), 100U);
    // What was added has no samples of its own: its nearest voxels say where it is.
    const Octree more = chosen_samples(lattice, samples, base, combine(fine, balls | Sphere{a, 5.0}));
    EXPECT_TRUE(combine(own, Expression(samples) - more).is_empty());
    EXPECT_TRUE(combine(own, Expression(more) - (balls | Sphere{a, 5.5})).is_empty());
    EXPECT_TRUE(combine(own, Expression(Sphere{a, 4.5}) - more).is_empty());
    EXPECT_FALSE(chosen_samples(lattice, combine(own, Sphere{a, 4.0}), base, base) == samples);  // spoiled
  }
}

TEST(LabelMap, GivesVoxelsOfSeveralObjectsToTheFirstAndCountsThem) {
  const Lattice lattice = axis_aligned_lattice({20, 20, 20}, {1, 1, 1}, {0, 0, 0});
  const Universe universe = universe_on(lattice);
  const std::vector<Octree> objects{combine(universe, Box{{0, 0, 0}, {9.5, 19.5, 19.5}}),
                                    combine(universe, Box{{4.5, 0, 0}, {19.5, 19.5, 19.5}})};
  const LabelMap map = label_map(lattice, objects);
  EXPECT_EQ(map.overlaps, 5U * 400);
  const std::vector<Label> found = labels(map.scene);
  EXPECT_EQ(found[0].samples, 10U * 400);
  EXPECT_EQ(found[1].samples, 10U * 400);
}

TEST(LabelMap, IsTakenToOtherVoxelsByTheNearestSampleNeverByAMeanOfLabels) {
  // Labels 1 and 3 side by side: a mean would be 2.
  Scene scene;
  scene.lattice = axis_aligned_lattice({8, 8, 8}, {2, 2, 2}, {1, 1, 1});
  Int16Samples samples(512);
  for (std::size_t i = 0; i < 512; ++i) samples[i] = i % 8 < 4 ? 1 : 3;
  scene.samples = std::move(samples);
  const Universe fine{4, axis_aligned_lattice({1, 1, 1}, {1, 1, 1}, {0.5, 0.5, 0.5}).lps_from_voxel};
  EXPECT_EQ(octree_of_label(fine, scene, 1).voxel_count(), 8U * 256);
  EXPECT_EQ(octree_of_label(fine, scene, 3).voxel_count(), 8U * 256);
  EXPECT_TRUE(octree_of_label(fine, scene, 2).is_empty());
}

TEST(Labels, AreWholeNumbers) {
  Scene scene;
  scene.lattice = axis_aligned_lattice({2, 1, 1}, {1, 1, 1}, {0, 0, 0});
  scene.samples = FloatSamples{1.0F, 1.5F};
  EXPECT_THROW(labels(scene), std::invalid_argument);
  scene.samples = Int16Samples{-1, 1};
  EXPECT_THROW(labels(scene), std::invalid_argument);
  scene.samples = FloatSamples{0.0F, 7.0F};
  ASSERT_EQ(labels(scene).size(), 1U);
  EXPECT_EQ(labels(scene)[0].number, 7);
}

TEST(Labels, AreThoseThatFilesStoreWithAFractionOrBeyondSixteenBits) {
  Scene scene;
  scene.lattice = axis_aligned_lattice({6, 1, 1}, {1, 1, 1}, {0, 0, 0});
  scene.samples = FloatSamples{2.9999F, 3.0001F, 3.0F, 0.00001F, 40000.0F, 16777215.0F};
  const std::vector<Label> found = labels(scene);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].number, 3);
  EXPECT_EQ(found[0].samples, 3U);
  EXPECT_NEAR(found[0].off, 1e-4, 1e-6);
  EXPECT_EQ(found[1].number, 40000);
  EXPECT_EQ(found[1].off, 0.0);
  EXPECT_EQ(found[2].number, most_label);
  const Universe universe = universe_on(scene.lattice);
  EXPECT_EQ(octree_of_label(universe, scene, 3).voxel_count(), 3U);
  EXPECT_EQ(octree_of_label(universe, scene, 40000).voxel_count(), 1U);
  for (const double none : {2.98, 2.5, -1.0, -0.02, 16777216.0, 16777217.5})
    EXPECT_FALSE(label_of(none)) << none << " is no label";
}

TEST(Labels, ThatOverlapStandInLayersWhereEachIsWhole) {
  Scene scene;
  scene.lattice = axis_aligned_lattice({5, 1, 1}, {1, 1, 1}, {0, 0, 0});
  scene.samples = Int16Samples{2, 7, 8, 5, 0};
  scene.overlaps = {{8, {2, 5}}};
  ASSERT_EQ(labels(scene).size(), 3U);
  EXPECT_EQ(labels(scene)[0].samples, 2U);
  const std::vector<LabelLayer> layers = label_layers(scene);
  ASSERT_EQ(layers.size(), 2U);
  EXPECT_EQ(layers[0].labels, (std::vector<int>{2, 7}));
  EXPECT_EQ(layers[1].labels, std::vector<int>{5});
  EXPECT_EQ(std::get<Int16Samples>(layers[0].ranks.samples), (Int16Samples{1, 2, 1, 0, 0}));
  EXPECT_EQ(std::get<Int16Samples>(layers[1].ranks.samples), (Int16Samples{0, 0, 1, 1, 0}));
}

TEST(LabelMap, StopsWhenAskedAndIsTheSameOnAnyThreads) {
  const Lattice lattice = tests::oblique_lattice();
  const Universe universe = universe_on(lattice);
  const std::vector<Octree> objects{combine(universe, Sphere{lattice.lps_mm({20, 15, 10}), 9.0})};
  const auto on = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return std::get<Int16Samples>(label_map(lattice, objects).scene.samples);
  };
  EXPECT_EQ(on(1), on(2));
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(label_map(lattice, objects, {stop.get_token(), {}}), Stopped);
}

}  // namespace
}  // namespace octotomy::voxel
