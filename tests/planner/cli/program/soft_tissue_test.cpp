// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The soft-tissue example that stands beside the first: from the phantom's head to the skin that a solver
// moved.
#include "tests/planner/cli/program/command_line.h"
#include "tests/reference_data.h"

namespace octotomy::planner {
namespace {

using tests::CommandAnswer;
using tests::SortedJson;

class SoftTissue : public tests::CommandLine {};

TEST_F(SoftTissue, OfTheExamplePlanIsSolvedAndMovesTheSkinAsFarAsThePieceAtMost) {
  OCTOTOMY_NEEDS_PROGRAM("ccx", "calculix-ccx");
  ASSERT_EQ(run("phantom head -o " + at("head.nrrd")).status, 0);
  const CommandAnswer planned =
      run("run " + tests::quoted(OCTOTOMY_SOURCE_DIR "/planner/soft_tissue.plan.json") +
          " --scan ct=" + at("head.nrrd") + " --certify never -o " + at("report"));
  ASSERT_EQ(planned.status, 0) << planned.errors;
  ASSERT_EQ(tests::run_command("cd " + at("report") + " && ccx -i face", folder_ / "").status, 0);
  const CommandAnswer warped = run("warp " + at("report/skin.stl") + " --result " + at("report/face.frd") +
                                   " -o " + at("predicted.stl") + " --json");
  ASSERT_EQ(warped.status, 0) << warped.errors;
  // The piece goes 4.12 mm; tissue that it presses aside may go little more.
  const double largest_mm = SortedJson::parse(warped.out)["largest_displacement_mm"];
  EXPECT_GT(largest_mm, 3.0);
  EXPECT_LT(largest_mm, 4.5);
}

}  // namespace
}  // namespace octotomy::planner
