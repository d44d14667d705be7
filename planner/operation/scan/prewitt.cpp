// SPDX-License-Identifier: AGPL-3.0-or-later
// The strength of edges. By Prewitt's operator in three dimensions: the plane of least squares.
#include "planner/operation/table/operation.h"
#include "voxel/filter/edge_operator.h"

namespace octotomy::planner {
namespace {

struct Prewitt {
  ScanName scan;
};

MadeScan made(const Prewitt& step, const ScanBench& bench) {
  return {voxel::prewitt(bench.samples(step.scan.name), bench.progress), {{"unit", "samples / mm"}}};
}

}  // namespace

Operation prewitt_operation() {
  return Describe<Prewitt>(
             "prewitt",
             "Makes a scan of the strength of edges by Prewitt's operator, which fits a plane to 27 samples.",
             Makes::Scan)
      .takes(field("scan", &Prewitt::scan, "The scan.").required())
      .example(R"({"id": "edges", "do": "prewitt", "scan": "ct"})")
      .on_files("prewitt")
      .scan(made);
}

}  // namespace octotomy::planner
