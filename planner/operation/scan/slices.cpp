// SPDX-License-Identifier: AGPL-3.0-or-later
// Slices at a requested distance, interpolated between those of the scan.
#include <map>

#include "planner/operation/table/operation.h"
#include "voxel/filter/resample_slices.h"

namespace octotomy::planner {
namespace {

struct Slices {
  ScanName scan;
  double spacing_mm = 1.0;
  std::optional<std::string> kernel;
};

MadeScan made(const Slices& step, const ScanBench& bench) {
  static const std::map<std::string, voxel::SliceKernel> kernels{{"nearest", voxel::SliceKernel::Nearest},
                                                                 {"linear", voxel::SliceKernel::Linear},
                                                                 {"cubic", voxel::SliceKernel::Cubic},
                                                                 {"lanczos", voxel::SliceKernel::Lanczos}};
  const voxel::Scene& scene = bench.samples(step.scan.name);
  const std::string kernel =
      step.kernel.value_or(scene.meaning == voxel::Meaning::Label ? "nearest" : "linear");
  return {voxel::resample_slices(scene, step.spacing_mm, kernels.at(kernel), bench.progress),
          {{"spacing_mm", step.spacing_mm}, {"kernel", kernel}}};
}

}  // namespace

Operation slices_operation() {
  return Describe<Slices>("slices", "Resamples a scan to slices at another distance.", Makes::Scan)
      .takes(field("scan", &Slices::scan, "The scan.").required())
      .takes(field("spacing_mm", &Slices::spacing_mm, "Distance between the new slices.")
                 .required()
                 .greater_than(0.0))
      .takes(field("kernel", &Slices::kernel,
                   "The kernel that interpolates between slices. Default: linear; for label maps, nearest.")
                 .one_of({"nearest", "linear", "cubic", "lanczos"}))
      .example(R"({"id": "even", "do": "slices", "scan": "ct", "spacing_mm": 1, "kernel": "cubic"})")
      .on_files("slices=MM,KERNEL (nearest, linear, cubic, lanczos)")
      .scan(made);
}

}  // namespace octotomy::planner
