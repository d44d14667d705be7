// SPDX-License-Identifier: AGPL-3.0-or-later
// The scan without solid parts that are not the patient.
#include <cmath>

#include "planner/table/json.h"
#include "planner/table/number_format.h"
#include "planner/table/operation.h"
#include "voxel/filter/board.h"
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

/// A board or a cradle is larger than this; less that hangs on the head is an ear or a strap's buckle.
constexpr double least_support_mm3 = 1000.0;

/// What still hangs on the patient by thin links and reaches away from it: its volume, and the radius that
/// cuts it off. Nothing if no radius up to 10 mm does.
std::optional<std::pair<double, double>> remains_of(const voxel::Scene& scene,
                                                    voxel::HeadrestOptions options) {
  const double cut_mm = options.detach_mm.value_or(0.0);
  options.progress.report = {};
  for (const double radius_mm : {3.0, 6.0, 10.0}) {
    if (radius_mm <= cut_mm) continue;
    options.detach_mm = radius_mm;
    try {
      const double found_mm3 = voxel::remove_headrest(scene, options).solid_mm3;
      if (found_mm3 >= least_support_mm3) return std::pair{found_mm3, radius_mm};
    } catch (const voxel::Error& error) {
      if (error.code() != voxel::ErrorCode::Geometry) throw;
      return std::nullopt;  // the patient is thinner than the ball
    }
  }
  return std::nullopt;
}

MadeScan made(const RemoveHeadrest& step, const ScanBench& bench) {
  voxel::HeadrestOptions options;
  options.threshold = step.threshold;
  options.near_mm = step.near_mm;
  options.detach_mm = step.detach_mm;
  options.board_mm = step.board_mm;
  options.keep_mm = step.keep_mm;
  options.progress = bench.progress;
  voxel::HeadrestRemoval removal = voxel::remove_headrest(bench.samples(step.scan.name), options);
  MadeScan made{std::move(removal.scene),
                {{"threshold", options.threshold},
                 {"near_mm", options.near_mm},
                 {"detach_mm", options.detach_mm ? Json(*options.detach_mm) : Json(nullptr)},
                 {"board_mm", options.board_mm ? Json(*options.board_mm) : Json(nullptr)},
                 {"parts_removed", removal.parts},
                 {"volume_removed_mm3", removal.solid_mm3},
                 {"samples_removed", removal.voxels}},
                std::move(removal.removed)};
  const std::optional<voxel::Board> board = voxel::board_of(made.scene, {options.threshold});
  const bool has_board = board && board->volume_mm3 >= least_support_mm3;
  made.details["board_remains_mm3"] = has_board ? Json(board->volume_mm3) : Json(nullptr);
  if (has_board)
    made.findings.push_back("a board of about " + plain(std::round(board->volume_mm3 / 100.0) / 10.0) +
                            " cm\u00b3, " + plain(std::round(board->wide_mm)) + " mm wide and about " +
                            plain(std::round(board->thick_mm)) +
                            " mm thick, runs through the scan behind the patient and remains: "
                            "remove_headrest=" +
                            plain(options.threshold) + "," + plain(options.near_mm) + "," +
                            plain(options.detach_mm.value_or(0.0)) + "," +
                            plain(voxel::BoardOptions{}.thick_mm) + " takes it out");
  const auto remains = remains_of(made.scene, options);
  made.details["remains_mm3"] = remains ? Json(remains->first) : Json(nullptr);
  if (remains) {
    const std::string radius = plain(remains->second);
    made.findings.push_back("about " + plain(std::round(remains->first / 100.0) / 10.0) +
                            " cm\u00b3 hang on the patient by links thinner than a ball of " + radius +
                            " mm and reach farther than " + plain(options.near_mm) +
                            " mm: look whether it is a support; remove_headrest=" + plain(options.threshold) +
                            "," + plain(options.near_mm) + "," + radius + " takes it out");
  } else if (removal.parts == 0 && !has_board) {
    made.findings.emplace_back(
        "nothing was removed: the patient is the only solid part, and no ball of up to 10 mm cuts anything "
        "off; take out a support that lies closely against the head by a crop step or a mask");
  }
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
