// SPDX-License-Identifier: AGPL-3.0-or-later
// The scan without solid parts that are not the patient.
#include <cmath>

#include "planner/table/json.h"
#include "planner/table/number_format.h"
#include "planner/table/operation.h"
#include "voxel/filter/headrest.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

struct RemoveHeadrest {
  ScanName scan;
  double threshold = voxel::HeadrestOptions{}.threshold;
  double near_mm = voxel::HeadrestOptions{}.near_mm;
  std::optional<double> detach_mm, board_mm;
  std::vector<glm::dvec3> keep_mm;
};

MadeScan made(const RemoveHeadrest& step, const ScanBench& bench) {
  voxel::HeadrestOptions options;
  options.patient.threshold = step.threshold;
  options.patient.near_mm = step.near_mm;
  if (step.detach_mm) options.patient.detach_mm = *step.detach_mm;
  if (step.board_mm) options.patient.board_mm = *step.board_mm;
  options.patient.keep_mm = step.keep_mm;
  options.patient.progress = bench.progress;
  voxel::HeadrestRemoval removal = voxel::remove_headrest(bench.samples(step.scan.name), options);
  MadeScan made{std::move(removal.scene),
                {{"threshold", options.patient.threshold},
                 {"near_mm", options.patient.near_mm},
                 {"detach_mm", options.patient.detach_mm},
                 {"board_mm", options.patient.board_mm},
                 {"parts_removed", removal.parts},
                 {"volume_removed_mm3", removal.solid_mm3},
                 {"foam_removed_mm3", removal.foam_mm3},
                 {"dense_removed_mm3", removal.bone_mm3},
                 {"samples_removed", removal.voxels},
                 {"coronal_middle_mm", removal.middle_y_mm},
                 {"kept_front_mm3", removal.front_mm3},
                 {"kept_front_extruded_mm3", removal.extruded_front_mm3},
                 {"kept_behind_mm3", removal.behind_mm3}},
                std::move(removal.removed)};
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
      .takes(
          field("board_mm", &RemoveHeadrest::board_mm,
                "Takes out a board or couch that runs through the scan, flush with the patient or not, up to "
                "this thickness. Default: none is sought.")
              .greater_than(0.0))
      .takes(field("keep_mm", &RemoveHeadrest::keep_mm, "Points of parts that stay, LPS."))
      .example(R"({"id": "head", "do": "remove_headrest", "scan": "ct"})")
      .on_files("remove_headrest=THRESHOLD,NEAR,DETACH,BOARD (needs --removed)")
      .scan(made);
}

}  // namespace octotomy::planner
