// SPDX-License-Identifier: AGPL-3.0-or-later
// A plan of 30 steps of which the last motion changes: read again and evaluated on what the others left in
// the cache, without certificates, as it is while a piece is dragged.
#include <filesystem>
#include <memory>
#include <string>

#include "planner/plan/evaluate.h"
#include "planner/plan/object_cache.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/subjects.h"
#include "tests/bench/workspace.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::bench {
namespace {

/// Nine pieces of the face, each cut and moved, the bone that stays, and the last motion.
std::string plan_text(int side, double up_mm) {
  const auto number = [](double value) { return std::to_string(value); };
  std::string steps = R"({"id": "skull", "do": "window", "scan": "ct", "low": 300})", less = "skull";
  for (int i = 0; i < 9; ++i) {
    const std::string n = std::to_string(i);
    const double low = -60.0 + 10.0 * i;
    steps += R"(, {"id": "cut_)" + n +
             R"(", "do": "mask", "regions": [{"view": "anterior", "polygons_mm": [[[-40, )" + number(low) +
             "], [40, " + number(low) + "], [40, " + number(low + 9.0) + "], [-40, " + number(low + 9.0) +
             R"(]]]}, {"view": "left", "polygons_mm": [[[-110, -70], [-40, -70], [-40, 60],
             [-110, 60]]]}]}, {"id": "piece_)" +
             n + R"(", "do": "combine", "expression": "skull & cut_)" + n + R"("}, {"id": "moved_)" + n +
             R"(", "do": "move", "object": "piece_)" + n + R"(", "translate_mm": [0, -3, 1]})";
    less += " - cut_" + n;
  }
  steps += R"(, {"id": "rest", "do": "combine", "expression": ")" + less + R"("}, {"id": "last", "do": "move",
      "object": "piece_1", "translate_mm": [0, -6, )" +
           number(up_mm) + R"(], "rotate": {"degrees": 5, "axis": [1, 0, 0], "about_mm": [0, -40, -30]}})";
  return R"({"octotomy_plan": 1, "name": "replan", "scans": {"ct": {"path": "head.nrrd"}}, 
      "universe": {"voxel_mm": )" +
         number(universe(side).lattice().spacing_mm().x) + R"(}, "steps": [)" + steps + "]}";
}

void last_motion(benchmark::State& state, int side) {
  const std::filesystem::path folder = workspace() / "replan";
  std::filesystem::create_directories(folder);
  voxel::write_scene(head(side), folder / "head.nrrd");
  planner::ObjectCache cache;
  planner::EvaluateOptions options;
  options.certify = options.meshes = false;
  options.cache = &cache;
  double up_mm = 0.0;
  planner::evaluate(planner::parse_plan(plan_text(side, up_mm), folder), options);
  options.only_look_up = true;
  for (auto _ : state) {
    const planner::Evaluation made =
        planner::evaluate(planner::parse_plan(plan_text(side, up_mm += 0.01), folder), options);
    benchmark::DoNotOptimize(made.object("last").voxel.octree);
    state.counters["side"] = made.universe.side();
  }
}

}  // namespace

void register_replan() {
  for (const int side : {256, 512})
    add("replan/last_motion/skull/" + std::to_string(side),
        [side](benchmark::State& state) { last_motion(state, side); });
}

}  // namespace octotomy::bench
