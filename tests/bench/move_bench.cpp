// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>
#include <string>
#include <tbb/parallel_for.h>

#include "tests/bench/benchmarks.h"
#include "tests/bench/dense_bits.h"
#include "tests/bench/pairs.h"
#include "tests/bench/subjects.h"
#include "voxel/solid/combine.h"

namespace octotomy::bench {
namespace {

void run(benchmark::State& state, const voxel::Expression& still, const voxel::Motion& motion, int side) {
  const voxel::Expression expression = moved(still, moved_from_still(motion));
  std::uint64_t voxels = 0;
  for (auto _ : state)
    benchmark::DoNotOptimize(voxels = voxel::combine(universe(side), expression).voxel_count());
  state.counters["voxels"] = static_cast<double>(voxels);
}

// Looks up every voxel of the universe at its place before the motion: one row of 64 voxels at a time, in
// fixed point, so that the compiler can vectorise.
void run_dense(benchmark::State& state, const voxel::Motion& motion, int side) {
  const DenseBits source = dense_bits_of(skull(side));
  const voxel::Lattice lattice = universe(side).lattice();
  const glm::dmat4 source_from_target =
      glm::inverse(lattice.lps_from_voxel) * glm::inverse(moved_from_still(motion)) * lattice.lps_from_voxel;
  const int words_per_row = (side + 63) / 64;
  std::vector<std::uint64_t> result(source.words.size());
  const auto fixed = [](double p) { return static_cast<std::int32_t>(std::lround(std::ldexp(p, 20))); };
  const glm::ivec3 step(fixed(source_from_target[0][0]), fixed(source_from_target[0][1]),
                        fixed(source_from_target[0][2]));
  for (auto _ : state) {
    tbb::parallel_for(0, side * side, [&](int row) {
      const glm::dvec4 first(0, row % side, row / side, 1);
      const glm::dvec3 p = glm::dvec3(source_from_target * first) + 0.5;
      const glm::ivec3 base(fixed(p.x), fixed(p.y), fixed(p.z));
      for (int i = 0; i < words_per_row; ++i) {
        std::uint32_t place[64];
        std::uint32_t outside[64];
        for (int x = 0; x < 64; ++x) {
          const std::int32_t along = 64 * i + x;
          const auto sx = static_cast<std::uint32_t>((base.x + along * step.x) >> 20);
          const auto sy = static_cast<std::uint32_t>((base.y + along * step.y) >> 20);
          const auto sz = static_cast<std::uint32_t>((base.z + along * step.z) >> 20);
          const auto limit = static_cast<std::uint32_t>(side - 1);
          outside[x] = (sx | sy | sz) & ~limit;
          place[x] = (sx & limit) + static_cast<std::uint32_t>(side) *
                                        ((sy & limit) + static_cast<std::uint32_t>(side) * (sz & limit));
        }
        std::uint64_t word = 0;
        for (int x = 0; x < 64; ++x) {
          const std::uint64_t bit = (source.words[place[x] / 64] >> (place[x] % 64)) & 1;
          word |= (outside[x] == 0 ? bit : 0) << x;
        }
        result[static_cast<std::size_t>(row) * static_cast<std::size_t>(words_per_row) +
               static_cast<std::size_t>(i)] = word;
      }
    });
    benchmark::ClobberMemory();
  }
}

// 36 turns of 10 degrees, evaluated after each turn, to show the volume that this loses; and composed before
// one evaluation, which loses none.
void run_circle(benchmark::State& state, bool evaluated, const voxel::Resampling& resampling) {
  constexpr int side = 256;
  voxel::Motion ten;
  ten.degrees = 10.0;
  ten.axis = glm::normalize(glm::dvec3(0.3, -0.5, 0.8));
  const glm::dmat4 step = moved_from_still(ten);
  const voxel::Octree start = skull(side);
  voxel::Octree end = start;
  for (auto _ : state) {
    voxel::Expression object = start;
    for (int i = 0; i < 36; ++i) {
      object = moved(object, step);
      if (evaluated) object = voxel::combine(universe(side), object, resampling);
    }
    end = voxel::combine(universe(side), object, resampling);
  }
  const auto before = static_cast<double>(start.voxel_count());
  state.counters["volume_drift_percent"] = 100.0 * (static_cast<double>(end.voxel_count()) / before - 1.0);
  const voxel::Octree changed = voxel::combine(universe(side), voxel::Expression(start) ^ end);
  state.counters["changed_percent"] = 100.0 * static_cast<double>(changed.voxel_count()) / before;
}

}  // namespace

void register_move() {
  add("move/full_circle/composed/256", [](benchmark::State& state) { run_circle(state, false, {}); });
  add("move/full_circle/centre/256", [](benchmark::State& state) { run_circle(state, true, {}); });
  add("move/full_circle/half/256", [](benchmark::State& state) {
    run_circle(state, true, {voxel::Resampling::Voxels::Half, voxel::Interpolation::Linear});
  });
  for (const int side : {256, 512})
    for (const bool turned : {false, true}) {
      const auto motion = [=] { return turned ? rotation() : translation(side); };
      const std::string task = turned ? "move/rotate/" : "move/translate/";
      const std::string size = std::to_string(side);
      add(task + "skull/" + size, [=](benchmark::State& state) { run(state, skull(side), motion(), side); });
      add(task + "skull_grey/" + size, [=](benchmark::State& state) {
        run(state, voxel::Window{grey_skull(side), 300, 32767}, motion(), side);
      });
      add("reference/dense_bits/" + task + "skull/" + size,
          [=](benchmark::State& state) { run_dense(state, motion(), side); });
    }
}

}  // namespace octotomy::bench
