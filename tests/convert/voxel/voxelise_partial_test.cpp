// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/voxel/voxelise_partial.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <tbb/global_control.h>

#include "convert/voxel/voxelise.h"
#include "tests/convert/surfaces.h"
#include "tests/unit_universe.h"
#include "voxel/scan/read_scene.h"
#include "voxel/solid/digitise.h"

namespace octotomy::convert {
namespace {

using tests::ball;
using tests::box;
using tests::inside_out;
using tests::together;
using tests::unit_universe;

std::map<std::array<int, 3>, double> boundary_shares(const voxel::PartialOctree& partial) {
  std::map<std::array<int, 3>, double> shares;
  voxel::for_each_boundary_voxel(partial, [&](const glm::ivec3& v, std::uint16_t fraction) {
    shares[{v.x, v.y, v.z}] = static_cast<double>(fraction) / voxel::PartialOctree::whole;
  });
  return shares;
}

/// What one share may be off by rounding.
constexpr double share_rounding = 0.5 / voxel::PartialOctree::whole + 1e-12;

/// The first voxel whose share is not the product of its overlaps with a box, or nothing.
std::string difference_from_box(const voxel::PartialOctree& partial, const glm::dvec3& low,
                                const glm::dvec3& high) {
  const std::map<std::array<int, 3>, double> shares = boundary_shares(partial);
  const int side = partial.inside.universe().side();
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const glm::ivec3 v(x, y, z);
        double truth = 1.0;
        for (int axis = 0; axis < 3; ++axis)
          truth *= std::max(0.0, std::min(high[axis], v[axis] + 0.5) - std::max(low[axis], v[axis] - 0.5));
        const auto at = shares.find({x, y, z});
        const double share = at != shares.end() ? at->second : partial.inside.contains(v) ? 1.0 : 0.0;
        const bool boundary = truth > 0.0 && truth < 1.0;
        if (std::abs(share - truth) > share_rounding || boundary != (at != shares.end()))
          return "voxel " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) +
                 ": share " + std::to_string(share) + ", overlap " + std::to_string(truth);
      }
  return "";
}

TEST(VoxelisePartial, ABoxFillsEachVoxelByTheProductOfItsOverlaps) {
  const glm::dvec3 low(2.3, 4.5, 5.125);
  const glm::dvec3 high(9.75, 11.5, 12.9);
  EXPECT_EQ(difference_from_box(voxelise_partial(unit_universe(4), brep::linked(box(low, high))), low, high),
            "");
}

TEST(VoxelisePartial, TheComparisonWithABoxSeesAFaceMovedByAThousandthOfAVoxel) {
  const voxel::PartialOctree partial =
      voxelise_partial(unit_universe(4), brep::linked(box({2.3, 4.5, 5.125}, {9.75, 11.5, 12.9})));
  EXPECT_NE(difference_from_box(partial, {2.3, 4.5, 5.125}, {9.751, 11.5, 12.9}), "");
}

TEST(VoxelisePartial, ABoxWhoseFacesAreVoxelsFacesTouchesNoVoxelOutside) {
  const voxel::PartialOctree partial =
      voxelise_partial(unit_universe(4), brep::linked(box({1.5, 2.5, 3.5}, {8.5, 9.5, 12.5})));
  EXPECT_EQ(partial.inside.voxel_count(), 7U * 7U * 9U);
  EXPECT_TRUE(partial.inside == partial.touching);
}

TEST(VoxelisePartial, ABoxLargerThanTheUniverseOnSomeSidesIsCutByIt) {
  for (const int depth : {2, 3, 4}) {
    const double side = unit_universe(depth).side();
    const glm::dvec3 low(-20.0, -0.5, 1.25);
    const glm::dvec3 high(side - 1.75, side + 9.0, 1e4);
    EXPECT_EQ(
        difference_from_box(voxelise_partial(unit_universe(depth), brep::linked(box(low, high))), low, high),
        "")
        << "depth " << depth;
  }
}

TEST(VoxelisePartial, AFaceInTheUniversesFirstPlaneStillFillsTheRow) {
  const glm::dvec3 low(-0.5, 1.0, 1.0);
  const glm::dvec3 high(6.0, 6.0, 6.0);
  EXPECT_EQ(difference_from_box(voxelise_partial(unit_universe(3), brep::linked(box(low, high))), low, high),
            "");
}

