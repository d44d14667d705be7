// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/node_trace.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "tests/voxel/dense.h"
#include "tests/voxel/field_scene.h"
#include "tests/voxel/spaced_universe.h"
#include "tests/voxel/view/axis_views.h"
#include "voxel/solid/combine.h"

namespace octotomy::voxel {
namespace {

using tests::axis_views;
using tests::Dense;
using tests::spaced_universe;

/// The first voxel of each column found by looking at every voxel: number of voxels before it and its object.
struct Found {
  int before = -1;
  int object = -1;
};
Found first_voxel(const std::vector<Dense>& objects, const AxisView& axes, int i, int j) {
  const int side = objects.front().side;
  for (int before = 0; before < side; ++before) {
    glm::ivec3 voxel;
    voxel[axes.axis[0]] = i;
    voxel[axes.axis[1]] = j;
    voxel[axes.axis[2]] = axes.reversed[2] ? side - 1 - before : before;
    for (std::size_t object = 0; object < objects.size(); ++object)
      if (objects[object].at(voxel)) return {before, static_cast<int>(object)};
  }
  return {};
}

/// The number of columns in which map and voxels disagree; prints the first into `difference`.
int differing_columns(const ColumnMap& map, const std::vector<Dense>& objects, const AxisView& axes,
                      double spacing_mm, std::string& difference) {
  int count = 0;
  for (int j = 0; j < map.side; ++j)
    for (int i = 0; i < map.side; ++i) {
      const Found found = first_voxel(objects, axes, i, j);
      const Seen& seen = map.at(i, j);
      const bool same = seen.object == found.object &&
                        (found.object < 0 || seen.depth_mm == static_cast<float>(found.before * spacing_mm));
      if (same) continue;
      if (count++ == 0)
        difference = "column " + std::to_string(i) + ", " + std::to_string(j) + ": traced object " +
                     std::to_string(seen.object) + " at " + std::to_string(seen.depth_mm) +
                     " mm, voxels say object " + std::to_string(found.object) + " behind " +
                     std::to_string(found.before) + " voxels";
    }
  return count;
}

TEST(NodeTrace, SeesInEveryColumnWhatLookingAtEveryVoxelFindsFromAllSixSidesWithSeveralObjects) {
  int lit = 0, unlit = 0, later_objects = 0;
  for (std::uint64_t seed = 0; seed < 48; ++seed) {
    const int depth = 2 + static_cast<int>(seed % 6);
    const Universe universe = spaced_universe(depth, {1.0, 2.0, 0.5});
    std::vector<Dense> dense;
    std::vector<DrawnObject> objects;
    for (std::uint64_t i = 0; i < 1 + seed % 3; ++i) {
      dense.push_back(tests::random_dense(universe.side(), 10 * seed + i));
      objects.push_back({"object", tests::octree_of(universe, dense.back())});
    }
    for (const char* name : axis_views) {
      const AxisView axes = axis_view(universe, parse_view(name)).value();
      const ColumnMap map = node_trace(objects, axes);
      std::string difference;
      ASSERT_EQ(
          0, differing_columns(map, dense, axes, universe.lattice().spacing_mm()[axes.axis[2]], difference))
          << name << ", seed " << seed << ": " << difference
          << "; replay with --gtest_filter=NodeTrace.SeesInEveryColumn*";
      for (const Seen& seen : map.columns) {
        (seen.lit() ? lit : unlit)++;
        later_objects += seen.object > 0;
      }
    }
  }
  EXPECT_GT(lit, 10000);
  EXPECT_GT(unlit, 10000);
  EXPECT_GT(later_objects, 1000);
}

TEST(NodeTrace, ComparisonWithVoxelsFailsWhereOneVisibleVoxelIsMissing) {
  const Universe universe = spaced_universe(6);
  Dense dense(64);
  dense.for_each([&](const glm::ivec3& v) { dense.at(v) = glm::length(glm::dvec3(v) - 31.5) < 20.0; });
  const AxisView axes = axis_view(universe, parse_view("left")).value();
  const ColumnMap map = node_trace({{"ball", tests::octree_of(universe, dense)}}, axes);
  std::string difference;
  ASSERT_EQ(0, differing_columns(map, {dense}, axes, 1.0, difference)) << difference;
  dense.at({51, 31, 31}) = 0;
  EXPECT_EQ(1, differing_columns(map, {dense}, axes, 1.0, difference));
  dense.at({51, 31, 31}) = 1;
  const AxisView other_side = axis_view(universe, parse_view("right")).value();
  dense.at({51, 31, 31}) = 0;
  EXPECT_EQ(0, differing_columns(node_trace({{"ball", tests::octree_of(universe, dense)}}, other_side),
                                 {dense}, other_side, 1.0, difference))
      << "the missing voxel is hidden from the other side; " << difference;
}

/// Random expressions within a universe: octrees of it, a window of its samples, primitives and a mask, at
/// rest and moved.
class RandomExpressions {
 public:
  RandomExpressions(const Universe& universe, std::uint64_t seed) : random_(seed) {
    const Box box = bounds(universe.lattice());
    centre_mm_ = 0.5 * (box.low_mm + box.high_mm);
    half_mm_ = 0.5 * (box.high_mm - box.low_mm);
    leaves_.emplace_back(combine(universe, Expression(sphere()) - Expression(sphere())));
    leaves_.emplace_back(combine(universe, Expression(sphere()) | Expression(sphere())));
    leaves_.emplace_back(sphere());
    leaves_.emplace_back(Box{point(), centre_mm_ + half_mm_});
    leaves_.emplace_back(HalfSpace{glm::normalize(point() - centre_mm_ + glm::dvec3(0.1)), 0.0});
    const View view = parse_view("left");
    const glm::dvec2 middle = view.project(centre_mm_), low = middle - 0.4 * half_mm_.y,
                     high = middle + half_mm_.y;
    leaves_.emplace_back(RegionMask{{{view, {{low, {high.x, low.y}, high, {low.x, middle.y}}}}}});
    if (universe.depth <= 6) {
      const glm::dvec3 end_mm = point();
      const Scene scene = tests::field_scene<std::int16_t>(
          universe.lattice(), [&](const glm::dvec3& p_mm) { return 30.0 * glm::distance(p_mm, end_mm); });
      leaves_.emplace_back(Window{grey_octree_of(universe, scene), 200.0, 600.0});
    }
  }
  Expression next(int depth) {
    const auto choice = random_() % (depth == 0 ? 1 : 8);
    switch (choice) {
      case 0:
        return leaves_[random_() % leaves_.size()];
      case 1:
        return ~next(depth - 1);
      case 2:
        return moved(next(depth - 1), moved_from_still({0.3 * (point() - centre_mm_), 40.0 * share() - 20.0,
                                                        point() + 0.01, centre_mm_}));
      case 3:
        return next(depth - 1) | next(depth - 1);
      case 4:
        return next(depth - 1) ^ next(depth - 1);
      case 5:
        return next(depth - 1) - next(depth - 1);
      default:
        return next(depth - 1) & next(depth - 1);
    }
  }

