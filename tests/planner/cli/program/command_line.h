// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <fstream>
#include <gtest/gtest.h>
#include <string>

#include "planner/operation/table/json.h"
#include "tests/planner/ball_scan.h"
#include "tests/run_command.h"

namespace octotomy::tests {

using planner::Json;
using planner::SortedJson;

/// The program in a folder of the test's own, with a ball's scan and plan in it.
class CommandLine : public testing::Test {
 protected:
  CommandLine() {
    voxel::write_scene(ball_scene(12.0, 32), folder_ / "ball.nrrd");
    write("ball.plan.json",
          R"({ "octotomy_plan": 1, "name": "ball", "scans": { "ct": { "path": "ball.nrrd" } },
      "steps": [ { "id": "ball", "do": "window", "scan": "ct", "low": 0 },
                 { "id": "size", "do": "measure", "object": "ball" },
                 { "id": "mesh", "do": "export", "object": "ball", "path": "ball.stl" } ] })");
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  std::string at(const std::string& name) const { return "'" + (folder_ / name).string() + "'"; }

  CommandAnswer run(const std::string& arguments) const {
    return run_command(std::string(OCTOTOMY_BINARY_DIR) + "/octotomy " + arguments, folder_ / "");
  }
  /// Exactly one line that says octotomy, and nothing on standard output.
  void expect_refused(const CommandAnswer& answer, const std::string& word) const {
    EXPECT_EQ(answer.status, 2) << answer.errors;
    EXPECT_EQ(answer.out, "");
    EXPECT_EQ(answer.errors.rfind("octotomy: ", 0), 0u) << answer.errors;
    EXPECT_EQ(std::count(answer.errors.begin(), answer.errors.end(), '\n'), 1) << answer.errors;
    EXPECT_NE(answer.errors.find(word), std::string::npos) << answer.errors;
  }

  ScratchFolder folder_;
};

}  // namespace octotomy::tests
