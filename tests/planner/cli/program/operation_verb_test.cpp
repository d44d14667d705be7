// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The verbs that derive from the table of operations, with both kernels' answers and their certificate.
#include "tests/planner/cli/program/command_line.h"

namespace octotomy::planner {
namespace {

using tests::CommandAnswer;
using tests::SortedJson;

class OperationVerbs : public tests::CommandLine {
 protected:
  OperationVerbs() {
    EXPECT_EQ(run("mesh " + at("ball.nrrd") + " --window 0: -o " + at("ball.off")).status, 0);
    EXPECT_EQ(run("octree " + at("ball.nrrd") + " --window 0: -o " + at("ball.octree")).status, 0);
  }

  double volume_mm3(const std::string& command) {
    const CommandAnswer answer = run(command + " --json");
    EXPECT_EQ(answer.status, 0) << command << answer.errors;
    return SortedJson::parse(answer.out).at("volume_mm3");
  }
};

TEST_F(OperationVerbs, EveryKernelAnswersOnFilesAndNoCertificateFails) {
  for (const std::string verb :
       {"saw ball.off --line -40,-40,0 40,-40,0 --direction 0,1,0 --depth 80 --kerf 2",
        "parts ball.off --largest 1", "fill ball.off", "offset ball.off --by 2",
        "shell ball.off --thickness 3"}) {
    const std::string name = verb.substr(0, verb.find(' '));
    for (const char* out : {"out.ply", "out.octree"}) {
      const std::string command = name + " " + at("ball.off") + verb.substr(verb.find(".off") + 4) +
                                  " --voxel 0.5 --certify -o " + at(out);
      const CommandAnswer answer = run(command + " --json");
      ASSERT_EQ(answer.status, 0) << command << answer.errors;
      const SortedJson certificate = SortedJson::parse(answer.out).at("certificate");
      // Voxels centred on a ball count it worse than the bound's ball in any place: a WARN is no FAIL.
      EXPECT_NE(certificate["verdict"], "FAIL") << command << certificate.dump(1);
      EXPECT_EQ(certificate["tier"], "bounded");
      const double mm3 = certificate["voxel"]["volume_mm3"];
      EXPECT_GT(mm3, 100.0);
      // The blade's sides go through voxel centres, whose sides rounding decides triangle by triangle.
      EXPECT_LT(certificate["tolerance_mm3"], 0.1 * mm3) << command;
      EXPECT_TRUE(std::filesystem::exists(folder_ / out)) << command;
    }
  }
}

TEST_F(OperationVerbs, WhatTheMeshKernelAloneMakesIsVoxelised) {
  const double ball = volume_mm3("measure " + at("ball.off"));
  const double even = volume_mm3("smooth " + at("ball.off") + " --rounds 5 -o " + at("even.ply"));
  EXPECT_NEAR(even, ball, 0.02 * ball);
  EXPECT_NEAR(volume_mm3("smooth " + at("ball.off") + " --rounds 5 --voxel 0.5 -o " + at("even.octree")),
              even, 0.01 * even);
  const CommandAnswer told =
      run("smooth " + at("ball.off") + " --rounds 5 -o " + at("even.octree") + " --json");
  EXPECT_NE(
      SortedJson::parse(told.out).at("findings").dump().find("only the mesh kernel computes this object"),
      std::string::npos)
      << told.out;
  expect_refused(run("smooth " + at("ball.octree") + " -o " + at("x.octree")), "octotomy mesh");
}

TEST_F(OperationVerbs, EachKernelOffsetsItsOwnOperand) {
  const double ball = volume_mm3("measure " + at("ball.off"));
  const double margin = volume_mm3("offset " + at("ball.off") + " --by 3 -o " + at("margin.ply"));
  ASSERT_GT(margin, 1.2 * ball);
  // Of whole voxels an offset takes those that stick out farthest, by up to a quarter of a millimetre here.
  EXPECT_NEAR(volume_mm3("offset " + at("ball.off") + " --by 3 --voxel 0.5 -o " + at("margin.octree")),
              margin, 0.04 * margin);
  EXPECT_EQ(run("offset " + at("ball.octree") + " --by 3 -o " + at("x.octree")).status, 0);
  expect_refused(run("offset " + at("ball.octree") + " --by 3 -o " + at("x.ply")), "octotomy mesh");
}

TEST_F(OperationVerbs, WhatOneKernelAloneDoesIsSaid) {
  for (const std::string verb : {"smooth", "decimate"})
    expect_refused(run(verb + " " + at("ball.off") + " --certify -o " + at("x.ply")),
                   "only by the mesh kernel");
  expect_refused(run("fill " + at("ball.octree") + " -o " + at("x.ply")), "octotomy mesh");
  EXPECT_EQ(run("fill " + at("ball.octree") + " -o " + at("full.octree")).status, 0);
}

TEST_F(OperationVerbs, ARefusalNamesTheOption) {
  expect_refused(run("mirror " + at("ball.off") + " --exactly"), "--plane");
  expect_refused(run("decimate " + at("ball.off") + " --max-error -1 -o " + at("x.ply")), "--max-error");
  expect_refused(run("repair " + at("ball.off") + " -o " + at("x.ply")), "--weld");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x.ply"));
}

}  // namespace
}  // namespace octotomy::planner
