// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/witness/slice_witness.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <stdexcept>

#include "voxel/solid/slice_mask.h"

namespace octotomy::verify {
namespace {

std::vector<glm::dvec2> square(double half_mm) {
  return {{-half_mm, -half_mm}, {half_mm, -half_mm}, {half_mm, half_mm}, {-half_mm, half_mm}};
}

/// Slices along z at 0, 10 and 20 mm: look is the head's direction, right = look x up.
DrawnStack squares(double first_mm, double second_mm, double third_mm) {
  DrawnStack stack;
  stack.look = {0.0, 0.0, 1.0};
  stack.up = {0.0, 1.0, 0.0};
  stack.right = {-1.0, 0.0, 0.0};
  stack.slices = {{0.0, {square(first_mm)}}, {10.0, {square(second_mm)}}, {20.0, {square(third_mm)}}};
  return stack;
}

TEST(SliceWitness, BetweenSquaresTheSideIsTheMeanOfBoth) {
  const Witness witness = witness_of_slices(squares(10.0, 20.0, 20.0));
  EXPECT_EQ(witness.mesh_sides({14.99, 0.0, 5.0}), certainly_in);
  EXPECT_EQ(witness.mesh_sides({15.01, 0.0, 5.0}), certainly_out);
  EXPECT_TRUE(witness.mesh_sides({15.0, 0.0, 5.0}).near);
  EXPECT_EQ(witness.mesh_sides({12.49, 0.0, 2.5}), certainly_in);
  EXPECT_EQ(witness.mesh_sides({12.51, 0.0, 2.5}), certainly_out);
}

TEST(SliceWitness, TheNearerSliceDecidesWhereNothingIsInterpolated) {
  DrawnStack stack = squares(10.0, 20.0, 20.0);
  stack.is_interpolated = false;
  const Witness witness = witness_of_slices(stack);
  EXPECT_EQ(witness.mesh_sides({15.0, 0.0, 4.99}), certainly_out);
  EXPECT_EQ(witness.mesh_sides({15.0, 0.0, 5.01}), certainly_in);
  EXPECT_TRUE(witness.mesh_sides({15.0, 0.0, 5.0}).near) << "halfway either slice may decide";
}

TEST(SliceWitness, TheOutermostSlabsReachHalfAGapBeyondTheirSlices) {
  const Witness witness = witness_of_slices(squares(10.0, 10.0, 10.0));
  EXPECT_EQ(witness.mesh_sides({0.0, 0.0, -4.99}), certainly_in);
  EXPECT_EQ(witness.mesh_sides({0.0, 0.0, -5.01}), certainly_out);
  EXPECT_EQ(witness.mesh_sides({0.0, 0.0, 24.99}), certainly_in);
  EXPECT_EQ(witness.mesh_sides({0.0, 0.0, 25.01}), certainly_out);
}

TEST(SliceWitness, APolygonInAnotherIsAHoleAndAnEmptySliceIsAGap) {
  DrawnStack stack = squares(10.0, 10.0, 10.0);
  for (DrawnStack::Slice& slice : stack.slices) slice.polygons_mm.push_back(square(4.0));
  EXPECT_EQ(witness_of_slices(stack).mesh_sides({0.0, 0.0, 7.0}), certainly_out);
  EXPECT_EQ(witness_of_slices(stack).mesh_sides({7.0, 0.0, 7.0}), certainly_in);
  stack.slices[1].polygons_mm.clear();
  EXPECT_EQ(witness_of_slices(stack).mesh_sides({7.0, 0.0, 10.0}), certainly_out);
  EXPECT_EQ(witness_of_slices(stack).mesh_sides({7.0, 0.0, 4.9}), certainly_in);
}

TEST(SliceWitness, SlicesThatDoNotAscendAreRefused) {
  DrawnStack stack = squares(10.0, 10.0, 10.0);
  stack.slices[2].position_mm = 10.0;
  EXPECT_THROW(witness_of_slices(stack), std::invalid_argument);
  stack.slices.resize(1);
  EXPECT_THROW(witness_of_slices(stack), std::invalid_argument);
}

/// The voxel kernel's distance has the same sign at random points of random stars.
TEST(SliceWitness, AgreesWithTheVoxelKernelsDistanceOnRandomStars) {
  std::size_t in = 0, out = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    DrawnStack stack = squares(1.0, 1.0, 1.0);
    stack.is_interpolated = seed % 2 == 0;
    voxel::SliceMask mask;
    mask.view = {stack.look, stack.up, stack.right};
    mask.between =
        stack.is_interpolated ? voxel::SliceMask::Between::ShapeBased : voxel::SliceMask::Between::Nearest;
    for (DrawnStack::Slice& slice : stack.slices) {
      slice.polygons_mm.assign(1, {});
      for (int i = 0; i < 11; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / 11.0, radius_mm = 5.0 + 15.0 * share(random);
        slice.polygons_mm[0].push_back(radius_mm * glm::dvec2(std::cos(angle), std::sin(angle)));
      }
      mask.slices.push_back({slice.position_mm, slice.polygons_mm});
    }
    const voxel::SliceDistance distance(mask);
    const Witness witness = witness_of_slices(stack);
    for (int i = 0; i < 500; ++i) {
      const glm::dvec3 p_mm(50.0 * share(random) - 25.0, 50.0 * share(random) - 25.0,
                            40.0 * share(random) - 10.0);
      const bool inside = distance(mask.view.project(p_mm), glm::dot(p_mm, stack.look), 0.0, 0.0).low <= 0.0;
      const AllowedSides allowed = witness.allowed_sides(p_mm).voxel;
      EXPECT_TRUE(allowed.allows(inside)) << "seed " << seed << ", point " << i;
      in += allowed == certainly_in ? 1 : 0;
      out += allowed == certainly_out ? 1 : 0;
    }
  }
  EXPECT_GT(in, 500u);
  EXPECT_GT(out, 500u);
}

}  // namespace
}  // namespace octotomy::verify
