// SPDX-License-Identifier: AGPL-3.0-or-later
// The strength of edges. By Roberts's operator in three dimensions: differences along the diagonals of cells.
#include "planner/operation/table/operation.h"
#include "voxel/filter/edge_operator.h"

namespace octotomy::planner {
namespace {

struct Roberts {
  ScanName scan;
};

MadeScan made(const Roberts& step, const ScanBench& bench) {
  return {voxel::roberts(bench.samples(step.scan.name), bench.progress), {{"unit", "samples / mm"}}};
}

}  // namespace

Operation roberts_operation() {
  return Describe<Roberts>("roberts",
                           "Makes a scan of the strength of edges by Roberts's operator, which is the "
                           "sharpest. The new samples lie between the scan's samples.",
                           Makes::Scan)
      .takes(field("scan", &Roberts::scan, "The scan.").required())
      .example(R"({"id": "edges", "do": "roberts", "scan": "ct"})")
      .on_files("roberts")
      .scan(made);
}

}  // namespace octotomy::planner
