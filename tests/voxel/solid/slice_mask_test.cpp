// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/slice_mask.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>

#include "voxel/solid/combine.h"
#include "voxel/solid/polygon.h"
#include "voxel/solid/region_mask.h"

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

TEST(SliceMask, ABorderThroughVoxelCentresCountsThemOnce) {
  for (const double voxel_mm : {0.5, 0.9, 0.8})
    for (const char* view : {"inferior", "left", "posterior"}) {
      const Universe grid = universe_around({{-12.3, -12.3, -12.3}, {12.3, 12.3, 12.3}}, voxel_mm);
      const auto box = [&](int from_u, int to_u) {
        SliceMask mask;
        mask.view = parse_view(view);
        const glm::dvec3 first = grid.lattice().lps_mm({12, 12, 12});
        const glm::dvec2 at = mask.view.project(first);
        const auto corner = [&](int u, int v) { return at + voxel_mm * glm::dvec2(u, v); };
        for (int plane = 0; plane < 3; ++plane)  // the ends, half a gap beyond, run through centres
          mask.slices.push_back(
              {glm::dot(first, mask.view.look) + 2 * voxel_mm * plane,
               {{corner(from_u, -3), corner(to_u, -3), corner(to_u, 5), corner(from_u, 5)}}});
        return combine(grid, mask);
      };
      const Octree left = box(-4, 2), right = box(2, 6);
      EXPECT_EQ(left.voxel_count(), 6U * 8U * 6U) << view << voxel_mm;
      EXPECT_EQ(right.voxel_count(), 4U * 8U * 6U) << view << voxel_mm;
      EXPECT_EQ(combine(grid, Expression(left) | Expression(right)), box(-4, 6)) << view << voxel_mm;
    }
}

TEST(SliceMask, EndsHalfWayToAnEmptySliceAndKeepsHoles) {
  SliceMask mask = along_z({{-8, {}}, {0, {circle({0, 0}, 8), circle({1, 0}, 3)}}, {8, {}}});
  const Octree octree = combine(universe, mask);
  const double truth = std::numbers::pi * (64 - 9) * 8;
  EXPECT_NEAR(static_cast<double>(octree.voxel_count()) * 0.125 / truth, 1.0, 0.02);
  EXPECT_FALSE(octree.contains(glm::ivec3(glm::round(universe.lattice().voxel({1.25, 0.25, 0.25})))));
}

/// The bounds as their definition has them: over all edges of all slices and all gaps.
SliceDistance::Bounds plain_bounds(const SliceMask& mask, const glm::dvec2& p_mm, double position_mm,
                                   double in_plane_mm, double across_mm) {
  constexpr double outside = std::numeric_limits<double>::infinity();
  const auto& slices = mask.slices;
  const std::size_t last = slices.size() - 1;
  const auto distance = [&](std::size_t k) {
    double square = outside;
    for_each_edge(slices[k].polygons_mm, [&](const glm::dvec2& a, const glm::dvec2& b) {
      square = std::min(square, square_to_segment(p_mm, a, b));
    });
    return contains(slices[k].polygons_mm, p_mm) ? -std::sqrt(square) : std::sqrt(square);
  };
  const double lowest = slices[0].position_mm - 0.5 * (slices[1].position_mm - slices[0].position_mm);
  const double highest =
      slices[last].position_mm + 0.5 * (slices[last].position_mm - slices[last - 1].position_mm);
  const double from = position_mm - across_mm, to = position_mm + across_mm;
  if (to < lowest || from > highest) return {outside, outside};
  SliceDistance::Bounds bounds{outside, -outside};
  const auto take = [&](double value) {
    bounds = {std::min(bounds.low, value), std::max(bounds.high, value)};
  };
  if (from < slices[0].position_mm) take(distance(0));
  if (to > slices[last].position_mm) take(distance(last));
  for (std::size_t k = 0; k < last; ++k) {
    const SliceMask::Slice &a = slices[k], &b = slices[k + 1];
    const double low = std::max(from, a.position_mm), high = std::min(to, b.position_mm);
    if (low > high) continue;
    const double middle = 0.5 * (a.position_mm + b.position_mm);
    if (mask.between == SliceMask::Between::ShapeBased && !a.polygons_mm.empty() && !b.polygons_mm.empty()) {
      for (const double at : {low, high})
        take(distance(k) +
             (at - a.position_mm) / (b.position_mm - a.position_mm) * (distance(k + 1) - distance(k)));
    } else {
      if (low <= middle) take(distance(k));
      if (high > middle) take(distance(k + 1));
    }
  }
  bounds.low -= in_plane_mm;
  bounds.high += in_plane_mm;
  if (from < lowest || to > highest) bounds.high = outside;
  return bounds;
}

TEST(SliceMask, BoundsAreThoseOverAllEdgesToTheBit) {
  std::size_t undecided = 0, on_slices = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    std::mt19937 random(seed);
    const auto any = [&](double most) { return most * static_cast<double>(random()) / 0x1p32; };
    SliceMask mask = along_z({});
    double position = -any(10);
    for (std::size_t k = 0, count = 2 + random() % 8; k < count; ++k, position += 0.25 + any(3)) {
      mask.slices.push_back({position, {}});
      for (unsigned drawn = random() % 3; drawn > 0; --drawn)
        mask.slices.back().polygons_mm.push_back(circle({any(8) - 4, any(8) - 4}, 1 + any(6)));
    }
    if (seed % 3 == 0) mask.between = SliceMask::Between::Nearest;
    const SliceDistance distance(mask);
    for (int asked = 0; asked < 200; ++asked) {
      const glm::dvec2 p(any(24) - 12, any(24) - 12);
      const bool on_slice = random() % 4 == 0;
      const double at = on_slice ? mask.slices[random() % mask.slices.size()].position_mm : any(30) - 15;
      const double in_plane = random() % 2 == 0 ? 0.0 : any(3), across = random() % 2 == 0 ? 0.0 : any(6);
      const SliceDistance::Bounds found = distance(p, at, in_plane, across);
      const SliceDistance::Bounds truth = plain_bounds(mask, p, at, in_plane, across);
      ASSERT_EQ(found.low, truth.low) << "seed " << seed << ", question " << asked;
      ASSERT_EQ(found.high, truth.high) << "seed " << seed << ", question " << asked;
      undecided += found.low <= 0.0 && found.high > 0.0;
      on_slices += on_slice;
    }
  }
  EXPECT_GT(undecided, 1000U);
  EXPECT_GT(on_slices, 1000U);
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
  EXPECT_NE(refusal(along_z({{0, {circle({0, 0}, 6)}}, {1e-9, {circle({0, 0}, 6)}}})).find("within 0.01 mm"),
            std::string::npos);
  EXPECT_EQ(refusal(along_z({{0, {circle({0, 0}, 6)}}, {0.02, {circle({0, 0}, 6)}}})), "accepted");
  EXPECT_EQ(refusal(along_z({{0, {circle({0, 0}, 6)}}, {5, {circle({0, 0}, 6)}}, {5.001, {}}})), "accepted");
  EXPECT_NE(refusal(along_z({{0, {}}, {1, {}}})).find("no slice"), std::string::npos);
  EXPECT_NE(refusal(along_z({{0, {}}, {1, {{{0, 0}, {1, 1}}}}})).find("slice 2"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::voxel
