// SPDX-License-Identifier: AGPL-3.0-or-later
// The effect of errors on the numbers of a plan. The numbers belong to the whole plan, so
// planner/plan/trial.h runs the trials; this operation only holds their parameters.
#include "planner/operation/measure/trials.h"

#include "planner/operation/measure/measured_trials.h"
#include "planner/operation/table/operation.h"

namespace octotomy::planner {
namespace {

nlohmann::ordered_json measure(const Trials& asked, const AnswerBench&) {
  return {{"trials", asked.trials}, {"seed", asked.seed}, {"errors", print_record(asked)}};
}

}  // namespace

Operation trials_operation() {
  return Describe<Trials>("trials",
                          "Repeats the plan with random errors of landmarks, saw, segmentation and seating, "
                          "and reports the effect on displacements, gaps, overlaps, distances and angles.",
                          Makes::Measurement)
      .takes(field("landmark_mm", &Trials::landmark_mm,
                   "Standard deviation of a landmark's placement along each axis.")
                 .from(0.0)
                 .to(20.0))
      .takes(field("kerf_mm", &Trials::kerf_mm, "Standard deviation of the width of saw cuts.")
                 .from(0.0)
                 .to(5.0))
      .takes(field("segmentation_mm", &Trials::segmentation_mm,
                   "Standard deviation of the bone's border: in a trial it is displaced outward by the same "
                   "distance everywhere.")
                 .from(0.0)
                 .to(5.0))
      .takes(field("seating_mm", &Trials::seating_mm,
                   "Standard deviation of a moved piece's position along each axis.")
                 .from(0.0)
                 .to(20.0))
      .takes(field("seating_deg", &Trials::seating_deg,
                   "Standard deviation of a moved piece's rotation about each axis through its centroid.")
                 .from(0.0)
                 .to(30.0))
      .takes(field("trials", &Trials::trials, "Number of trials.").from(100).to(1000000))
      .takes(field("seed", &Trials::seed, "Seed of the random errors: the same seed gives the same numbers.")
                 .from(0)
                 .to(1e9))
      .example(R"({"id": "doubt", "do": "trials", "seating_mm": 0.5, "trials": 10000})")
      .measure(measure);
}

}  // namespace octotomy::planner
