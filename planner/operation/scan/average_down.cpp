// SPDX-License-Identifier: AGPL-3.0-or-later
// Fewer samples, each the mean of several.
#include "planner/operation/scan/of_axes.h"
#include "planner/operation/table/operation.h"
#include "voxel/filter/crop.h"

namespace octotomy::planner {
namespace {

struct AverageDown {
  ScanName scan;
  std::vector<int> factor;
};

void check(const AverageDown& step, const FieldLocation& place) {
  check_axes(step.factor, place.at("factor"));
}

MadeScan made(const AverageDown& step, const ScanBench& bench) {
  const glm::ivec3 factor = of_axes(step.factor);
  return {voxel::average_down(bench.samples(step.scan.name), factor, bench.progress),
          {{"factor", {factor.x, factor.y, factor.z}}}};
}

}  // namespace

Operation average_down_operation() {
  return Describe<AverageDown>("average_down",
                               "Reduces the number of samples: each new sample is the mean of several.",
                               Makes::Scan)
      .takes(field("scan", &AverageDown::scan, "The scan.").required())
      .takes(field("factor", &AverageDown::factor,
                   "Number of samples along an axis that become one: one number, or one for each axis.")
                 .required()
                 .from(1)
                 .to(3))
      .example(R"({"id": "coarse", "do": "average_down", "scan": "ct", "factor": [2, 2, 1]})")
      .on_files("average_down=N or NX,NY,NZ")
      .check(check)
      .scan(made);
}

}  // namespace octotomy::planner
