// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/grey_octree_build.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

namespace octotomy::voxel {
namespace {

constexpr std::int16_t unread = 31000;

std::int16_t value_at(std::size_t i) {
  return static_cast<std::int16_t>((i * 2654435761U >> 16) % 3000 - 1000);
}

Scene scene_of(const Lattice& lattice) {
  Scene scene;
  scene.lattice = lattice;
  Int16Samples samples(lattice.sample_count());
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = value_at(i);
  scene.samples = std::move(samples);
  return scene;
}

std::size_t differences(const GreyOctree& a, const GreyOctree& b) {
  std::size_t count = a.scan() == b.scan() ? 0 : 1;
  const int side = a.universe().side();
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) count += a.sample({x, y, z}) != b.sample({x, y, z});
  for (int height = 2; height <= 3; ++height)
    for (int z = 0; z < side >> (2 * height); ++z)
      for (int y = 0; y < side >> (2 * height); ++y)
        for (int x = 0; x < side >> (2 * height); ++x) {
          const MinMax one = a.range(height, {x, y, z}), other = b.range(height, {x, y, z});
          count += one.low != other.low || one.high != other.high;
        }
  return count;
}

/// A scan of slices that are thicker than the universe's voxels, thinner, shifted by whole voxels, mirrored,
/// turned.
std::vector<Lattice> lattices() {
  const auto scaled = [](const glm::ivec3& dims, double x, double y, double z, const glm::dvec3& at_mm) {
    glm::dmat4 lps_from_voxel(0.0);
    lps_from_voxel[0].x = x;
    lps_from_voxel[1].y = y;
    lps_from_voxel[2].z = z;
    lps_from_voxel[3] = glm::dvec4(at_mm, 1.0);
    return Lattice{dims, lps_from_voxel};
  };
  std::vector<Lattice> all{
      scaled({40, 30, 60}, 1, 1, 1, {3, 20, -4}), scaled({50, 40, 130}, 0.7, 0.7, 0.45, {1.3, 2, 3}),
      scaled({30, 60, 12}, 2, 1, 4.7, {0.2, 0, 5}), scaled({40, 40, 70}, 1.5, -1, -0.8, {0, 50, 60})};
  Lattice turned = scaled({40, 40, 40}, 1, 1, 1, {5, 5, 5});
  std::swap(turned.lps_from_voxel[1], turned.lps_from_voxel[2]);
  all.push_back(turned);
  return all;
}

TEST(GreyOctreeBuild, HasTheBitsOfTheWholeScanHoweverItsSlicesArrive) {
  const Universe universe{6, glm::dmat4(1.0)};
  for (const std::size_t threads : {1, 2, 3}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    for (const Lattice& lattice : lattices())
      for (const int at_once : {1, 7, 1000}) {
        const Scene whole = scene_of(lattice);
        Scene scene = whole;
        auto& samples = std::get<Int16Samples>(scene.samples);
        std::fill(samples.begin(), samples.end(), unread);
        const std::size_t slice = samples.size() / static_cast<std::size_t>(lattice.dims.z);
        GreyOctreeBuild build(universe, scene);
        for (int count = 0; count < lattice.dims.z;) {
          const int next = std::min(count + at_once, lattice.dims.z);
          for (std::size_t i = slice * static_cast<std::size_t>(count);
               i < slice * static_cast<std::size_t>(next); ++i)
            samples[i] = value_at(i);
          build.add(count = next);
        }
        EXPECT_EQ(differences(build.finished(), grey_octree_of(universe, whole)), 0U)
            << threads << " threads, " << at_once << " slices at once of " << lattice.dims.z << " by "
            << lattice.lps_from_voxel[2].z << " mm";
      }
  }
}

TEST(GreyOctreeBuild, IsGivenUpWithWhatItHas) {
  const Scene scene = scene_of(lattices().front());
  for (int count = 0; count < scene.lattice.dims.z; count += 9) {
    GreyOctreeBuild build({6, glm::dmat4(1.0)}, scene);
    build.add(count);
  }
}

TEST(GreyOctreeBuild, EndsOnOneThreadWhereItIsBegunAndFinishedInLoopsThatTakeUpNoOtherWork) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const Universe universe{6, glm::dmat4(1.0)};
  const Scene scene = scene_of(lattices().back());
  GreyOctreeBuild build(universe, scene);
  tbb::this_task_arena::isolate([&] { build.add(scene.lattice.dims.z); });
  std::optional<GreyOctree> grey;
  tbb::this_task_arena::isolate([&] { grey = build.finished(); });
  EXPECT_EQ(differences(*grey, grey_octree_of(universe, scene)), 0U);
}

TEST(GreyOctreeBuild, ThrowsWhatItsThreadsThrow) {
  const Universe universe{6, glm::dmat4(1.0)};
  Scene scene;
  scene.lattice = universe.lattice();
  FloatSamples samples(scene.lattice.sample_count(), 0.0F);
  samples.back() = 40000.0F;
  scene.samples = std::move(samples);
  GreyOctreeBuild build(universe, scene);
  build.add(64);
  EXPECT_THROW(build.finished(), std::invalid_argument);
}

TEST(GreyOctreeBuild, TellsItsProgressAndStopsInBetweenWithTheSameBits) {
  const Universe universe{6, glm::dmat4(1.0)};
  for (const Lattice& lattice : lattices()) {
    const Scene scene = scene_of(lattice);
    std::stop_source source;
    std::vector<double> told;
    const Progress progress{source.get_token(), [&](double fraction) { told.push_back(fraction); }};
    const GreyOctree grey = grey_octree_of(universe, scene, beyond_scan, progress);
    EXPECT_EQ(differences(grey, grey_octree_of(universe, scene)), 0U);
    EXPECT_GE(told.size(), 10U);
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
    EXPECT_EQ(told.back(), 1.0);
    const Progress stopping{source.get_token(), [&](double) { source.request_stop(); }};
    EXPECT_THROW(grey_octree_of(universe, scene, beyond_scan, stopping), Stopped);
  }
}

}  // namespace
}  // namespace octotomy::voxel
