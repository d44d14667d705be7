// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/offset.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <tbb/global_control.h>

#include "tests/voxel/spaced_universe.h"
#include "voxel/solid/combine.h"

namespace octotomy::voxel {
namespace {

double volume_mm3(const Universe& universe, const Expression& solid) {
  return static_cast<double>(combine(universe, solid).voxel_count()) * universe.lattice().voxel_mm3();
}

Window offset_of(const Universe& universe, const Expression& solid, double by_mm) {
  return offset(combine(universe, solid), solid, by_mm);
}

TEST(Offset, OfABallIsABallOfTheOtherRadius) {
  for (const glm::dvec3& spacing_mm : {glm::dvec3(1.0), glm::dvec3(0.5), glm::dvec3(0.7, 1.1, 1.6)}) {
    const Universe universe = tests::spaced_universe(spacing_mm.x == 0.5 ? 7 : 6, spacing_mm);
    const glm::dvec3 centre_mm = universe.lattice().lps_mm(glm::dvec3(0.5 * universe.side())) + 0.21;
    const Expression ball(Sphere{centre_mm, 12.0});
    const double diagonal_mm = glm::length(spacing_mm);
    for (const double by_mm : {0.5, 2.0, 5.0, -2.0, -5.0}) {
      const double radius_mm = 12.0 + by_mm;
      const double found_mm3 = volume_mm3(universe, Expression(offset_of(universe, ball, by_mm)));
      const double truth_mm3 = 4.0 / 3.0 * std::numbers::pi * std::pow(radius_mm, 3.0);
      const double area_mm2 = 4.0 * std::numbers::pi * radius_mm * radius_mm;
      // The header's mean error, and three deviations of a count.
      const double allowed_mm3 =
          area_mm2 * diagonal_mm * diagonal_mm / 72.0 * (1.0 / std::abs(by_mm) + 1.0 / 12.0) +
          3.0 * 0.32 * std::pow(spacing_mm.z, 2.0) * std::sqrt(area_mm2);
      EXPECT_NEAR(found_mm3, truth_mm3, allowed_mm3) << by_mm << " mm, voxels of " << spacing_mm.x;
      // A tenth more is another offset.
      if (std::abs(by_mm) >= 2.0) {
        EXPECT_GT(area_mm2 * 0.1 * std::abs(by_mm), allowed_mm3);
      }
    }
  }
}

TEST(Offset, OfABoxHasRoundEdgesOutwardAndSharpOnesInward) {
  const Universe universe = tests::spaced_universe(6);
  const glm::dvec3 centre_mm = universe.lattice().lps_mm(glm::dvec3(32.0)) + 0.3, half_mm(10.0, 9.0, 8.0);
  const Expression box(Box{centre_mm - half_mm, centre_mm + half_mm});
  const glm::dvec3 a = 2.0 * half_mm;
  const double edges_mm = a.x + a.y + a.z, faces_mm2 = a.x * a.y + a.y * a.z + a.z * a.x;
  for (const double by_mm : {2.0, 4.0}) {
    // Steiner's formula; the edges that cells cut off cost up to 0.59 h b of each millimetre of edge.
    const double truth_mm3 = a.x * a.y * a.z + 2.0 * by_mm * faces_mm2 +
                             std::numbers::pi * by_mm * by_mm * edges_mm +
                             4.0 / 3.0 * std::numbers::pi * std::pow(by_mm, 3.0);
    const double found_mm3 = volume_mm3(universe, Expression(offset_of(universe, box, by_mm)));
    // Faces lie at 0.3 of a voxel on one side and 0.7 on the other: each counts to within half a voxel.
    EXPECT_NEAR(found_mm3, truth_mm3, 0.59 * by_mm * 4.0 * edges_mm + 0.05 * truth_mm3) << by_mm;
  }
  const glm::ivec3 inner(16, 14, 12);
  EXPECT_EQ(volume_mm3(universe, Expression(offset_of(universe, box, -2.0))), inner.x * inner.y * inner.z);
}

/// A symbol that moves must know its surface between voxels' centres.
TEST(Offset, KeepsItsVolumeUnderAMotion) {
  const Universe universe = tests::spaced_universe(6);
  const glm::dvec3 centre_mm = universe.lattice().lps_mm(glm::dvec3(31.7));
  const Expression ball(Sphere{centre_mm, 12.0});
  const Expression grown(offset_of(universe, ball, 2.0));
  Motion motion;
  motion.translate_mm = {0.4, 0.3, 0.2};
  motion.degrees = 20.0;
  motion.about_mm = centre_mm;
  const double truth_mm3 = 4.0 / 3.0 * std::numbers::pi * std::pow(14.0, 3.0);
  EXPECT_NEAR(volume_mm3(universe, moved(grown, moved_from_still(motion))), truth_mm3, 0.012 * truth_mm3);
}

TEST(Offset, ASolidThatGoesOnBeyondTheUniverseHasNoSurfaceAtItsBorder) {
  const Universe universe = tests::spaced_universe(5);
  const glm::dvec3 middle_mm = universe.lattice().lps_mm(glm::dvec3(16.25));
  const Expression half(HalfSpace{glm::dvec3(1.0, 0.0, 0.0), middle_mm.x});
  const Expression cut = half & Expression(bounds(universe.lattice()));
  EXPECT_EQ(combine(universe, Expression(offset_of(universe, half, -3.0))).voxel_count(), 14U * 32U * 32U);
  EXPECT_EQ(combine(universe, Expression(offset_of(universe, cut, -3.0))).voxel_count(), 11U * 26U * 26U);
}

TEST(Offset, NearARegionItIsTheSameThereAndNothingElsewhere) {
  const Universe universe = tests::spaced_universe(6);
  const glm::dvec3 middle_mm = universe.lattice().lps_mm(glm::dvec3(32.0));
  const Expression ball(Sphere{middle_mm + 0.21, 12.0});
  const Octree octree = combine(universe, ball);
  const Octree region = combine(universe, Expression(Box{middle_mm + 1.0, middle_mm + 9.0}));
  for (const double by_mm : {3.0, -3.0}) {
    const Octree all = combine(universe, Expression(offset(octree, ball, by_mm))),
                 near = combine(universe, Expression(offset_near(octree, ball, by_mm, region)));
    EXPECT_LT(near.voxel_count(), all.voxel_count());
    EXPECT_GT(near.voxel_count(), 0u);
    EXPECT_EQ(combine(universe, Expression(near) & Expression(region)),
              combine(universe, Expression(all) & Expression(region)));
    EXPECT_TRUE(combine(universe, Expression(near) - Expression(all)).is_empty());
  }
}

TEST(Offset, IsTheSameOnAnyNumberOfThreads) {
  const Universe universe = tests::spaced_universe(6, glm::dvec3(0.7, 1.1, 1.6));
  const Expression torus(
      Torus{universe.lattice().lps_mm(glm::dvec3(32.0)), glm::dvec3(0.0, 0.0, 1.0), 12.0, 4.0});
  const Octree many = combine(universe, Expression(offset_of(universe, torus, 1.5)));
  EXPECT_GT(many.voxel_count(), combine(universe, torus).voxel_count());
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_TRUE(combine(universe, Expression(offset_of(universe, torus, 1.5))) == many);
}

TEST(Offset, OfNothingIsNothingAndByNothingIsRefused) {
  const Universe universe = tests::spaced_universe(4);
  const Octree none = Octree::empty(universe);
  EXPECT_TRUE(combine(universe, Expression(offset(none, Expression(none), 2.0))).is_empty());
  for (const double by_mm : {0.0, std::numeric_limits<double>::infinity()})
    EXPECT_THROW(offset(none, Expression(none), by_mm), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
