// SPDX-License-Identifier: AGPL-3.0-or-later
// Appendix A of the thesis on the head phantom: what each way of drawing its skull visits.
#include <gtest/gtest.h>

#include "verify/phantom/head_phantom.h"
#include "voxel/solid/combine.h"
#include "voxel/view/back_to_front.h"
#include "voxel/view/counted_trace.h"
#include "voxel/view/front_to_back.h"

namespace octotomy::verify {
namespace {

constexpr double skull_hu = 300.0;

/// The skull of a head scanned at 1 mm, as a window of its grey octree.
const voxel::DrawnObject& skull() {
  static const voxel::DrawnObject drawn = [] {
    const voxel::Universe universe = voxel::universe_around(head_bounds(), 1.0);
    const voxel::GreyOctree grey = voxel::grey_octree_of(universe, head_phantom());
    voxel::DrawnObject object{"skull", voxel::combine(universe, voxel::Window{grey, skull_hu, 32767.0})};
    object.grey = grey;
    object.threshold = skull_hu;
    return object;
  }();
  return drawn;
}

voxel::Visits visits_of(const voxel::DrawnObject& object,
                        voxel::ColumnMap (*draw)(const std::vector<voxel::DrawnObject>&,
                                                 const voxel::AxisView&, voxel::Visits*)) {
  const voxel::AxisView axes =
      voxel::axis_view(object.octree.universe(), voxel::parse_view("anterior")).value();
  voxel::Visits visits;
  draw({object}, axes, &visits);
  return visits;
}

std::uint64_t total(const voxel::VisitTally& tally) {
  std::uint64_t sum = 0;
  for (const voxel::LevelCount& level : tally.octree) sum += level.partial + level.full + level.empty;
  return sum;
}

TEST(HeadVisits, FallFromBackToFrontByFrontToBackToNodeTracingInTheBinaryOctree) {
  const voxel::Visits back = visits_of(skull(), voxel::back_to_front);
  const voxel::Visits front = visits_of(skull(), voxel::front_to_back);
  const voxel::Visits trace = visits_of(skull(), voxel::quadtree_trace);
  EXPECT_EQ(back.unvisited_fraction(), 0.0);
  EXPECT_GT(total(back.direct), total(front.direct));
  EXPECT_GT(total(front.direct), total(trace.direct));
  EXPECT_GT(back.per_pixel(back.direct), front.per_pixel(front.direct));
  EXPECT_GT(front.per_pixel(front.direct), trace.per_pixel(trace.direct));
  EXPECT_GT(trace.unvisited_fraction().value(), front.unvisited_fraction().value());
}

TEST(HeadVisits, ReachLessThanATenthOfAMinMaxTreeByNodeTracing) {
  voxel::DrawnObject object = skull();
  object.counted_in_grey = true;
  const voxel::Visits trace = visits_of(object, voxel::quadtree_trace);
  EXPECT_GT(trace.unvisited_fraction().value(), 0.9);
  // The twin: without ranges that rule nodes out every one is visited back to front.
  EXPECT_LT(visits_of(skull(), voxel::back_to_front).unvisited_fraction().value(), 0.9);
}

}  // namespace
}  // namespace octotomy::verify
