// SPDX-License-Identifier: AGPL-3.0-or-later
//
// All rays of a picture together must give the same surfaces as each ray alone.
#include "voxel/view/parallel_rays.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "tests/voxel/dense.h"
#include "tests/voxel/spaced_universe.h"
#include "voxel/solid/expression.h"
#include "voxel/view/ray_cast.h"

namespace octotomy::voxel {
namespace {

using tests::Dense;
using tests::spaced_universe;

/// Blobs among single voxels: Full blocks of all sizes, and rays that go far between them.
Dense blobs(int side, std::mt19937& random) {
  Dense dense(side);
  const auto any = [&](int below) { return static_cast<int>(random() % static_cast<unsigned>(below)); };
  for (int blob = 0; blob < 3; ++blob) {
    const glm::ivec3 centre(any(side), any(side), any(side));
    const int radius = 1 + any(side / 3);
    dense.for_each([&](const glm::ivec3& v) {
      const glm::ivec3 d = v - centre;
      if (d.x * d.x + d.y * d.y + d.z * d.z <= radius * radius) dense.at(v) = 1;
    });
  }
  for (int voxel = 0; voxel < side; ++voxel) dense.at({any(side), any(side), any(side)}) = 1;
  return dense;
}

/// Samples that make the dense object their window from 0 up, of any steepness at its border.
GreyOctree samples_of(const Universe& universe, const Dense& dense, std::mt19937& random) {
  Scene scene;
  scene.lattice = universe.lattice();
  Int16Samples samples(scene.lattice.sample_count());
  std::size_t next = 0;
  for (int z = 0; z < universe.side(); ++z)
    for (int y = 0; y < universe.side(); ++y)
      for (int x = 0; x < universe.side(); ++x) {
        const auto size = static_cast<std::int16_t>(1 + random() % 900);
        samples[next++] = dense.at({x, y, z}) ? size : static_cast<std::int16_t>(-size);
      }
  scene.samples = std::move(samples);
  return grey_octree_of(universe, scene, -1000);
}

/// One or two objects, binary or with samples, and a view of them from near or far.
struct Subject {
  std::vector<DrawnObject> objects;
  ImagePlane plane;
};
Subject subject_of(std::uint64_t seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  const Universe universe = spaced_universe(3 + static_cast<int>(seed % 4), {1.0, 1.5, 0.75});
  Subject subject;
  for (std::uint64_t i = 0; i < 1 + seed % 2; ++i) {
    const Dense dense = blobs(universe.side(), random);
    DrawnObject object{"object", tests::octree_of(universe, dense)};
    if (seed % 3 != 0) object.grey = samples_of(universe, dense, random);
    if (object.grey && seed % 5 == 2)
      object.moved_from_still =
          moved_from_still({{1.3, -0.7, 0.4}, 11.0, {1, 2, -1}, universe.lattice().lps_mm(glm::dvec3(3.5))});
    // A part of the window's voxels, so that rays meet cut faces, and voxels without samples of the object.
    if (seed % 4 == 3) {
      Dense part = dense;
      part.for_each([&](const glm::ivec3& v) {
        if (v.x + v.y > universe.side()) part.at(v) = (v.x & 7) == 7 ? 1 : 0;
      });
      object.octree = tests::octree_of(universe, part);
    }
    subject.objects.push_back(object);
  }
  const std::string name = seed % 7 == 0 ? "anterior"
                                         : std::to_string(static_cast<int>(random() % 359) - 179) + "," +
                                               std::to_string(static_cast<int>(random() % 179) - 89);
  const View view = parse_view(name);
  const Box box = bounds(universe.lattice());
  const double width_mm = glm::length(box.high_mm - box.low_mm) * (seed % 5 == 0   ? 0.1
                                                                   : seed % 5 == 1 ? 3.0
                                                                                   : 1.0);
  subject.plane =
      image_plane(universe, view, {150, 90}, {view.project(0.5 * (box.low_mm + box.high_mm)), width_mm});
  return subject;
}

TEST(ParallelRays, SeeBitForBitWhatEachRaySeesByItself) {
  int lit = 0, unlit = 0, second = 0, stepped = 0, smooth = 0, moved_smooth = 0, moved_stepped = 0;
  for (std::uint64_t seed = 0; seed < 80; ++seed) {
    const Subject subject = subject_of(seed);
    const RayCast cast(subject.objects, subject.plane);
    const DepthImage image = cast.picture();
    for (int y = 0; y < image.size_px.y; ++y)
      for (int x = 0; x < image.size_px.x; ++x) {
        const Seen& one = image.at(x, y);
        const Seen other = cast.seen({x + 0.5, y + 0.5});
        ASSERT_EQ(one.object, other.object) << "pixel " << x << ", " << y << ", seed " << seed;
        ASSERT_EQ(one.depth_mm, other.depth_mm) << "pixel " << x << ", " << y << ", seed " << seed;
        ASSERT_EQ(one.stepped, other.stepped) << "pixel " << x << ", " << y << ", seed " << seed;
        (one.lit() ? lit : unlit)++;
        second += one.object > 0;
        if (one.lit()) (one.stepped ? stepped : smooth)++;
        if (one.lit() && subject.objects[static_cast<std::size_t>(one.object)].moved_from_still)
          (one.stepped ? moved_stepped : moved_smooth)++;
      }
  }
  EXPECT_GT(lit, 100000);
  EXPECT_GT(unlit, 100000);
  EXPECT_GT(second, 10000);
  EXPECT_GT(stepped, 10000);
  EXPECT_GT(smooth, 10000);
  EXPECT_GT(moved_stepped, 1000);
  EXPECT_GT(moved_smooth, 1000);
}

TEST(ParallelRays, OfferEveryVoxelOfARayInOrderUntilOneIsTaken) {
  std::mt19937 random(7);
  const Universe universe = spaced_universe(5, {1.0, 1.5, 0.75});
  const Dense dense = blobs(universe.side(), random);
  const Octree octree = tests::octree_of(universe, dense);
  const View view = parse_view("33,-21");
  const Box box = bounds(universe.lattice());
  const ImagePlane plane =
      image_plane(universe, view, glm::ivec2(64), {view.project(0.5 * (box.low_mm + box.high_mm)), 40.0});
  const VoxelRays rays = voxel_rays(universe, plane);
  const Mirror mirror(rays.per_mm, 1 << (2 * octree.root_height()));
  std::vector<std::vector<glm::ivec3>> offered(64 * 64);
  ParallelRays(octree, rays).cast({0, 0}, {63, 63}, [&](const RayBatch& batch) {
    for (std::size_t ray = 0; ray < static_cast<std::size_t>(batch.count); ++ray)
      offered[static_cast<std::size_t>(batch.x[ray] + 64 * batch.y[ray])].push_back(batch.passage(ray).voxel);
    return RayBatch::Rays{0};
  });
  std::size_t voxels = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      std::vector<glm::ivec3> walked;
      Walk(octree.root(), octree.root_height(), mirror)
          .run(mirror.mirrored(rays.start({x + 0.5, y + 0.5})), -1e9, 1e9, [&](const Passage& passage) {
            walked.push_back(passage.voxel);
            return false;
          });
      ASSERT_EQ(offered[static_cast<std::size_t>(x + 64 * y)], walked) << "pixel " << x << ", " << y;
      voxels += walked.size();
    }
  EXPECT_GT(voxels, 5000u);
}

}  // namespace
}  // namespace octotomy::voxel
