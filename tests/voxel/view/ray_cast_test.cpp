// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/ray_cast.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "tests/voxel/dense.h"
#include "tests/voxel/field_scene.h"
#include "tests/voxel/spaced_universe.h"
#include "voxel/view/node_trace.h"

namespace octotomy::voxel {
namespace {

using tests::Dense;
using tests::spaced_universe;

/// A plane that shows the whole universe from any side.
ImagePlane plane_about(const Universe& universe, const View& view, int size_px) {
  const Box box = bounds(universe.lattice());
  const double width_mm = glm::length(box.high_mm - box.low_mm);
  return image_plane(universe, view, glm::ivec2(size_px),
                     {view.project((box.low_mm + box.high_mm) * 0.5), width_mm});
}

/// Where a ray enters and leaves a voxel's cube.
struct Span {
  double enter_mm = -std::numeric_limits<double>::infinity();
  double leave_mm = std::numeric_limits<double>::infinity();
  double length_mm() const { return leave_mm - enter_mm; }
};
Span through(const glm::ivec3& voxel, const glm::dvec3& start, const glm::dvec3& per_mm) {
  Span span;
  for (int axis = 0; axis < 3; ++axis) {
    if (per_mm[axis] == 0.0) {
      if (std::abs(start[axis] - voxel[axis]) > 0.5) span.leave_mm = -std::numeric_limits<double>::infinity();
      continue;
    }
    const double a = (voxel[axis] - 0.5 - start[axis]) / per_mm[axis];
    const double b = (voxel[axis] + 0.5 - start[axis]) / per_mm[axis];
    span.enter_mm = std::max(span.enter_mm, std::min(a, b));
    span.leave_mm = std::min(span.leave_mm, std::max(a, b));
  }
  return span;
}

/// Index arithmetic on rays of up to a hundred voxels: a generous thousand roundings.
constexpr double rounding_mm = 1e-10;

/// True where the ray's answer is that of intersecting it with every voxel. A ray that passes a voxel's edge
/// within rounding may see it or not.
bool agrees(const Seen& seen, const std::vector<Dense>& objects, const glm::dvec3& start,
            const glm::dvec3& per_mm) {
  double sure_mm = std::numeric_limits<double>::infinity();
  bool seen_possible = !seen.lit();
  for (std::size_t object = 0; object < objects.size(); ++object)
    objects[object].for_each([&](const glm::ivec3& v) {
      if (!objects[object].at(v)) return;
      const Span span = through(v, start, per_mm);
      if (span.length_mm() > rounding_mm) sure_mm = std::min(sure_mm, span.enter_mm);
      if (span.length_mm() >= -rounding_mm && static_cast<int>(object) == seen.object &&
          std::abs(span.enter_mm - seen.depth_mm) <= 1e-4)
        seen_possible = true;
    });
  // Depths are floats of at most some hundred millimetres: 1e-4 is several of their last places.
  return seen_possible && seen.depth_mm <= sure_mm + 1e-4;
}

TEST(RayCast, SeesWhatIntersectingWithEveryVoxelFindsFromAnyDirection) {
  int lit = 0, unlit = 0, later_objects = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    const auto degrees = [&](int range) {
      return static_cast<int>(random() % static_cast<unsigned>(2 * range + 1)) - range;
    };
    const Universe universe = spaced_universe(2 + static_cast<int>(seed % 4), {1.0, 1.5, 0.75});
    std::vector<Dense> dense;
    std::vector<DrawnObject> objects;
    for (std::uint64_t i = 0; i < 1 + seed % 2; ++i) {
      dense.push_back(tests::random_dense(universe.side(), 100 + 10 * seed + i));
      objects.push_back({"object", tests::octree_of(universe, dense.back())});
    }
    const std::string name = std::to_string(degrees(180)) + "," + std::to_string(degrees(90));
    const ImagePlane plane = plane_about(universe, parse_view(name), 20);
    const RayCast cast(objects, plane);
    const VoxelRays rays = voxel_rays(universe, plane);
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 20; ++x) {
        const glm::dvec2 p_px(x + 0.5, y + 0.5);
        const Seen seen = cast.seen(p_px);
        ASSERT_TRUE(agrees(seen, dense, rays.start(p_px), rays.per_mm))
            << "view " << name << ", pixel " << x << ", " << y << ", seed " << seed << ": object "
            << seen.object << " at " << seen.depth_mm << " mm";
        (seen.lit() ? lit : unlit)++;
        later_objects += seen.object > 0;
      }
  }
  EXPECT_GT(lit, 1000);
  EXPECT_GT(unlit, 1000);
  EXPECT_GT(later_objects, 50);
}

