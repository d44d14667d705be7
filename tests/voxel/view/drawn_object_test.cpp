// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A moved object is drawn from the samples at its old place.
#include "voxel/view/drawn_object.h"

#include <cmath>
#include <gtest/gtest.h>

#include "tests/voxel/field_scene.h"
#include "tests/voxel/spaced_universe.h"
#include "voxel/solid/combine.h"
#include "voxel/view/column_map.h"
#include "voxel/view/front_to_back.h"
#include "voxel/view/node_trace.h"
#include "voxel/view/ray_cast.h"

namespace octotomy::voxel {
namespace {

using tests::spaced_universe;

constexpr double ball_radius_mm = 24.0;

glm::dvec3 still_centre_mm() {
  return spaced_universe(6).lattice().lps_mm(glm::dvec3(29.3, 32.1, 30.6));
}
glm::dmat4 motion() {
  return moved_from_still(
      {{2.3, -1.6, 3.1}, 17.0, {1, 2, -1}, spaced_universe(6).lattice().lps_mm(glm::dvec3(31.5))});
}

/// A ball whose samples fall from its surface outwards, moved.
DrawnObject moved_ball() {
  const Scene scene =
      tests::field_scene<std::int16_t>(spaced_universe(6).lattice(), [](const glm::dvec3& p_mm) {
        return 200.0 * (ball_radius_mm - glm::length(p_mm - still_centre_mm()));
      });
  const GreyOctree grey = grey_octree_of(spaced_universe(6), scene, -9999);
  DrawnObject ball{"ball", combine(spaced_universe(6), moved(Window{grey, 0.0, 32767.0}, motion()))};
  ball.grey = grey;
  ball.moved_from_still = motion();
  return ball;
}

/// The visible depths of the ball against the true ones, except at grazing angles.
struct Comparison {
  int pixels = 0, stepped = 0;
  double worst_mm = 0.0;

