// SPDX-License-Identifier: AGPL-3.0-or-later
// Samples smoothed along edges, not across them.
#include "planner/operation/table/operation.h"
#include "voxel/filter/smooth.h"

namespace octotomy::planner {
namespace {

struct EdgePreserving {
  ScanName scan;
  int iterations = voxel::DiffusionOptions{}.iterations;
  double conductance = voxel::DiffusionOptions{}.conductance;
};

MadeScan made(const EdgePreserving& step, const ScanBench& bench) {
  voxel::DiffusionOptions options;
  options.iterations = step.iterations;
  options.conductance = step.conductance;
  options.progress = bench.progress;
  return {voxel::diffuse(bench.samples(step.scan.name), options),
          {{"iterations", options.iterations}, {"conductance", options.conductance}}};
}

}  // namespace

Operation edge_preserving_operation() {
  return Describe<EdgePreserving>("edge_preserving", "Smooths a scan along its edges, but not across them.",
                                  Makes::Scan)
      .takes(field("scan", &EdgePreserving::scan, "The scan.").required())
      .takes(field("iterations", &EdgePreserving::iterations, "Steps of the diffusion.").from(1))
      .takes(field("conductance", &EdgePreserving::conductance,
                   "Edges with a gradient above this multiple of the mean gradient are preserved.")
                 .greater_than(0.0))
      .example(R"({"id": "calm", "do": "edge_preserving", "scan": "ct", "iterations": 5})")
      .on_files("edge_preserving=ITERATIONS,CONDUCTANCE")
      .scan(made);
}

}  // namespace octotomy::planner