TEST(VoxelisePartial, AnObliqueBoxAgreesWithTheShapeThatTheVoxelKernelDigitisesByItself) {
  const voxel::Universe universe = unit_universe(5);
  const glm::dmat3 turn(
      glm::rotate(glm::rotate(glm::dmat4(1.0), 0.4, glm::dvec3(1, 2, 3)), 0.9, glm::dvec3(0, 1, 0)));
  const glm::dvec3 centre(15.3, 14.8, 15.9);
  const glm::dvec3 half(8.2, 6.1, 9.7);
  brep::Triangles mesh = box(-half, half);
  for (glm::dvec3& p : mesh.points_mm) p = centre + turn * p;
  const voxel::PartialOctree of_mesh = voxelise_partial(universe, brep::linked(mesh));
  const voxel::PartialOctree of_shape =
      voxel::digitise_partial(universe, voxel::OrientedBox{centre, half, turn});
  EXPECT_TRUE(of_mesh.inside == of_shape.inside);
  EXPECT_TRUE(of_mesh.touching == of_shape.touching);
  ASSERT_EQ(of_mesh.fractions.size(), of_shape.fractions.size());
  for (std::size_t i = 0; i < of_mesh.fractions.size(); ++i)
    // 2^-4 of the edge's length is the shape's bound where an edge runs through the voxel.
    EXPECT_NEAR(of_mesh.fractions[i], of_shape.fractions[i], voxel::PartialOctree::whole / 16.0) << i;
  EXPECT_NEAR(voxel::volume_mm3(of_mesh), 8.0 * half.x * half.y * half.z, 0.02);
}

TEST(VoxelisePartial, SharesSumToTheMeshsVolumeInAnyPoseAndHandednessWithACavity) {
  for (const double mirror : {1.0, -1.0}) {
    voxel::Universe universe = unit_universe(5);
    universe.lps_from_voxel = glm::rotate(glm::dmat4(1.0), 0.7, glm::dvec3(1, -2, 0.5)) *
                              glm::scale(glm::dmat4(1.0), glm::dvec3(1.0, mirror * 1.1, 0.8));
    const glm::dvec3 centre = universe.lattice().lps_mm(glm::dvec3(15.2, 15.9, 16.3));
    const brep::Triangles shell = together(ball(centre, 10.1, 3), inside_out(ball(centre + 0.7, 5.3, 3)));
    const voxel::PartialOctree partial = voxelise_partial(universe, brep::linked(shell));
    const double boundary = static_cast<double>(partial.fractions.size());
    // Roundings are independent: the root of their number, five times.
    EXPECT_NEAR(voxel::volume_mm3(partial), tests::volume_mm3(shell),
                5.0 * std::sqrt(boundary) * share_rounding * universe.lattice().voxel_mm3());
    const voxel::Octree centres = voxelise(universe, brep::linked(shell));
    EXPECT_LT(partial.inside.voxel_count(), centres.voxel_count());
    EXPECT_GT(partial.touching.voxel_count(), centres.voxel_count());
  }
}

TEST(VoxelisePartial, RandomTetrahedraFillTheirVolumeAndTouchingIsTheComplementOfInsideOut) {
  std::uint64_t boundary = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> at(-0.5, 15.5);
    brep::Triangles tet;
    for (int i = 0; i < 4; ++i) {
      const double x = at(random);
      const double y = at(random);
      // Corners on planes of centres and of faces too.
      tet.points_mm.push_back(seed % 3 == 0 ? glm::round(glm::dvec3(2.0 * x, y, at(random))) / 2.0
                                            : glm::dvec3(x, y, at(random)));
    }
    tet.faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    if (tests::volume_mm3(tet) < 0.0) tet = inside_out(tet);
    if (tests::volume_mm3(tet) < 1e-3) continue;
    const voxel::PartialOctree partial = voxelise_partial(unit_universe(4), brep::linked(tet));
    boundary += partial.fractions.size();
    double outside = 0.0;  // what rounding puts beyond the universe
    EXPECT_NEAR(voxel::volume_mm3(partial) + outside, tests::volume_mm3(tet),
                5.0 * std::sqrt(static_cast<double>(partial.fractions.size()) + 1.0) * share_rounding)
        << "seed " << seed;
    const voxel::PartialOctree coarse = voxelise_partial(
        unit_universe(4), brep::linked(together(box({-9, -9, -9}, {30, 30, 30}), inside_out(tet))));
    EXPECT_EQ(coarse.inside.voxel_count(), 4096U - partial.touching.voxel_count()) << "seed " << seed;
  }
  EXPECT_GT(boundary, 10000U);
}

TEST(VoxelisePartial, SaysHowFarItIsAndStopsWhenAsked) {
  const brep::Linked solid = brep::linked(ball({31, 31, 31}, 20.0, 3));
  double last = 0.0;
  voxelise_partial(unit_universe(6), solid, {{}, [&](double share) {
                                               EXPECT_GE(share, last);
                                               last = share;
                                             }});
  EXPECT_EQ(last, 1.0);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(voxelise_partial(unit_universe(6), solid, {stop.get_token(), {}}), voxel::Stopped);
}

TEST(VoxelisePartial, GivesTheSameBitsOnOneThreadAndMany) {
  const brep::Linked solid = brep::linked(ball({31.2, 30.7, 33.1}, 25.0, 4));
  const voxel::PartialOctree many = voxelise_partial(unit_universe(6), solid);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const voxel::PartialOctree single = voxelise_partial(unit_universe(6), solid);
  EXPECT_TRUE(single.inside == many.inside);
  EXPECT_TRUE(single.touching == many.touching);
  EXPECT_EQ(single.fractions, many.fractions);
}

}  // namespace
}  // namespace octotomy::convert
