// SPDX-License-Identifier: AGPL-3.0-or-later
// Samples smoothed by a Gaussian.
#include "planner/operation/table/operation.h"
#include "voxel/filter/smooth.h"

namespace octotomy::planner {
namespace {

struct Gaussian {
  ScanName scan;
  double sigma_mm = 1.0;
};

MadeScan made(const Gaussian& step, const ScanBench& bench) {
  return {voxel::gaussian(bench.samples(step.scan.name), step.sigma_mm, bench.progress),
          {{"sigma_mm", step.sigma_mm}}};
}

}  // namespace

Operation gaussian_operation() {
  return Describe<Gaussian>("gaussian", "Smooths a scan by a Gaussian.", Makes::Scan)
      .takes(field("scan", &Gaussian::scan, "The scan.").required())
      .takes(field("sigma_mm", &Gaussian::sigma_mm, "Standard deviation of the Gaussian.")
                 .required()
                 .greater_than(0.0))
      .example(R"({"id": "soft_ct", "do": "gaussian", "scan": "ct", "sigma_mm": 0.8})")
      .on_files("gaussian=SIGMA (mm)")
      .scan(made);
}

}  // namespace octotomy::planner
