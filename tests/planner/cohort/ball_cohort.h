// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>
#include <string>

#include "planner/cohort/participant.h"
#include "tests/planner/ball_scan.h"

namespace octotomy::tests {

/// Subjects with the scan of a ball, and a plan that measures it.
class BallCohort : public testing::Test {
 protected:
  BallCohort() { voxel::write_scene(ball_scene(8.0, 24), folder_ / "ball.nrrd"); }

  planner::Subject subject(const std::string& label) const {
    return {label, {{"ct", folder_ / "ball.nrrd"}}};
  }
  planner::SubjectRecord run(const planner::Subject& subject, bool again = false) const {
    planner::ParticipantOptions options;
    options.again = again;
    return planner::run_participant(plan_, subject, out_, options);
  }

  ScratchFolder folder_;
  std::filesystem::path out_ = folder_ / "out";
  planner::Plan plan_ = planner::parse_plan(
      R"({"octotomy_plan": 1, "name": "ball", "scans": {"ct": {"path": "ball.nrrd"}},
          "steps": [{"id": "ball", "do": "window", "scan": "ct", "low": 0},
                    {"id": "size", "do": "measure", "object": "ball"}]})",
      folder_.path());
};

}  // namespace octotomy::tests
