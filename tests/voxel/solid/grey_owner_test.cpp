// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/grey_owner.h"

#include <cmath>
#include <gtest/gtest.h>

#include "tests/unit_universe.h"
#include "tests/voxel/all_samples.h"
#include "tests/voxel/field_scene.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/combine_grey.h"
#include "voxel/space/view.h"

namespace octotomy::voxel {
namespace {

using tests::unit_universe;

/// Samples that rise with x by 10 a millimetre, so that each tells where it came from.
GreyOctree ramp() {
  const Universe universe = unit_universe(5);
  return grey_octree_of(universe, tests::field_scene<std::int16_t>(
                                      universe.lattice(), [](const auto& p_mm) { return 10.0 * p_mm.x; }));
}

glm::dmat4 shifted(const glm::dvec3& by_mm) {
  return moved_from_still({by_mm, 0.0, {1, 0, 0}, {0, 0, 0}});
}

Expression slab(const glm::dvec3& low_mm, const glm::dvec3& high_mm) {
  return Expression(Box{low_mm, high_mm});
}

TEST(GreyOwners, OfAMovedObjectGiveItsOwnSamplesBetweenVoxels) {
  const Expression piece = Expression(Window{ramp(), 0.0, 32767.0}) & slab({4, 4, 4}, {12, 12, 12});
  const GreyOwners owners(unit_universe(5), {{moved(piece, shifted({6.5, 0, 0}))}});
  // At x the sample that lay at x - 6.5.
  for (const double x : {13.0, 13.25, 14.75}) {
    const auto owned = owners.at({static_cast<int>(x + 0.5), 8, 8}, {x, 8.0, 8.0});
    ASSERT_TRUE(owned) << x;
    EXPECT_NEAR(owned->value(), 10.0 * (x - 6.5), 1e-9) << x;
  }
}

TEST(GreyOwners, OfAUnionGiveThoseOfTheOperandThatOwnsTheVoxelInEitherOrder) {
  const Expression head{Window{ramp(), 0.0, 32767.0}}, cut = slab({3.5, 3.5, 3.5}, {12.5, 12.5, 12.5});
  const Expression piece = moved(head & cut, shifted({8, 0, 0})), rest = head - cut;
  for (const Expression& both : {piece | rest, rest | piece}) {
    const GreyOwners owners(unit_universe(5), {{both}});
    EXPECT_EQ(owners.at({2, 8, 8}, {2, 8, 8})->value(), 20.0) << "rest alone";
    EXPECT_EQ(owners.at({6, 8, 8}, {6, 8, 8}), std::nullopt) << "the hole that the piece left";
  }
  EXPECT_EQ(GreyOwners(unit_universe(5), {{piece | rest}}).at({14, 8, 8}, {14, 8, 8})->value(), 60.0);
  EXPECT_EQ(GreyOwners(unit_universe(5), {{rest | piece}}).at({14, 8, 8}, {14, 8, 8})->value(), 140.0);
}

TEST(GreyOwners, AnswerAtVoxelsWhatACombinedGreyOctreeHolds) {
  const Expression head{Window{ramp(), 50.0, 32767.0}}, cut = slab({3.5, 3.5, 3.5}, {20.5, 12.5, 12.5});
  const Expression both = moved(head & cut, shifted({0, 7.5, 0})) | (head - cut);
  const Universe universe = unit_universe(5);
  const GreyOctree made = combine_grey(universe, both);
  const GreyOwners owners(universe, {{both}});
  int owned_count = 0;
  tests::for_each_index(universe.lattice(), 0, [&](const glm::ivec3& voxel) {
    const auto owned = owners.at(voxel, glm::dvec3(voxel));
    if (!made.scan().contains(voxel)) return;
    ASSERT_TRUE(owned);
    ASSERT_EQ(std::floor(owned->in_steps + 0.5), made.sample(voxel));
    ++owned_count;
  });
  EXPECT_GT(owned_count, 10000);
}

TEST(GreyOwners, OwnNothingBeyondTheVoxelsOfTheirSource) {
  const Universe universe = unit_universe(5);
  const Octree left = combine(universe, slab({-1, -1, -1}, {10.5, 40, 40}));
  const Expression all{Window{ramp(), -32768.0, 32767.0}};
  const GreyOwners owners(universe, {{moved(all, shifted({1, 0, 0})), left}, {all}});
  EXPECT_EQ(owners.at({10, 8, 8}, {10, 8, 8})->value(), 90.0);
  EXPECT_EQ(owners.at({11, 8, 8}, {11, 8, 8})->value(), 110.0);
}

TEST(GreyOwners, AreTheSameOfOneScanAndAnotherOfAMovedOne) {
  const GreyOctree grey = ramp();
  EXPECT_TRUE(tests::all_samples(grey).is_same(tests::all_samples(grey)));
  EXPECT_FALSE(tests::all_samples(grey).is_same(tests::all_samples(ramp())));
  const Expression all{Window{grey, -32768.0, 32767.0}};
  EXPECT_FALSE(GreyOwners(grey.universe(), {{moved(all, shifted({1, 0, 0}))}})
                   .is_same(GreyOwners(grey.universe(), {{moved(all, shifted({2, 0, 0}))}})));
}

TEST(WithSamples, KeepsTheVoxelsAndItsOwnWindowsFirst) {
  const GreyOctree other = grey_octree_of(
      unit_universe(5), tests::field_scene<std::int16_t>(unit_universe(5).lattice(),
                                                         [](const auto& p_mm) { return 1000.0 + p_mm.y; }));
  const Expression box = slab({2.5, 2.5, 2.5}, {20.5, 12.5, 12.5});
  const Expression voxels =
      (Expression(Window{ramp(), 100.0, 32767.0}) & box) | slab({2.5, 2.5, 2.5}, {6.5, 12.5, 12.5});
  const Expression completed = with_samples(voxels, all_samples(other));
  EXPECT_EQ(combine(unit_universe(5), completed), combine(unit_universe(5), voxels));
  const GreyOwners owners(unit_universe(5), {{completed}});
  EXPECT_EQ(owners.at({12, 8, 8}, {12, 8, 8})->value(), 120.0) << "its own window";
  EXPECT_EQ(owners.at({4, 8, 8}, {4, 8, 8})->value(), 1008.0) << "the other scan";
  EXPECT_EQ(&before_samples(completed.term()), &voxels.term());
  EXPECT_EQ(&before_samples(voxels.term()), &voxels.term());
}

TEST(PositiveWindows, AreThoseNotTakenAway) {
  const Expression a{Window{ramp(), 1.0, 10.0}}, b{Window{ramp(), 2.0, 10.0}}, c{Window{ramp(), 3.0, 10.0}};
  const auto lows = [](const Expression& expression) {
    std::vector<double> found;
    for (const Window& window : positive_windows(expression)) found.push_back(window.low);
    return found;
  };
  EXPECT_EQ(lows(a - (b - c)), (std::vector<double>{1.0, 3.0}));
  EXPECT_EQ(lows(~(a | ~b) & moved(c, shifted({1, 0, 0}))), (std::vector<double>{2.0, 3.0}));
  EXPECT_EQ(lows(a - ~b), (std::vector<double>{1.0, 2.0}));
}

}  // namespace
}  // namespace octotomy::voxel