TEST(RayCast, IntersectionTestFailsOnADepthOneVoxelOff) {
  const Universe universe = spaced_universe(3);
  Dense dense(8);
  dense.at({3, 4, 5}) = 1;
  const ImagePlane plane = plane_about(universe, parse_view("20,30"), 64);
  const RayCast cast({{"voxel", tests::octree_of(universe, dense)}}, plane);
  const VoxelRays rays = voxel_rays(universe, plane);
  int lit = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      Seen seen = cast.seen({x + 0.5, y + 0.5});
      if (!seen.lit()) continue;
      ++lit;
      EXPECT_TRUE(agrees(seen, {dense}, rays.start({x + 0.5, y + 0.5}), rays.per_mm));
      seen.depth_mm += 1.0f;
      EXPECT_FALSE(agrees(seen, {dense}, rays.start({x + 0.5, y + 0.5}), rays.per_mm));
      EXPECT_FALSE(agrees(Seen(), {dense}, rays.start({x + 0.5, y + 0.5}), rays.per_mm));
    }
  EXPECT_GT(lit, 5);
}

TEST(RayCast, AlongAnAxisItSeesTheSameVoxelAsNodeTracingDoes) {
  int lit = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const Universe universe = spaced_universe(5 + static_cast<int>(seed % 2), {1.0, 2.0, 0.5});
    const std::vector<DrawnObject> objects{
        {"one", tests::octree_of(universe, tests::random_dense(universe.side(), 1000 + seed))},
        {"two", tests::octree_of(universe, tests::random_dense(universe.side(), 2000 + seed))}};
    for (const char* name : {"anterior", "posterior", "left", "right", "superior", "inferior"}) {
      const View view = parse_view(name);
      const AxisView axes = axis_view(universe, view).value();
      const ColumnMap map = node_trace(objects, axes);
      // An odd number of pixels that no column border falls on.
      const ImagePlane plane = plane_about(universe, view, 101);
      const RayCast cast(objects, plane);
      const VoxelRays rays = voxel_rays(universe, plane);
      for (int y = 0; y < 101; ++y)
        for (int x = 0; x < 101; ++x) {
          const glm::dvec2 p_px(x + 0.5, y + 0.5);
          const glm::dvec3 start = rays.start(p_px);
          const glm::dvec2 column(start[axes.axis[0]], start[axes.axis[1]]);
          const glm::dvec2 nearest = glm::floor(column + 0.5);
          const Seen seen = cast.seen(p_px);
          Seen traced;
          if (glm::all(glm::greaterThanEqual(nearest, glm::dvec2(0.0))) &&
              glm::all(glm::lessThan(nearest, glm::dvec2(map.side))))
            traced = map.at(static_cast<int>(nearest.x), static_cast<int>(nearest.y));
          ASSERT_EQ(seen.object, traced.object) << name << ", pixel " << x << ", " << y << ", seed " << seed;
          ASSERT_EQ(seen.object, map.seen(column).object);
          if (!seen.lit()) continue;
          ++lit;
          ASSERT_NEAR(seen.depth_mm, traced.depth_mm, 1e-4) << name << ", pixel " << x << ", " << y;
        }
    }
  }
  EXPECT_GT(lit, 10000);
}

/// A ball whose samples fall by `per_mm` per millimetre from its surface outwards, rise inwards.
Scene soft_ball(const Universe& universe, const glm::dvec3& centre_mm, double radius_mm, double per_mm) {
  return tests::field_scene<std::int16_t>(universe.lattice(), [&](const glm::dvec3& p_mm) {
    return per_mm * (radius_mm - glm::length(p_mm - centre_mm));
  });
}

