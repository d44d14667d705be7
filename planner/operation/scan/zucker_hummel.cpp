// SPDX-License-Identifier: AGPL-3.0-or-later
// The strength of edges.
#include "planner/operation/table/operation.h"
#include "voxel/filter/edge_operator.h"

namespace octotomy::planner {
namespace {

struct ZuckerHummel {
  ScanName scan;
};

MadeScan made(const ZuckerHummel& step, const ScanBench& bench) {
  return {voxel::zucker_hummel(bench.samples(step.scan.name), bench.progress), {{"unit", "samples / mm"}}};
}

}  // namespace

Operation zucker_hummel_operation() {
  return Describe<ZuckerHummel>("zucker_hummel",
                                "Makes a scan of the strength of edges by Zucker and Hummel's operator.",
                                Makes::Scan)
      .takes(field("scan", &ZuckerHummel::scan, "The scan.").required())
      .example(R"({"id": "edges", "do": "zucker_hummel", "scan": "ct"})")
      .on_files("zucker_hummel")
      .scan(made);
}

}  // namespace octotomy::planner
