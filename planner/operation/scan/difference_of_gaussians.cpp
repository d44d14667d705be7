// SPDX-License-Identifier: AGPL-3.0-or-later
// Two Gaussians of a scan, subtracted; edges are the zeros.
#include "planner/operation/table/operation.h"
#include "voxel/filter/edge_operator.h"

namespace octotomy::planner {
namespace {

struct DifferenceOfGaussians {
  ScanName scan;
  double sigma_mm = 1.0;
  double ratio = 1.6;
};

MadeScan made(const DifferenceOfGaussians& step, const ScanBench& bench) {
  return {voxel::difference_of_gaussians(bench.samples(step.scan.name), step.sigma_mm, step.ratio,
                                         bench.progress),
          {{"sigma_mm", step.sigma_mm}, {"ratio", step.ratio}, {"unit", "samples / mm\u00b2"}}};
}

}  // namespace

Operation difference_of_gaussians_operation() {
  return Describe<DifferenceOfGaussians>("difference_of_gaussians",
                                         "Makes a scan that is zero at edges, by the difference of two "
                                         "Gaussians. It is scaled to approximate marr_hildreth.",
                                         Makes::Scan)
      .takes(field("scan", &DifferenceOfGaussians::scan, "The scan.").required())
      .takes(
          field("sigma_mm", &DifferenceOfGaussians::sigma_mm, "Standard deviation of the narrower Gaussian.")
              .required()
              .greater_than(0.0))
      .takes(field("ratio", &DifferenceOfGaussians::ratio,
                   "Standard deviation of the wider Gaussian, as a multiple of the narrower one's.")
                 .greater_than(1.0)
                 .to(100.0))
      .example(R"({"id": "edges", "do": "difference_of_gaussians", "scan": "ct", "sigma_mm": 1.5})")
      .on_files("difference_of_gaussians=SIGMA,RATIO (mm)")
      .scan(made);
}

}  // namespace octotomy::planner