TEST(RayCast, PartialVolumeDepthOfABallIsTheBallsFromAnyDirection) {
  const Universe universe = spaced_universe(6);
  const glm::dvec3 centre_mm = universe.lattice().lps_mm(glm::dvec3(31.3, 32.1, 30.6));
  const double radius_mm = 24.0;
  const Scene scene = soft_ball(universe, centre_mm, radius_mm, 200.0);
  const DrawnObject ball{
      "ball", octree_of_window(universe, scene, 0, 32767), {}, grey_octree_of(universe, scene), 0.0};
  for (const char* name : {"anterior", "superior", "25,10", "-140,50", "90,-35"}) {
    const View view = parse_view(name);
    const ImagePlane plane = plane_about(universe, view, 90);
    const RayCast cast({ball}, plane);
    int compared = 0, stepped = 0;
    for (int y = 0; y < 90; ++y)
      for (int x = 0; x < 90; ++x) {
        const Seen seen = cast.seen({x + 0.5, y + 0.5});
        const double from_axis_mm = glm::length(plane.view_mm({x + 0.5, y + 0.5}) - view.project(centre_mm));
        // Trilinear interpolation bends inwards by at most an eighth of the curvature of the samples along
        // each axis, 3 / (8 radius) voxels, and more along a ray that slants on the surface.
        const double slant = std::sqrt(std::max(0.0, 1.0 - std::pow(from_axis_mm / radius_mm, 2.0)));
        if (from_axis_mm > radius_mm + 0.5) {
          ASSERT_FALSE(seen.lit());
        }
        if (slant < 0.3) continue;
        ASSERT_TRUE(seen.lit()) << name << ", pixel " << x << ", " << y;
        const double truth_mm = glm::dot(centre_mm, view.look) - radius_mm * slant - plane.nearest_mm;
        ASSERT_NEAR(seen.depth_mm, truth_mm, (3.0 / (8.0 * radius_mm) + 1.0 / 200.0) / slant)
            << name << ", pixel " << x << ", " << y;
        ++compared;
        stepped += seen.stepped;
      }
    EXPECT_GT(compared, 800);
    EXPECT_EQ(stepped, 0) << name;
  }
}

TEST(RayCast, WhereABallWasCutItsFlatFaceIsSeen) {
  const Universe universe = spaced_universe(6);
  const glm::dvec3 centre_mm = universe.lattice().lps_mm(glm::dvec3(32.0));
  const Scene scene = soft_ball(universe, centre_mm, 24.0, 200.0);
  Dense half(64);
  half.for_each(
      [&](const glm::ivec3& v) { half.at(v) = v.z < 32 && glm::length(glm::dvec3(v) - 32.0) <= 24.0; });
  const DrawnObject ball{"half", tests::octree_of(universe, half), {}, grey_octree_of(universe, scene), 0.0};
  const View view = parse_view("20,60");
  const ImagePlane plane = plane_about(universe, view, 90);
  const RayCast cast({ball}, plane);
  const double flat_mm = universe.lattice().lps_mm({0, 0, 31.5}).z;
  int flat = 0;
  for (int y = 0; y < 90; ++y)
    for (int x = 0; x < 90; ++x) {
      const Seen seen = cast.seen({x + 0.5, y + 0.5});
      const glm::dvec3 on_flat_mm =
          plane.lps_mm({x + 0.5, y + 0.5}, (flat_mm - plane.lps_mm({x + 0.5, y + 0.5}, 0.0).z) / view.look.z);
      if (glm::length(on_flat_mm - centre_mm) > 22.0) continue;
      ASSERT_TRUE(seen.lit() && seen.stepped);
      ASSERT_NEAR(plane.lps_mm({x + 0.5, y + 0.5}, seen.depth_mm).z, flat_mm, 1e-4);
      ++flat;
    }
  EXPECT_GT(flat, 500);
}

TEST(RayCast, TheFirstObjectListedIsSeenWhereTwoHoldTheSameVoxels) {
  const Universe universe = spaced_universe(4);
  Dense dense(16);
  dense.for_each([&](const glm::ivec3& v) { dense.at(v) = v.x > 3 && v.y > 5 && v.z < 9; });
  const Octree octree = tests::octree_of(universe, dense);
  const RayCast cast({{"one", octree}, {"two", octree}}, plane_about(universe, parse_view("10,10"), 32));
  int lit = 0;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      EXPECT_LE(cast.seen({x + 0.5, y + 0.5}).object, 0);
      lit += cast.seen({x + 0.5, y + 0.5}).lit();
    }
  EXPECT_GT(lit, 50);
}

}  // namespace
}  // namespace octotomy::voxel
