// SPDX-License-Identifier: AGPL-3.0-or-later
// Streaks of metal held within bounds.
#include "planner/operation/table/operation.h"
#include "voxel/filter/streak_clamp.h"

namespace octotomy::planner {
namespace {

struct ClampStreaks {
  ScanName scan;
  double metal = voxel::StreakOptions{}.metal;
  double low = voxel::StreakOptions{}.low;
  double high = voxel::StreakOptions{}.high;
  double reach_mm = voxel::StreakOptions{}.reach_mm;
};

MadeScan made(const ClampStreaks& step, const ScanBench& bench) {
  voxel::StreakOptions options;
  options.metal = step.metal;
  options.low = step.low;
  options.high = step.high;
  options.reach_mm = step.reach_mm;
  options.progress = bench.progress;
  voxel::StreakClamp clamp = voxel::clamp_streaks(bench.samples(step.scan.name), options);
  return {std::move(clamp.scene),
          {{"metal", options.metal},
           {"low", options.low},
           {"high", options.high},
           {"reach_mm", options.reach_mm},
           {"metal_samples", clamp.metal},
           {"metal_slices", clamp.slices},
           {"raised_samples", clamp.raised},
           {"lowered_samples", clamp.lowered}}};
}

}  // namespace

Operation clamp_streaks_operation() {
  return Describe<ClampStreaks>(
             "clamp_streaks",
             "Limits samples near metal to the range 'low' to 'high', to reduce metal artefacts.",
             Makes::Scan)
      .takes(field("scan", &ClampStreaks::scan, "The scan.").required())
      .takes(field("metal", &ClampStreaks::metal, "Samples of at least this value are metal."))
      .takes(
          field("low", &ClampStreaks::low, "Samples near metal that are below this value are raised to it."))
      .takes(field("high", &ClampStreaks::high,
                   "Samples near metal that are above this value, but are not metal, are lowered to it."))
      .takes(
          field("reach_mm", &ClampStreaks::reach_mm, "Distance from metal within which samples are limited.")
              .greater_than(0.0))
      .example(R"({"id": "held", "do": "clamp_streaks", "scan": "ct", "reach_mm": 20})")
      .on_files("clamp_streaks=METAL,LOW,HIGH,REACH")
      .scan(made);
}

}  // namespace octotomy::planner
