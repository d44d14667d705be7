// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/slice_mask.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "voxel/solid/combine.h"

namespace octotomy::voxel {
namespace {

const Universe universe = universe_around({{-16, -16, -16}, {16, 16, 16}}, 0.5);

std::vector<glm::dvec2> circle(const glm::dvec2& centre_mm, double radius_mm) {
  std::vector<glm::dvec2> points;
  for (int i = 0; i < 96; ++i) {
    const double turn = 2 * std::numbers::pi * i / 96;
    points.push_back(centre_mm + radius_mm * glm::dvec2(std::cos(turn), std::sin(turn)));
  }
  return points;
}

// Inferior: look towards the head, so that a slice's position is its z.
SliceMask along_z(std::vector<SliceMask::Slice> slices) {
  SliceMask mask;
  mask.view = parse_view("inferior");
  mask.slices = std::move(slices);
  return mask;
}

TEST(SliceMask, OfTwoCirclesIsAConeBetweenThem) {
  const Octree octree = combine(universe, along_z({{-10, {circle({0, 0}, 12)}}, {10, {circle({0, 0}, 4)}}}));
  const Lattice lattice = universe.lattice();
  std::uint64_t inside = 0;
  for (int z = 0; z < 64; ++z)
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        const glm::dvec3 p = lattice.lps_mm({x, y, z});
        // Beyond the outer slices the first and last region go on, here out of the universe.
        const double radius = 8.0 - 0.4 * std::clamp(p.z, -10.0, 10.0);
        const double off = std::hypot(p.x, p.y) - radius;
        if (std::abs(off) < 0.02) continue;  // a polygon of 96 corners is within 0.007 of its circle
        ASSERT_EQ(octree.contains({x, y, z}), off < 0) << x << ' ' << y << ' ' << z;
        inside += off < 0;
      }
  EXPECT_GT(inside, 30000U);
}

TEST(SliceMask, SpeaksForHalfAGapBeyondItsOuterSlices) {
  const Octree octree = combine(universe, along_z({{-3, {circle({0, 0}, 6)}}, {1, {circle({0, 0}, 6)}}}));
  const auto at = [&](double z) {
    return octree.contains(glm::ivec3(glm::round(universe.lattice().voxel({0.25, 0.25, z}))));
  };
  EXPECT_FALSE(at(-5.25));
  EXPECT_TRUE(at(-4.75));
  EXPECT_TRUE(at(2.75));
  EXPECT_FALSE(at(3.25));
}

TEST(SliceMask, NearestStepsInTheMiddleWhereShapesFollowEachOther) {
  SliceMask mask = along_z({{-8, {circle({-6, 0}, 5)}}, {8, {circle({6, 0}, 5)}}});
  const auto volume = [&] { return static_cast<double>(combine(universe, mask).voxel_count()) * 0.125; };
  // The two circles overlap in nothing but a sliver, so between them the weighted distances are nowhere
  // negative on the way: shape-based interpolation narrows, the nearest region does not.
  const double shaped = volume();
  mask.between = SliceMask::Between::Nearest;
  const double nearest = volume();
  EXPECT_NEAR(nearest / (std::numbers::pi * 25 * 32), 1.0, 0.02);
  EXPECT_LT(shaped, 0.9 * nearest);
}

TEST(SliceMask, EndsHalfWayToAnEmptySliceAndKeepsHoles) {
  SliceMask mask = along_z({{-8, {}}, {0, {circle({0, 0}, 8), circle({1, 0}, 3)}}, {8, {}}});
  const Octree octree = combine(universe, mask);
  const double truth = std::numbers::pi * (64 - 9) * 8;
  EXPECT_NEAR(static_cast<double>(octree.voxel_count()) * 0.125 / truth, 1.0, 0.02);
  EXPECT_FALSE(octree.contains(glm::ivec3(glm::round(universe.lattice().voxel({1.25, 0.25, 0.25})))));
}

TEST(SliceMask, CombinesMovesAndIsEditedRegionByRegion) {
  SliceMask mask = along_z({{-4, {circle({0, 0}, 6)}}, {4, {circle({0, 0}, 6)}}});
  Motion up;
  up.translate_mm = {0, 0, 4};
  const Octree moved_up = combine(universe, moved(Expression(mask), moved_from_still(up)));
  for (SliceMask::Slice& slice : mask.slices) slice.position_mm += 4;
  EXPECT_TRUE(moved_up == combine(universe, mask));
  mask.slices.back().polygons_mm.push_back(circle({0, 0}, 2));
  EXPECT_FALSE(moved_up == combine(universe, mask));
}

TEST(SliceMask, SaysWhichSliceIsWrong) {
  const auto refusal = [](const SliceMask& mask) -> std::string {
    try {
      check(mask);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_NE(refusal(along_z({{0, {circle({0, 0}, 6)}}})).find("at least two"), std::string::npos);
  EXPECT_NE(refusal(along_z({{0, {circle({0, 0}, 6)}}, {0, {circle({0, 0}, 6)}}})).find("slice 2"),
            std::string::npos);
  EXPECT_NE(refusal(along_z({{0, {}}, {1, {}}})).find("no slice"), std::string::npos);
  EXPECT_NE(refusal(along_z({{0, {}}, {1, {{{0, 0}, {1, 1}}}}})).find("slice 2"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::voxel
