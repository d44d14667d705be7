// SPDX-License-Identifier: AGPL-3.0-or-later

#include <functional>
#include <numeric>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include "tests/bench/benchmarks.h"
#include "tests/bench/subjects.h"
#include "voxel/measure/measure.h"
#include "voxel/tree/build.h"

namespace octotomy::bench {
namespace {

// The head's samples on the universe's whole lattice, so that a pass over them is a pass over side^3 samples.
const voxel::Scene& whole_scene(int side) {
  static const voxel::Scene scene = [side] {
    const voxel::GreyOctree grey = grey_skull(side);
    voxel::Scene whole;
    whole.lattice = universe(side).lattice();
    voxel::Int16Samples samples;
    samples.reserve(whole.lattice.sample_count());
    for (int z = 0; z < side; ++z)
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) samples.push_back(grey.sample({x, y, z}));
    whole.samples = std::move(samples);
    return whole;
  }();
  return scene;
}

}  // namespace

void register_build() {
  add("build/binary/512", [](benchmark::State& state) {
    const voxel::Scene& scene = whole_scene(512);
    for (auto _ : state)
      benchmark::DoNotOptimize(voxel::octree_of_window(universe(512), scene, 300, 32767).root());
  });
  // No build takes less: every sample is read once.
  add("reference/read/build/binary/512", [](benchmark::State& state) {
    const auto& samples = std::get<voxel::Int16Samples>(whole_scene(512).samples);
    for (auto _ : state)
      benchmark::DoNotOptimize(tbb::parallel_reduce(
          tbb::blocked_range<const std::int16_t*>(samples.data(), samples.data() + samples.size(), 1 << 16),
          0u,
          [](const auto& range, unsigned sum) { return std::accumulate(range.begin(), range.end(), sum); },
          std::plus<>()));
  });
  add("build/grey/512", [](benchmark::State& state) {
    const voxel::Scene& scene = whole_scene(512);
    for (auto _ : state) benchmark::DoNotOptimize(voxel::grey_octree_of(universe(512), scene).background());
  });
}

void register_measure() {
  add("measure/volume/512", [](benchmark::State& state) {
    const voxel::Octree object = skull(512);
    for (auto _ : state) benchmark::DoNotOptimize(object.voxel_count());
  });
  // Moments, extents and the areas of both estimators.
  add("measure/all/512", [](benchmark::State& state) {
    const voxel::Octree object = skull(512);
    for (auto _ : state) benchmark::DoNotOptimize(voxel::measure(object).area_crofton13_mm2);
  });
}

}  // namespace octotomy::bench
