// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Cores of composed bodies, grown again: what balls of a radius hold, against closed forms.
#include "brep/shape/level_body.h"

#include <gtest/gtest.h>
#include <numbers>
#include <tbb/global_control.h>

#include "brep/measure/local_thickness.h"
#include "brep/mesh/distance.h"
#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

using std::numbers::pi;

Solid box(const glm::dvec3& low_mm, const glm::dvec3& high_mm) {
  return solid_of(shapes::box(low_mm, high_mm));
}
Solid ball(double radius_mm) {
  return solid_of(shapes::sphere({0.1, 0.2, 0.3}, radius_mm, 5));
}
/// The union of all balls of a radius within a body.
Solid opened(const LevelBody& body, double radius_mm, double cell_mm) {
  const Solid core = core_of(body, {-radius_mm, cell_mm});
  return core.empty() ? core : offset(core, {radius_mm, cell_mm});
}

TEST(LevelBody, ABoxGrownFromItsCoreHasEdgesOfTheRadius) {
  const LevelBody body{{{{box({-4, -3, -2}, {4, 3, 2}), 0.0}}}, {}};
  // Steiner's formula for a box of 6, 4 and 2 and balls of 1.
  const double truth_mm3 = 48.0 + 88.0 + pi * 12.0 + 4.0 / 3.0 * pi;
  const Solid found = opened(body, 1.0, 0.5);
  EXPECT_NEAR(found.size().volume_mm3 / truth_mm3, 1.0, 0.02);
  EXPECT_TRUE(health(found.mesh()).solid());
  EXPECT_NEAR(found.size().high_mm.x, 4.0, 0.01);
}

TEST(LevelBody, APartIsWhatItsLevelsShareLessTheOthers) {
  // A ball grown to 10 without one grown to 6, above a plane: half a shell of 4.
  const LevelBody body{{{{ball(8.0), 2.0}, {box({-20, -20, 0.3}, {20, 20, 20}), 0.0}}}, {{ball(5.0), 1.0}}};
  const Solid whole = core_of(body, {0.0, 0.8});
  EXPECT_NEAR(whole.size().volume_mm3 / (2.0 / 3.0 * pi * (1000.0 - 216.0)), 1.0, 0.02);
  EXPECT_EQ(whole.components().size(), 1u);
  // Its core at a depth of 1 is half a shell from 7 to 9, a plane higher by 1.
  const Solid core = core_of(body, {-1.0, 0.8});
  const auto cap_mm3 = [](double radius, double from) {
    const double height = radius - from;
    return pi * height * height * (3.0 * radius - height) / 3.0;
  };
  EXPECT_NEAR(core.size().volume_mm3 / (cap_mm3(9.0, 1.0) - cap_mm3(7.0, 1.0)), 1.0, 0.04);
}

TEST(LevelBody, AFlangeThinnerThanTheBallsIsCutOffAndItsVolumeIsStated) {
  // A block with a flange of 0.1 mm at its foot, as a plate has where the bone falls away.
  const LevelBody body{{{{box({-5, -5, 0}, {5, 5, 4}), 0.0}}, {{box({4, -5, 0}, {9, 5, 0.1}), 0.0}}}, {}};
  const Solid found = opened(body, 0.4, 0.5);
  EXPECT_LT(found.size().high_mm.x, 5.05);
  const LocalThickness thickness = local_thickness(found, {});
  ASSERT_TRUE(thickness.thinnest_wall);
  EXPECT_GT(thickness.surface[*thickness.thinnest_wall].thickness_mm, 0.75);
  // The flange from 5.4 to 9, 10 mm wide, 0.1 thick: 3.6; samples of a step of 0.05 see it.
  EXPECT_NEAR(volume_beyond_mm3(body, found, 0.4, 0.05), 3.6, 0.4);
  // Rounded edges and corners are no walls.
  const LevelBody block{{{{box({-5, -5, 0}, {5, 5, 4}), 0.0}}}, {}};
  EXPECT_EQ(volume_beyond_mm3(block, found, 0.4, 0.1), 0.0);
}

