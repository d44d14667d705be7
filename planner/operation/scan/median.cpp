// SPDX-License-Identifier: AGPL-3.0-or-later
// Each sample replaced by the median of the samples around it.
#include "planner/operation/scan/of_axes.h"
#include "planner/operation/table/operation.h"
#include "voxel/filter/smooth.h"

namespace octotomy::planner {
namespace {

struct Median {
  ScanName scan;
  std::vector<int> radius_samples;
};

void check(const Median& step, const FieldLocation& place) {
  check_axes(step.radius_samples, place.at("radius_samples"));
}

MadeScan made(const Median& step, const ScanBench& bench) {
  const glm::ivec3 radius = of_axes(step.radius_samples);
  return {voxel::median(bench.samples(step.scan.name), radius, bench.progress),
          {{"radius_samples", {radius.x, radius.y, radius.z}}}};
}

}  // namespace

Operation median_operation() {
  return Describe<Median>("median", "Replaces each sample by the median of the samples around it.",
                          Makes::Scan)
      .takes(field("scan", &Median::scan, "The scan.").required())
      .takes(field("radius_samples", &Median::radius_samples,
                   "Number of samples on each side that are included: one number, or one for each axis.")
                 .required()
                 .from(1)
                 .to(3))
      .example(R"({"id": "calm", "do": "median", "scan": "ct", "radius_samples": [1]})")
      .on_files("median=R or RX,RY,RZ (samples)")
      .check(check)
      .scan(made);
}

}  // namespace octotomy::planner
