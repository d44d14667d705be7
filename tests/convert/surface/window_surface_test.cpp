// SPDX-License-Identifier: AGPL-3.0-or-later
// Surfaces of windows with samples on either side.
#include "convert/surface/window_surface.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <set>
#include <tbb/global_control.h>
#include <utility>
#include <vector>

#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "convert/surface/isosurface.h"
#include "tests/convert/surfaces.h"
#include "voxel/tree/grey_octree.h"

namespace octotomy::convert {
namespace {

using tests::area_mm2;
using tests::fault_in_closedness;
using tests::volume_mm3;

constexpr double unbounded = std::numeric_limits<double>::infinity();

/// Samples drawn from a list of values, each with the same chance, in a shell of `border` samples of the last.
voxel::Scene drawn(const glm::ivec3& dims, unsigned seed, const std::vector<float>& values, int border = 0) {
  std::mt19937 random(seed);
  voxel::FloatSamples samples;
  for (int z = 0; z < dims.z; ++z)
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x) {
        const glm::ivec3 at(x, y, z), from_end = dims - 1 - at;
        const int depth = std::min({x, y, z, from_end.x, from_end.y, from_end.z});
        const float value = values[random() % values.size()];
        samples.push_back(depth < border ? values.back() : value);
      }
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice(dims, {1, 1, 1}, {0, 0, 0});
  scene.samples = std::move(samples);
  return scene;
}

voxel::Scene distances(int side, const glm::dvec3& centre, double steepness) {
  voxel::FloatSamples samples;
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice(glm::ivec3(side), {1, 1, 1}, {0, 0, 0});
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        samples.push_back(static_cast<float>(steepness * glm::length(glm::dvec3(x, y, z) - centre)));
  scene.samples = std::move(samples);
  return scene;
}

void expect_healthy(const voxel::Scene& scene, double low, double high, const std::string& what) {
  const brep::Triangles surface = isosurface(scene, low, high);
  ASSERT_GT(surface.faces.size(), 0U) << what;
  ASSERT_EQ(fault_in_closedness(surface), std::nullopt) << what;
  const brep::Health health = brep::health(surface);
  EXPECT_EQ(health.self_intersections, 0U) << what;
  EXPECT_EQ(health.degenerate_faces, 0U) << what;
  EXPECT_TRUE(health.closed && health.manifold) << what;
  EXPECT_GT(volume_mm3(surface), 0.0) << what;
  std::set<std::uint32_t> used;
  for (const auto& face : surface.faces) used.insert(face.begin(), face.end());
  EXPECT_EQ(used.size(), surface.points_mm.size()) << what;
}

TEST(WindowSurface, OfAnyPatternOfSamplesIsClosedManifoldAndFreeOfSelfIntersection) {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinite = std::numeric_limits<float>::infinity();
  // Samples below, in and above 10..20; on the bounds and beside them; so steep that crossings are as close
  // as possible; and all of these with samples that were not measured.
  const std::vector<std::vector<float>> lists = {
      {0, 5, 9, 12, 15, 18, 21, 25, 30},
      {9.99F, 10, 20, 20.01F, 15},
      {-30000, 30000, 10, 20, 9, 21},
      {-30000, 30000},
      {0, 30},
      {0, 0, 0, 30, 30, 9.9F, 20.1F, 1e6F, -1e6F},
      {0, 30, 15, nan},
      {-infinite, infinite, 0, 30, 15, nan},
      {0, 30, 30, 30, 15, 15, 15, 15, nan, nan, nan, nan},
  };
  unsigned seed = 0;
  for (std::size_t i = 0; i < lists.size(); ++i)
    for (const glm::ivec3& dims : {glm::ivec3(13, 12, 11), glm::ivec3(65, 4, 5), glm::ivec3(9, 14, 2)}) {
      ++seed;
      expect_healthy(drawn(dims, seed, lists[i]), 10, 20,
                     "list " + std::to_string(i) + ", seed " + std::to_string(seed));
    }
}

TEST(WindowSurface, OnATurnedAndAMirroredLatticeIsHealthyToo) {
  voxel::Scene scene = drawn({12, 11, 10}, 3, {0, 5, 9, 12, 15, 18, 21, 25, 30});
  scene.lattice.lps_from_voxel =
      glm::rotate(glm::dmat4(1.0), 0.7, glm::dvec3(1, 2, 3)) * glm::scale(glm::dmat4(1.0), {0.7, 0.9, 2.5});
  scene.lattice.lps_from_voxel[3] = {300, -200, 700, 1};
  expect_healthy(scene, 10, 20, "turned");
  scene.lattice.lps_from_voxel[1] = -scene.lattice.lps_from_voxel[1];
  ASSERT_FALSE(scene.lattice.right_handed());
  expect_healthy(scene, 10, 20, "mirrored");
}

TEST(WindowSurface, AShellThinnerThanASampleKeepsItsVolumeAndArea) {
  for (const double thick : {0.05, 0.3, 0.8, 1.7}) {
    const voxel::Scene scene = distances(41, {20.2, 19.9, 20.1}, 100.0);
    const double inner = 12.0, outer = inner + thick;
    const brep::Triangles shell = isosurface(scene, 100.0 * inner, 100.0 * outer);
    const double volume = 4.0 / 3.0 * std::numbers::pi * (std::pow(outer, 3) - std::pow(inner, 3));
    const double area = 4.0 * std::numbers::pi * (outer * outer + inner * inner);
    EXPECT_EQ(fault_in_closedness(shell), std::nullopt) << thick;
    EXPECT_NEAR(volume_mm3(shell), volume, 0.01 * volume) << thick;
    EXPECT_NEAR(area_mm2(shell), area, 0.01 * area) << thick;
    EXPECT_EQ(brep::health(shell).components, 2U) << thick;
  }
}

TEST(WindowSurface, OfNeighbouringWindowsAddsUpToThatOfBoth) {
  // No cell at the border is crossed. Windows meet at bounds that no sample has. The sums are not exact: in a
  // few cells triangles differ, so that two levels of a window do not cross. Noise has many such cells.
  const auto expect_sums = [](const voxel::Scene& scene, double from, double middle, double to,
                              double share) {
    const auto volume = [&](double low, double high) { return volume_mm3(isosurface(scene, low, high)); };
    const double both = volume(from, to);
    EXPECT_GT(both, 1000.0);
    EXPECT_NEAR(volume(from, middle) + volume(middle, to), both, share * both);
    EXPECT_NEAR(volume(from, to) + volume(to, unbounded), volume(from, unbounded), share * both);
  };
  expect_sums(drawn({20, 19, 18}, 11, {0, 40, 90, 110, 150, 190, 260, 300, -500, 900, 0}, 2), 99.5, 199.5,
              299.5, 0.03);
  voxel::Scene ball = distances(41, {20.2, 19.9, 20.1}, -100.0);
  expect_sums(ball, -1300.5, -1220.5, -1180.5, 1e-4);
}

TEST(WindowSurface, WithoutSamplesOnOneSideHasTheBitsOfTheOtherBoundAlone) {
  const voxel::Scene scene = drawn({12, 11, 10}, 5, {1, 2, 3, 4, 5, 6});
  const brep::Triangles one = isosurface(scene, 3.5, unbounded), two = isosurface(scene, 3.5, 6.0);
  EXPECT_EQ(one.points_mm, two.points_mm);
  EXPECT_EQ(one.faces, two.faces);
  const brep::Triangles below = isosurface(scene, -unbounded, 3.5), from = isosurface(scene, 1.0, 3.5);
  EXPECT_EQ(below.points_mm, from.points_mm);
  EXPECT_EQ(below.faces, from.faces);
}

TEST(WindowSurface, BetweenASampleBelowAndOneAboveIsALayer) {
  // A row of samples in a block of samples below the window: 0 0 100 0 0.
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice({5, 5, 5}, {1, 1, 1}, {0, 0, 0});
  voxel::Int16Samples samples(125, 0);
  samples[62] = 100;
  scene.samples = samples;
  const brep::Triangles shell = isosurface(scene, 20, 50);
  // Two octahedra with corners at 0.8 and 0.5 of the edges.
  EXPECT_EQ(shell.faces.size(), 16U);
  EXPECT_NEAR(volume_mm3(shell), 4.0 / 3.0 * (0.512 - 0.125), 1e-12);
  // A single value has nothing between its two levels.
  EXPECT_TRUE(isosurface(scene, 20, 20).faces.empty());
}

TEST(WindowSurface, AtTheScansBorderNoFilmCoversWhatIsAboveTheWindow) {
  // Above the window everywhere but in one sample within it.
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice({9, 9, 9}, {1, 1, 1}, {0, 0, 0});
  voxel::Int16Samples samples(729, 100);
  samples[364] = 10;
  samples[0] = 30;
  scene.samples = samples;
  const brep::Triangles surface = isosurface(scene, 20, 50);
  EXPECT_EQ(fault_in_closedness(surface), std::nullopt);
  EXPECT_LT(area_mm2(surface), 12.0);
  EXPECT_GT(volume_mm3(surface), 0.0);
}

TEST(WindowSurface, OfAGreyOctreeHasTheBitsOfItsSamplesScene) {
  voxel::Scene floats = drawn(glm::ivec3(32), 17, {0, 50, 90, 120, 150, 180, 210, 250, 300});
  voxel::Int16Samples samples;
  for (const float sample : std::get<voxel::FloatSamples>(floats.samples))
    samples.push_back(static_cast<std::int16_t>(sample));
  floats.samples = samples;
  voxel::Universe universe;
  universe.depth = 5;
  const brep::Triangles of_scene = isosurface(floats, 100, 200);
  const brep::Triangles of_octree = isosurface(voxel::grey_octree_of(universe, floats), 100, 200);
  EXPECT_GT(of_scene.faces.size(), 10000U);
  EXPECT_EQ(of_octree.faces, of_scene.faces);
  EXPECT_EQ(of_octree.points_mm, of_scene.points_mm);
}

TEST(WindowSurface, HasTheSameBitsOnOneThreadAndMany) {
  const voxel::Scene scene = drawn({40, 30, 20}, 7, {0, 5, 9, 12, 15, 18, 21, 25, 30});
  const brep::Triangles many = isosurface(scene, 10, 20);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const brep::Triangles single = isosurface(scene, 10, 20);
  EXPECT_EQ(many.faces, single.faces);
  EXPECT_EQ(many.points_mm, single.points_mm);
}

}  // namespace
}  // namespace octotomy::convert