  void add(const Seen& seen, const ImagePlane& plane, const glm::dvec2& p_px) {
    const glm::dvec3 centre_mm(motion() * glm::dvec4(still_centre_mm(), 1.0));
    const double off_mm = glm::length(plane.view_mm(p_px) - plane.view.project(centre_mm));
    if (off_mm > 0.8 * ball_radius_mm) return;
    const double truth_mm = glm::dot(centre_mm, plane.view.look) - plane.nearest_mm -
                            std::sqrt(ball_radius_mm * ball_radius_mm - off_mm * off_mm);
    ++pixels;
    stepped += !seen.lit() || seen.stepped;
    worst_mm = std::max(worst_mm, std::abs(seen.depth_mm - truth_mm));
  }
};
/// Trilinear interpolation bends inwards by 3 / (8 radius) of a voxel, samples are whole numbers, and the
/// surface slants by up to sqrt(1 - 0.8^2).
constexpr double interpolation_mm = (3.0 / (8.0 * ball_radius_mm) + 1.0 / 200.0) / 0.6;

ImagePlane plane_of(const char* view) {
  const View axes = parse_view(view);
  const glm::dvec3 centre_mm(motion() * glm::dvec4(still_centre_mm(), 1.0));
  return image_plane(spaced_universe(6), axes, {90, 90}, {axes.project(centre_mm), 60.0});
}

Comparison rays_of(const DrawnObject& ball, const char* view) {
  const ImagePlane plane = plane_of(view);
  const DepthImage image = RayCast({ball}, plane).picture();
  Comparison comparison;
  for (int y = 0; y < 90; ++y)
    for (int x = 0; x < 90; ++x) comparison.add(image.at(x, y), plane, {x + 0.5, y + 0.5});
  return comparison;
}

Comparison columns_of(const ColumnMap& map, const char* view) {
  const ImagePlane plane = plane_of(view);
  const AxisView axes = axis_view(spaced_universe(6), plane.view).value();
  const VoxelRays rays = voxel_rays(spaced_universe(6), plane);
  const glm::dmat3 px_from_voxel = glm::inverse(glm::dmat3(rays.per_px_x, rays.per_px_y, rays.per_mm));
  Comparison comparison;
  for (int j = 0; j < map.side; ++j)
    for (int i = 0; i < map.side; ++i) {
      glm::dvec3 voxel(0.0);
      voxel[axes.axis[0]] = i;
      voxel[axes.axis[1]] = j;
      comparison.add(map.at(i, j), plane, glm::dvec2(px_from_voxel * (voxel - rays.first)));
    }
  return comparison;
}

TEST(DrawnObject, AMovedBallIsAsRoundAsItWasFromAnyDirection) {
  const DrawnObject ball = moved_ball();
  for (const char* view : {"anterior", "left", "25,10", "-140,50"}) {
    const Comparison comparison = rays_of(ball, view);
    EXPECT_GT(comparison.pixels, 2000) << view;
    EXPECT_EQ(comparison.stepped, 0) << view;
    EXPECT_LT(comparison.worst_mm, interpolation_mm) << view;
  }
}

TEST(DrawnObject, ColumnsFoundTogetherAreThoseFoundAloneOnCutsAndOutsideTheSurface) {
  // Cut by slabs, so that columns begin inside the samples' surface, and with a shell around one half, whose
  // columns pass voxels outside of it.
  DrawnObject ball = moved_ball();
  const glm::dvec3 centre_mm(motion() * glm::dvec4(still_centre_mm(), 1.0));
  Expression solid = ball.octree;
  for (int slab = -2; slab <= 2; ++slab)
    solid = solid - Box{centre_mm + glm::dvec3(8.0 * slab, -30, -30),
                        centre_mm + glm::dvec3(8.0 * slab + 3.0, 30, 30)};
  const Expression shell = Expression(Sphere{centre_mm, ball_radius_mm + 4.0}) &
                           Box{centre_mm - glm::dvec3(40, 40, 40), centre_mm + glm::dvec3(40, 40, 0)};
  ball.octree = combine(spaced_universe(6), solid | shell);
  int stepped = 0, smooth = 0;
  for (const char* view : {"anterior", "posterior", "left", "right", "superior", "inferior"}) {
    const AxisView axes = axis_view(spaced_universe(6), parse_view(view)).value();
    const ColumnMap together = node_trace({ball}, axes), alone = front_to_back({ball}, axes);
    for (std::size_t i = 0; i < together.columns.size(); ++i) {
      ASSERT_EQ(together.columns[i].depth_mm, alone.columns[i].depth_mm) << view << ", column " << i;
      ASSERT_EQ(together.columns[i].stepped, alone.columns[i].stepped) << view << ", column " << i;
      if (together.columns[i].lit()) ++(together.columns[i].stepped ? stepped : smooth);
    }
  }
  EXPECT_GT(stepped, 1000);
  EXPECT_GT(smooth, 1000);
}

TEST(DrawnObject, ColumnsOfAMovedBallAreInterpolatedToo) {
  const DrawnObject ball = moved_ball();
  for (const char* view : {"anterior", "right", "superior"}) {
    const AxisView axes = axis_view(spaced_universe(6), parse_view(view)).value();
    const ColumnMap traced = node_trace({ball}, axes);
    const Comparison comparison = columns_of(traced, view);
    EXPECT_GT(comparison.pixels, 1000) << view;
    EXPECT_EQ(comparison.stepped, 0) << view;
    EXPECT_LT(comparison.worst_mm, interpolation_mm) << view;
    const ColumnMap other = front_to_back({ball}, axes);
    for (std::size_t i = 0; i < traced.columns.size(); ++i)
      ASSERT_EQ(traced.columns[i].depth_mm, other.columns[i].depth_mm) << view << ", column " << i;
  }
}

TEST(DrawnObject, WithoutItsMotionTheBallIsNotFoundRound) {
  DrawnObject ball = moved_ball();
  ball.moved_from_still.reset();
  const Comparison comparison = rays_of(ball, "25,10");
  EXPECT_GT(comparison.worst_mm, 2.0 * interpolation_mm);
}

}  // namespace
}  // namespace octotomy::voxel
