// SPDX-License-Identifier: AGPL-3.0-or-later
// The Laplacian of samples smoothed by a Gaussian; edges are its zeros.
#include "planner/operation/table/operation.h"
#include "voxel/filter/edge_operator.h"

namespace octotomy::planner {
namespace {

struct MarrHildreth {
  ScanName scan;
  double sigma_mm = 1.0;
};

MadeScan made(const MarrHildreth& step, const ScanBench& bench) {
  return {voxel::marr_hildreth(bench.samples(step.scan.name), step.sigma_mm, bench.progress),
          {{"sigma_mm", step.sigma_mm}, {"unit", "samples / mm\u00b2"}}};
}

}  // namespace

Operation marr_hildreth_operation() {
  return Describe<MarrHildreth>("marr_hildreth",
                                "Makes a scan that is zero at edges, by Marr and Hildreth's operator.",
                                Makes::Scan)
      .takes(field("scan", &MarrHildreth::scan, "The scan.").required())
      .takes(field("sigma_mm", &MarrHildreth::sigma_mm, "Standard deviation of the Gaussian.")
                 .required()
                 .greater_than(0.0))
      .example(R"({"id": "edges", "do": "marr_hildreth", "scan": "ct", "sigma_mm": 1.5})")
      .on_files("marr_hildreth=SIGMA (mm)")
      .scan(made);
}

}  // namespace octotomy::planner
