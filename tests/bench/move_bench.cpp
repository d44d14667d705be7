// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/bench/benchmarks.h"
#include "tests/bench/subjects.h"
#include "voxel/combine.h"

namespace octotomy::bench {
namespace {

voxel::Motion translation(int side) {
  voxel::Motion motion;
  motion.translate_mm = universe(side).lattice().spacing_mm() * glm::dvec3(3, -11, 6);
  return motion;
}

voxel::Motion rotation(int) {
  voxel::Motion motion;
  motion.degrees = 5.0;
  motion.axis = {1, 0.2, 0.1};
  motion.about_mm = {0, -40, -30};
  motion.translate_mm = {0, -6, 2};
  return motion;
}

void run(benchmark::State& state, const voxel::Expression& still, const voxel::Motion& motion, int side) {
  const voxel::Expression expression = moved(still, moved_from_still(motion));
  for (auto _ : state) benchmark::DoNotOptimize(voxel::combine(universe(side), expression).voxel_count());
}

}  // namespace

void register_move() {
  for (const int side : {256, 512})
    for (const bool turned : {false, true}) {
      const auto motion = [=] { return turned ? rotation(side) : translation(side); };
      const std::string task = turned ? "move/rotate/" : "move/translate/";
      add(task + "skull/" + std::to_string(side),
          [=](benchmark::State& state) { run(state, skull(side), motion(), side); });
      add(task + "skull_grey/" + std::to_string(side), [=](benchmark::State& state) {
        run(state, voxel::Window{grey_skull(side), 300, 32767}, motion(), side);
      });
    }
}

}  // namespace octotomy::bench