 private:
  double share() { return static_cast<double>(random_() % 1000) / 1000.0; }
  glm::dvec3 point() {
    const double x = share(), y = share(), z = share();
    return centre_mm_ + half_mm_ * (2.0 * glm::dvec3(x, y, z) - 1.0);
  }
  Sphere sphere() {
    const glm::dvec3 at_mm = point();
    return {at_mm, (0.2 + share()) * half_mm_.y};
  }

  std::mt19937_64 random_;
  glm::dvec3 centre_mm_{0.0}, half_mm_{0.0};
  std::vector<Expression> leaves_;
};

TEST(NodeTrace, SeesOfAnExpressionThatIsNotBuiltWhatItSeesOfItsOctree) {
  int lit = 0, unlit = 0, later_objects = 0;
  for (std::uint64_t seed = 0; seed < 64; ++seed) {
    // Up to 512 voxels a side: blocks shared by tiles, of two heights.
    const int depth = 2 + static_cast<int>(seed % 8);
    const Universe universe = spaced_universe(depth, {1.0, 2.0, 0.5});
    RandomExpressions random(universe, seed);
    const Expression first = random.next(2), second = random.next(4), third = random.next(4);
    const Octree empty = Octree::empty(universe);
    std::vector<DrawnObject> unbuilt{
        {"first", combine(universe, first)}, {"second", empty}, {"third", empty}};
    unbuilt[1].unbuilt = second;
    unbuilt[2].unbuilt = third;
    std::rotate(unbuilt.begin(), unbuilt.begin() + static_cast<std::ptrdiff_t>(seed % 3), unbuilt.end());
    const std::vector<DrawnObject> octrees = built(unbuilt);
    for (const char* name : axis_views) {
      const AxisView axes = axis_view(universe, parse_view(name)).value();
      const ColumnMap seen = node_trace(unbuilt, axes), wanted = node_trace(octrees, axes);
      ASSERT_EQ(seen.columns.size(), wanted.columns.size());
      for (std::size_t i = 0; i < wanted.columns.size(); ++i) {
        ASSERT_TRUE(seen.columns[i].object == wanted.columns[i].object &&
                    seen.columns[i].depth_mm == wanted.columns[i].depth_mm)
            << name << ", seed " << seed << ", column " << i << ": object " << seen.columns[i].object
            << " at " << seen.columns[i].depth_mm << " mm, built object " << wanted.columns[i].object
            << " at " << wanted.columns[i].depth_mm << " mm";
        (wanted.columns[i].lit() ? lit : unlit)++;
        later_objects += wanted.columns[i].object > 0;
      }
    }
  }
  EXPECT_GT(lit, 1000000);
  EXPECT_GT(unlit, 300000);
  EXPECT_GT(later_objects, 300000);
}

/// Samples rising linearly into the half-space behind a plane, `per_mm` per millimetre.
Scene ramp(const Universe& universe, const glm::dvec3& into, double offset_mm, double per_mm) {
  return tests::field_scene<std::int16_t>(universe.lattice(), [&](const glm::dvec3& p_mm) {
    return per_mm * (glm::dot(p_mm, into) - offset_mm);
  });
}

TEST(NodeTrace, PartialVolumeDepthOfASlantingPlaneIsThePlaneItselfNotItsSteps) {
  const Universe universe = spaced_universe(5);
  const glm::dvec3 into = glm::normalize(glm::dvec3(0.3, 1.0, -0.2));
  const glm::dvec3 centre_mm = universe.lattice().lps_mm(glm::dvec3(15.5));
  const double offset_mm = glm::dot(centre_mm, into);
  const double per_mm = 500.0;
  const Scene scene = ramp(universe, into, offset_mm, per_mm);
  const DrawnObject drawn{
      "plane", octree_of_window(universe, scene, 0, 32767), {}, grey_octree_of(universe, scene), 0.0};
  const AxisView axes = axis_view(universe, parse_view("anterior")).value();
  const ColumnMap map = node_trace({drawn}, axes);
  const double front_mm = bounds(universe.lattice()).low_mm.y;
  // Samples are rounded by half a unit each; the plane's slope along the ray turns that into millimetres.
  const double rounding_mm = 1.0 / (per_mm * into.y);
  int compared = 0;
  for (int j = 0; j < map.side; ++j)
    for (int i = 0; i < map.side; ++i) {
      const Seen& seen = map.at(i, j);
      if (!seen.lit() || seen.stepped) continue;
      const glm::dvec3 at_mm = universe.lattice().lps_mm({i, 0, j});
      const double y_mm = (offset_mm - into.x * at_mm.x - into.z * at_mm.z) / into.y;
      ASSERT_NEAR(seen.depth_mm, y_mm - front_mm, rounding_mm) << "column " << i << ", " << j;
      ++compared;
    }
  EXPECT_GT(compared, 800);
}

TEST(NodeTrace, WhereAnObjectWasCutInsideItsTissueTheVoxelsFaceStays) {
  const Universe universe = spaced_universe(5);
  const Scene scene = ramp(universe, {0, 1, 0}, bounds(universe.lattice()).low_mm.y + 8.0, 100.0);
  Dense cut(32);
  cut.for_each([&](const glm::ivec3& v) { cut.at(v) = v.y >= (v.x < 16 ? 8 : 20); });
  const DrawnObject drawn{"cut", tests::octree_of(universe, cut), {}, grey_octree_of(universe, scene), 0.0};
  const ColumnMap map = node_trace({drawn}, axis_view(universe, parse_view("anterior")).value());
  EXPECT_FALSE(map.at(3, 5).stepped);
  EXPECT_FLOAT_EQ(map.at(3, 5).depth_mm, 8.0f);
  EXPECT_TRUE(map.at(20, 5).stepped);
  EXPECT_FLOAT_EQ(map.at(20, 5).depth_mm, 20.0f);
}

TEST(ColumnMap, DepthBetweenColumnsIsBilinearOnASlopeAndDoesNotSmearOverABreak) {
  ColumnMap map{4, {1.0, 1.0}, std::vector<Seen>(16)};
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i)
      map.columns[static_cast<std::size_t>(i + 4 * j)] = {
          static_cast<float>(i < 2 ? 10.0 + 0.5 * i + j : 100.0), 0, false};
  map.columns[15].object = -1;
  EXPECT_FLOAT_EQ(map.seen({0.25, 1.5}).depth_mm, 10.0f + 0.125f + 1.5f);
  EXPECT_FLOAT_EQ(map.seen({1.4, 1.0}).depth_mm, 11.5f);
  EXPECT_FLOAT_EQ(map.seen({1.6, 1.0}).depth_mm, 100.0f);
  EXPECT_TRUE(map.seen({2.6, 2.4}).lit());
  EXPECT_FALSE(map.seen({2.6, 2.6}).lit());
  EXPECT_FALSE(map.seen({-0.6, 1.0}).lit());
  EXPECT_FALSE(map.seen({1.0, 3.6}).lit());
}

}  // namespace
}  // namespace octotomy::voxel
