// SPDX-License-Identifier: AGPL-3.0-or-later
// The scan without solid parts that are not the patient.
#include "planner/table/operation.h"
#include "voxel/filter/headrest.h"

namespace octotomy::planner {
namespace {

using Json = nlohmann::ordered_json;

struct RemoveHeadrest {
  ScanName scan;
  double threshold = voxel::HeadrestOptions{}.threshold;
  double near_mm = voxel::HeadrestOptions{}.near_mm;
  std::optional<double> detach_mm;
  std::vector<glm::dvec3> keep_mm;
};

MadeScan made(const RemoveHeadrest& step, const ScanBench& bench) {
  voxel::HeadrestOptions options;
  options.threshold = step.threshold;
  options.near_mm = step.near_mm;
  options.detach_mm = step.detach_mm;
  options.keep_mm = step.keep_mm;
  options.progress = bench.progress;
  voxel::HeadrestRemoval removal = voxel::remove_headrest(bench.samples(step.scan.name), options);
  MadeScan made{std::move(removal.scene),
                {{"threshold", options.threshold},
                 {"near_mm", options.near_mm},
                 {"detach_mm", options.detach_mm ? Json(*options.detach_mm) : Json(nullptr)},
                 {"parts_removed", removal.parts},
                 {"volume_removed_mm3", removal.solid_mm3},
                 {"samples_removed", removal.voxels}},
                std::move(removal.removed)};
  if (removal.parts == 0)
    made.findings.emplace_back(
        "nothing was removed: the patient is the only solid part; where the headrest touches the patient, "
        "cut it off with remove_headrest=-300,25,3");
  return made;
}

}  // namespace

Operation remove_headrest_operation() {
  return Describe<RemoveHeadrest>("remove_headrest",
                                  "Takes solid parts out of a scan that are not the patient.", Makes::Scan)
      .takes(field("scan", &RemoveHeadrest::scan, "The scan.").required())
      .takes(field("threshold", &RemoveHeadrest::threshold,
                   "Samples from here on are solid, in the scan's unit."))
      .takes(field("near_mm", &RemoveHeadrest::near_mm,
                   "Parts wholly within this distance of the patient stay."))
      .takes(field("detach_mm", &RemoveHeadrest::detach_mm,
                   "Links thinner than a ball of this radius are cut. Default: none is."))
      .takes(field("keep_mm", &RemoveHeadrest::keep_mm, "Points of parts that stay, LPS."))
      .example(R"({"id": "head", "do": "remove_headrest", "scan": "ct"})")
      .on_files("remove_headrest=THRESHOLD,NEAR,DETACH (needs --removed)")
      .scan(made);
}

}  // namespace octotomy::planner
