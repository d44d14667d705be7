// SPDX-License-Identifier: AGPL-3.0-or-later
// The scan without boards, couches, foam and holders. What is in front of the patient's coronal middle stays.
#include <cmath>

#include "planner/operation/table/json.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/filter/headrest.h"

namespace octotomy::planner {
namespace {

struct RemoveHeadrest {
  ScanName scan;
  double threshold = voxel::PatientOptions{}.threshold;
  double near_mm = voxel::PatientOptions{}.near_mm;
  std::optional<double> detach_mm, board_mm;
  std::vector<glm::dvec3> keep_mm;
};

/// Smaller parts that are kept are not reported, because they are a strap's buckle, a wire or noise.
constexpr double least_kept_mm3 = 1000.0;

/// Adds findings on the removed parts, and on kept parts that may be a support. They recommend no value of a
/// field, because no value must cut off a part that could not be separated reliably.
std::vector<std::string> findings_of(const voxel::HeadrestRemoval& removal) {
  const auto cm3 = [](double mm3) { return plain(std::round(mm3 / 100.0) / 10.0) + " cm\u00b3"; };
  std::vector<std::string> findings;
  if (removal.voxels == 0)
    findings.emplace_back(
        "nothing was removed, because no board, foam or holder was found behind the patient's coronal "
        "middle: remove a support that touches the head by a crop step or a mask");
  if (removal.bone_mm3 >= least_kept_mm3)
    findings.push_back("of the " + cm3(removal.solid_mm3 + removal.foam_mm3) + " removed, " +
                       cm3(removal.bone_mm3) + " are as dense as bone (" + plain(voxel::dense_hu) +
                       " and more): check the picture of the removed parts");
  if (removal.front_mm3 >= least_kept_mm3)
    findings.push_back(
        cm3(removal.front_mm3) + " beside the patient lie in front of its coronal middle (y = " +
        plain(std::round(removal.middle_y_mm)) + " mm) and were kept, " + cm3(removal.extruded_front_mm3) +
        " of them part of a board or cradle: check whether the patient lies face down or on the side, or the "
        "scan's frame is rotated");
  if (removal.behind_mm3 >= least_kept_mm3)
    findings.push_back(cm3(removal.behind_mm3) +
                       " behind the patient's coronal middle may be a support, but were kept, because they "
                       "cannot be separated reliably: remove them by a crop step or a mask");
  return findings;
}

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
  made.findings = findings_of(removal);
  return made;
}

}  // namespace

Operation remove_headrest_operation() {
  return Describe<RemoveHeadrest>("remove_headrest",
                                  "Removes boards, couches, foam and holders behind the patient from a scan.",
                                  Makes::Scan)
      .takes(field("scan", &RemoveHeadrest::scan, "The scan.").required())
      .takes(field("threshold", &RemoveHeadrest::threshold,
                   "Samples of at least this value are solid, in the scan's unit."))
      .takes(field("near_mm", &RemoveHeadrest::near_mm,
                   "Parts that lie wholly within this distance of the patient are kept, unless they are foam "
                   "or part of a board."))
      .takes(field(
          "detach_mm", &RemoveHeadrest::detach_mm,
          "Connections behind the patient that are thinner than a ball of this radius are cut. Default: 6."))
      .takes(field("board_mm", &RemoveHeadrest::board_mm,
                   "The largest thickness of a solid board. A couch with air around it may be twice as "
                   "thick. Default: 40.")
                 .greater_than(0.0))
      .takes(field("keep_mm", &RemoveHeadrest::keep_mm, "Points of parts that are kept, LPS mm."))
      .example(R"({"id": "head", "do": "remove_headrest", "scan": "ct"})")
      .on_files("remove_headrest=THRESHOLD,NEAR,DETACH,BOARD (needs --removed)")
      .scan(made);
}

}  // namespace octotomy::planner
