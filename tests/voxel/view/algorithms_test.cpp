// SPDX-License-Identifier: AGPL-3.0-or-later
// Node tracing, ray casting, front to back and back to front on the same scenes.
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "tests/voxel/dense.h"
#include "tests/voxel/field_scene.h"
#include "tests/voxel/spaced_universe.h"
#include "tests/voxel/view/axis_views.h"
#include "voxel/solid/combine.h"
#include "voxel/view/back_to_front.h"
#include "voxel/view/counted_trace.h"
#include "voxel/view/front_to_back.h"
#include "voxel/view/node_trace.h"
#include "voxel/view/ray_cast.h"

namespace octotomy::voxel {
namespace {

using tests::axis_views;
using tests::spaced_universe;

/// A random expression of voxels, a ball, a half-space and a moved box.
Octree random_object(const Universe& universe, std::uint64_t seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  const auto unit = [&] { return static_cast<double>(random() % 2001) / 1000.0 - 1.0; };
  const Box box = bounds(universe.lattice());
  const glm::dvec3 middle = 0.5 * (box.low_mm + box.high_mm);
  const glm::dvec3 half = 0.5 * (box.high_mm - box.low_mm);
  const auto point = [&] { return middle + half * glm::dvec3(unit(), unit(), unit()); };
  const Expression voxels = tests::octree_of(universe, tests::random_dense(universe.side(), seed));
  const Expression ball = Sphere{point(), 0.6 * half.x * (1.2 + unit())};
  const Expression plane =
      HalfSpace{glm::normalize(glm::dvec3(unit(), unit(), unit() + 0.01)), unit() * half.y};
  Motion motion;
  motion.degrees = 60.0 * unit();
  motion.axis = {0.3, 1.0, 0.2};
  motion.about_mm = middle;
  const Expression piece = moved(Box{middle - 0.4 * half, middle + 0.3 * half}, moved_from_still(motion));
  switch (seed % 5) {
    case 0:
      return combine(universe, voxels);
    case 1:
      return combine(universe, (voxels - ball) | piece);
    case 2:
      return combine(universe, (voxels & plane) | (ball - plane));
    case 3:
      return combine(universe, voxels ^ ball);
    default:
      return combine(universe, (ball | piece) - plane);
  }
}

std::vector<DrawnObject> random_scene(std::uint64_t seed) {
  const Universe universe = spaced_universe(3 + static_cast<int>(seed % 3), {1.0, 1.5, 0.75});
  std::vector<DrawnObject> objects;
  for (std::uint64_t i = 0; i < 1 + seed % 2; ++i)
    objects.push_back({"object", random_object(universe, 3 * seed + i)});
  return objects;
}

TEST(Algorithms, AllFourLightTheSameColumnsAtTheSameDepthsAlongAxesForRandomExpressions) {
  int lit = 0, unlit = 0, second = 0;
  for (std::uint64_t seed = 0; seed < 250; ++seed) {
    const std::vector<DrawnObject> objects = random_scene(seed);
    const Universe& universe = objects.front().octree.universe();
    const View view = parse_view(axis_views[seed % 6]);
    const AxisView axes = axis_view(universe, view).value();
    const ColumnMap traced = node_trace(objects, axes);
    const std::array<ColumnMap, 3> others{quadtree_trace(objects, axes), front_to_back(objects, axes),
                                          back_to_front(objects, axes)};
    const glm::dvec3 spacing_mm = universe.lattice().spacing_mm();
    // One pixel a column: through the columns' centres.
    const double width_mm = universe.side() * spacing_mm[axes.axis[0]];
    const Box box = bounds(universe.lattice());
    const ImagePlane plane = image_plane(universe, view, glm::ivec2(64),
                                         {view.project(0.5 * (box.low_mm + box.high_mm)), 1.3 * width_mm});
    const RayCast cast(objects, plane);
    const VoxelRays rays = voxel_rays(universe, plane);
    for (int j = 0; j < traced.side; ++j)
      for (int i = 0; i < traced.side; ++i) {
        const Seen& seen = traced.at(i, j);
        for (std::size_t other = 0; other < others.size(); ++other) {
          ASSERT_EQ(seen.object, others[other].at(i, j).object)
              << "seed " << seed << ", algorithm " << other << ", column " << i << ", " << j;
          ASSERT_EQ(seen.depth_mm, others[other].at(i, j).depth_mm) << "seed " << seed;
        }
        (seen.lit() ? lit : unlit)++;
        second += seen.object > 0;
        // The pixel position of the column's centre.
        glm::dvec3 target(0.0);
        target[axes.axis[0]] = i;
        target[axes.axis[1]] = j;
        const glm::dvec3 image =
            glm::inverse(glm::dmat3(rays.per_px_x, rays.per_px_y, rays.per_mm)) * (target - rays.first);
        const Seen ray = cast.seen(glm::dvec2(image));
        ASSERT_EQ(seen.object, ray.object) << "seed " << seed << ", column " << i << ", " << j;
        if (seen.lit()) {
          ASSERT_NEAR(seen.depth_mm, ray.depth_mm, 1e-4) << "seed " << seed;
        }
      }
  }
  EXPECT_GT(lit, 20000);
  EXPECT_GT(unlit, 20000);
  EXPECT_GT(second, 1000);
}

TEST(Algorithms, TheFourOfGeneralViewsLightTheSamePixelsAtTheSameDepthsForRandomExpressions) {
  int lit = 0, unlit = 0, second = 0, at_silhouettes = 0;
  for (std::uint64_t seed = 0; seed < 250; ++seed) {
    const std::vector<DrawnObject> objects = random_scene(1000 + seed);
    const Universe& universe = objects.front().octree.universe();
    const std::string name = std::to_string(static_cast<int>(seed * 37 % 359) - 179) + "," +
                             std::to_string(static_cast<int>(seed * 53 % 179) - 89);
    const View view = parse_view(name);
    const Box box = bounds(universe.lattice());
    // Now and then a picture that shows only a part.
    const double width_mm = (seed % 4 == 0 ? 0.4 : 1.0) * glm::length(box.high_mm - box.low_mm);
    const ImagePlane plane =
        image_plane(universe, view, {48, 40}, {view.project(0.5 * (box.low_mm + box.high_mm)), width_mm});
    const RayCast cast(objects, plane);
    const std::array<DepthImage, 3> images{front_to_back(objects, plane), back_to_front(objects, plane),
                                           quadtree_trace(objects, plane)};
    for (std::size_t pixel = 0; pixel < images[0].pixels.size(); ++pixel) {
      ASSERT_EQ(images[2].pixels[pixel].object, images[0].pixels[pixel].object) << "seed " << seed;
      ASSERT_EQ(images[2].pixels[pixel].depth_mm, images[0].pixels[pixel].depth_mm) << "seed " << seed;
    }
    for (int y = 0; y < plane.size_px.y; ++y)
      for (int x = 0; x < plane.size_px.x; ++x) {
        const Seen ray = cast.seen({x + 0.5, y + 0.5});
        (ray.lit() ? lit : unlit)++;
        second += ray.object > 0;
        for (const DepthImage& image : images) {
          const Seen& seen = image.at(x, y);
          if (seen.object == ray.object && (!seen.lit() || std::abs(seen.depth_mm - ray.depth_mm) < 1e-3))
            continue;
          // A ray along an edge of voxels, within rounding, may see either side: its neighbours a thousandth
          // of a pixel away must be seen to disagree as well.
          bool explained = false;
          for (const double dx : {-1e-3, 1e-3})
            for (const double dy : {-1e-3, 1e-3}) {
              const Seen near = cast.seen({x + 0.5 + dx, y + 0.5 + dy});
              explained = explained || (near.object == seen.object &&
                                        (!near.lit() || std::abs(near.depth_mm - seen.depth_mm) < 0.05));
            }
          ASSERT_TRUE(explained) << "seed " << seed << ", view " << name << ", pixel " << x << ", " << y
                                 << ": object " << seen.object << " at " << seen.depth_mm
                                 << " mm, the ray caster sees " << ray.object << " at " << ray.depth_mm;
          ++at_silhouettes;
        }
      }
  }
  EXPECT_GT(lit, 20000);
  EXPECT_GT(unlit, 20000);
  EXPECT_GT(second, 1000);
  EXPECT_LT(at_silhouettes, lit / 100);
}

Visits visits_of(const std::vector<DrawnObject>& objects, const AxisView& axes,
                 ColumnMap (*draw)(const std::vector<DrawnObject>&, const AxisView&, Visits*)) {
  Visits visits;
  draw(objects, axes, &visits);
  return visits;
}

TEST(Visits, OfFigure48AreThoseWorkedOutInTheThesis) {
  // Universe of 4 voxels, seen from the front: the quadtree node at (0, 0) of level 2 steps over two Empty
  // voxels and the Empty octant behind them: three direct visits, and one indirect for a pivot at the root.
  const Universe universe = spaced_universe(2);
  tests::Dense dense(4);
  dense.at({1, 1, 1}) = 1;  // the front octant is Partial, the one behind it Empty
  const std::vector<DrawnObject> objects{{"voxel", tests::octree_of(universe, dense)}};
  const AxisView axes = axis_view(universe, parse_view("anterior")).value();
  const Visits visits = visits_of(objects, axes, quadtree_trace);
  // Root 1; level 1: 4 front octants, of which 3 are Empty and step to the octants behind; level 2: 4 rays,
  // one ends at the voxel at once or after a step, three step over 2 voxels, then into the octant behind.
  // The voxel at depth 1: its ray visits 2 voxels.
  EXPECT_EQ(visits.direct.octree[0].partial, 1u);
  EXPECT_EQ(visits.direct.octree[0].empty, 3u + 3u + 3u);
  EXPECT_EQ(visits.direct.octree[1].empty, 3u * 2u + 1u);
  EXPECT_EQ(visits.direct.octree[1].full, 1u);
  EXPECT_EQ(visits.all.octree[0].empty, visits.direct.octree[0].empty);
  EXPECT_EQ(visits.direct.quadtree, 1u + 7u + 3u * 3u + 2u);
  EXPECT_EQ(visits.all.quadtree, visits.direct.quadtree + 3u);
}

TEST(Visits, OfInterpolatedDepthsOpenTheNodesWhoseSamplesDiffer) {
  // Four layers of voxels, from front to back. The surface is that of 50, in the middle.
  const Universe universe = spaced_universe(2);
  const AxisView axes = axis_view(universe, parse_view("anterior")).value();
  const auto of_layers = [&](const std::array<double, 4>& layers) {
    const auto sample = [&](const glm::dvec3& p_mm) {
      return layers[static_cast<std::size_t>(std::lround(p_mm.y - universe.lps_from_voxel[3].y))];
    };
    const GreyOctree grey =
        grey_octree_of(universe, tests::field_scene<std::int16_t>(universe.lattice(), sample), 0);
    return visits_with_depths(grey, *window16(50, 200), axes);
  };
  // Even nodes: the rays of the four front octants step into those behind, and no node is opened.
  const Visits even = of_layers({10, 10, 100, 100});
  EXPECT_EQ(even.direct.octree[0].empty, 4u);
  EXPECT_EQ(even.direct.octree[0].full, 4u);
  EXPECT_EQ(even.direct.octree[1].empty + even.direct.octree[1].full, 0u);
  EXPECT_EQ(even.direct.quadtree, 1u + 4u + 4u);
  // The Empty octants' samples differ: each is opened at its back, for the four columns of each quadtree node.
  const Visits before = of_layers({0, 10, 100, 100});
  EXPECT_EQ(before.direct.octree[1].empty, 16u);
  EXPECT_EQ(before.direct.octree[1].full, 0u);
  EXPECT_EQ(before.direct.quadtree, 1u + 4u + 4u + 16u);
  // The Full ones' samples differ, too: they are opened at their front, with the same columns.
  const Visits both = of_layers({0, 10, 100, 90});
  EXPECT_EQ(both.direct.octree[1].empty, 16u);
  EXPECT_EQ(both.direct.octree[1].full, 16u);
  EXPECT_EQ(both.direct.quadtree, 1u + 4u + 4u + 16u);
  EXPECT_EQ(both.directly_visited_count, 8u + 32u);
  EXPECT_EQ(both.directly_unvisited_fraction(), 1.0 - 40.0 / 72.0);
}

TEST(Visits, OfNodeTracingInTheIsometricViewAreThoseOfTheNodesThatItsBeamsOpen) {
  // A Full universe ends every beam at the root; an Empty one has no beam. Neither visits a node below.
  const Universe universe = spaced_universe(4);
  const Box box = bounds(universe.lattice());
  const View view = parse_view("45,35.264389682754654");
  const ImagePlane plane =
      image_plane(universe, view, {64, 64}, {view.project(0.5 * (box.low_mm + box.high_mm)), 40.0});
  for (const Octree& octree : {Octree::full(universe), Octree::empty(universe)}) {
    Visits visits;
    quadtree_trace({{"all or nothing", octree}}, plane, &visits);
    EXPECT_EQ(visits.direct.quadtree, 0u);
  }
  // One Full octant: every beam that opens the root visits up to eight children, and no node below.
  tests::Dense dense(16);
  for (int z = 0; z < 8; ++z)
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 8; ++x) dense.at({x, y, z}) = 1;
  const std::vector<DrawnObject> octant{{"octant", tests::octree_of(universe, dense)}};
  Visits visits;
  const DepthImage counted = quadtree_trace(octant, plane, &visits);
  const DepthImage drawn = quadtree_trace(octant, plane);
  EXPECT_GT(visits.direct.octree[0].full, 0u);
  EXPECT_EQ(visits.direct.octree[1].full + visits.direct.octree[1].empty, 0u);
  EXPECT_EQ(visits.direct.quadtree, visits.direct.octree[0].full + visits.direct.octree[0].empty);
  EXPECT_LT(visits.direct.quadtree, 8u * 64u * 64u);
  std::size_t lit = 0;
  for (std::size_t pixel = 0; pixel < drawn.pixels.size(); ++pixel) {
    ASSERT_EQ(counted.pixels[pixel].depth_mm, drawn.pixels[pixel].depth_mm);
    lit += drawn.pixels[pixel].lit() ? 1 : 0;
  }
  // A cube along its diagonal is a regular hexagon of the area sqrt(3) a^2.
  EXPECT_NEAR(static_cast<double>(lit), std::sqrt(3.0) * 64.0 / (plane.pixel_mm * plane.pixel_mm), 8.0);
}

TEST(Visits, EveryNodeOnceBackToFrontFewerFrontToBackFewestByNodeTracing) {
  const Universe universe = spaced_universe(7);
  const Box box = bounds(universe.lattice());
  const glm::dvec3 middle = 0.5 * (box.low_mm + box.high_mm);
  // A shell with a window cut into it.
  const Expression shell = Expression(Sphere{middle, 50.0}) - Sphere{middle, 44.0} -
                           Box{middle - glm::dvec3(15, 70, 10), middle + glm::dvec3(20, -30, 25)};
  const std::vector<DrawnObject> objects{{"shell", combine(universe, shell)}};
  const AxisView axes = axis_view(universe, parse_view("anterior")).value();
  const Visits back = visits_of(objects, axes, back_to_front);
  const Visits front = visits_of(objects, axes, front_to_back);
  const Visits trace = visits_of(objects, axes, quadtree_trace);
  const auto total = [](const VisitTally& tally) {
    std::uint64_t sum = 0;
    for (const LevelCount& level : tally.octree) sum += level.partial + level.full + level.empty;
    return sum;
  };
  for (std::size_t i = 0; i < back.existing.size(); ++i) {
    EXPECT_EQ(back.direct.octree[i].partial, back.existing[i].partial);
    EXPECT_EQ(back.direct.octree[i].full, back.existing[i].full);
    EXPECT_EQ(back.direct.octree[i].empty, back.existing[i].empty);
    EXPECT_LE(front.direct.octree[i].partial, front.existing[i].partial);
  }
  EXPECT_EQ(back.unvisited_fraction(), 0.0);
  EXPECT_GT(total(back.direct), total(front.direct));
  EXPECT_GT(total(front.direct), total(trace.direct));
  EXPECT_GT(total(trace.all), total(trace.direct));
  EXPECT_GT(trace.unvisited_fraction().value(), front.unvisited_fraction().value());
}

}  // namespace
}  // namespace octotomy::voxel