TEST(LevelBody, ASliverWhereASlotRunsOutAtAnEdgeIsCutOff) {
  // A slot 0.002 mm from the block's side leaves a sliver of that width.
  const LevelBody body{{{{box({-5, -5, 0}, {5, 5, 4}), 0.0}}}, {{box({-6, 4.0, -1}, {6, 4.998, 5}), 0.0}}};
  const Solid found = opened(body, 0.4, 0.8);
  EXPECT_EQ(found.components().size(), 1u);
  EXPECT_LT(found.size().high_mm.y, 4.02);
  EXPECT_NEAR(found.size().high_mm.y, 4.0, 0.06);
}

TEST(LevelBody, WhereCoarseCellsBoundDistancesItsSurfaceIsThatOfAllLevels) {
  // Two parts that overlap, one of two levels, less two: each point of the surface is as far from 0 as the
  // lattice allows by a plain reading of all levels.
  const Solid block = box({0, 0, 0}, {9, 3, 3}), tall = box({-9, -9, -9}, {9, 9, 1.3}),
              slot = box({2, -9, 1}, {3, 9, 9});
  const LevelBody body{{{{ball(5.0), 1.0}, {tall, 0.0}}, {{block, 0.0}}}, {{slot, 0.2}, {ball(2.0), 0.7}}};
  const Solid found = core_of(body, {-0.4, 0.4});
  const std::vector<glm::dvec3>& points_mm = found.triangles().points_mm;
  ASSERT_GT(points_mm.size(), 1000u);
  const auto distances = [&](const Level& level) {
    std::vector<std::uint32_t> nearest(points_mm.size(), SurfaceTree::unknown_triangle);
    std::vector<double> mm = level.solid.tree().signed_distances_mm(points_mm, nearest);
    for (double& each : mm) each -= level.by_mm;
    return mm;
  };
  std::vector<double> value(points_mm.size(), 1e9);
  for (const std::vector<Level>& levels : body.parts) {
    std::vector<double> part(points_mm.size(), -1e9);
    for (const Level& level : levels) {
      const std::vector<double> mm = distances(level);
      for (std::size_t i = 0; i < mm.size(); ++i) part[i] = std::max(part[i], mm[i]);
    }
    for (std::size_t i = 0; i < part.size(); ++i) value[i] = std::min(value[i], part[i]);
  }
  for (const Level& level : body.without) {
    const std::vector<double> mm = distances(level);
    for (std::size_t i = 0; i < mm.size(); ++i) value[i] = std::max(value[i], -mm[i]);
  }
  // Points that the lattice keeps off its corners, by 1/16 of a step of 0.1 mm's diagonal, stand off most.
  for (std::size_t i = 0; i < value.size(); ++i) EXPECT_NEAR(value[i], -0.4, 0.02) << i;
}

TEST(LevelBody, IsTheSameOnAnyNumberOfThreads) {
  const LevelBody body{{{{ball(5.0), 1.0}}, {{box({0, 0, 0}, {9, 3, 3}), 0.0}}},
                       {{box({2, -9, 1}, {3, 9, 9}), 0.2}}};
  const auto points_on = [&](int threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(threads));
    return core_of(body, {-0.4, 0.6}).triangles().points_mm;
  };
  EXPECT_EQ(points_on(1), points_on(2));
}

TEST(LevelBody, WhereNoBallFitsItIsEmptyAndWhatIsNoBodyIsRefused) {
  const Solid slab = box({0, 0, 0}, {9, 9, 0.5});
  EXPECT_TRUE(core_of({{{{slab, 0.0}}}, {}}, {-0.4, 0.5}).empty());
  const Solid apart = box({20, 0, 0}, {29, 9, 9});
  EXPECT_TRUE(core_of({{{{slab, 0.0}, {apart, 0.0}}}, {}}, {-0.1, 0.5}).empty());
  EXPECT_THROW(core_of({}, {-0.4, 0.5}), InvalidInput);
  EXPECT_THROW(core_of({{{}}, {}}, {-0.4, 0.5}), InvalidInput);
  EXPECT_THROW(core_of({{{{Solid(), 0.0}}}, {}}, {-0.4, 0.5}), InvalidInput);
  EXPECT_THROW(core_of({{{{slab, 0.0}}}, {{Solid(), 0.0}}}, {-0.4, 0.5}), InvalidInput);
  EXPECT_THROW(core_of({{{{slab, 0.0}}}, {}}, {0.4, 0.5}), InvalidInput);
  EXPECT_THROW(core_of({{{{slab, 0.0}}}, {}}, {-0.4, 0.0}), InvalidInput);
}

}  // namespace
}  // namespace octotomy::brep
