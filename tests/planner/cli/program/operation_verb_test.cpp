// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The verbs that derive from the table of operations, with both kernels' answers and their certificate.
#include "brep/io/write_mesh.h"
#include "tests/brep/shapes.h"
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
      // Voxels centred on a ball count it worse than the bound, which holds for a ball in any position. A
      // WARN is no FAIL.
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

TEST_F(OperationVerbs, ABooleanIsASurfaceOrVoxelsWithTheCertificateOfBoth) {
  brep::write_mesh(brep::shapes::box({0, -20, -20}, {20, 20, 20}), folder_ / "half.off");
  const double whole = volume_mm3("measure " + at("ball.off"));
  for (const char* out : {"rest.ply", "rest.octree"}) {
    const CommandAnswer answer = run("boolean " + at("ball.off") + " difference " + at("half.off") +
                                     " --voxel 0.5 --certify --json -o " + at(out));
    ASSERT_EQ(answer.status, 0) << out << answer.errors;
    const SortedJson certificate = SortedJson::parse(answer.out).at("certificate");
    EXPECT_NE(certificate["verdict"], "FAIL") << out << certificate.dump(1);
    for (const char* kernel : {"voxel", "mesh"})
      EXPECT_NEAR(certificate[kernel]["volume_mm3"].get<double>(), 0.5 * whole, 0.02 * whole)
          << out << kernel;
  }
}

TEST_F(OperationVerbs, AMapOfAMeshIsThatOfItsTrianglesInBothKernelsAndNotIndependent) {
  // A plate of one voxel at a slant: the nearest voxels of the unmapped plate would lose half of it.
  brep::write_mesh(brep::shapes::box({-60, -60, -0.5}, {60, 60, 0.5}), folder_ / "plate.off");
  for (const char* out : {"mapped.ply", "mapped.octree"}) {
    const CommandAnswer answer = run("affine " + at("plate.off") + " --matrix '[[1.1,0,0,0],[0,0.9,-0.4,0]," +
                                     "[0,0.4,0.9,0],[0,0,0,1]]' --voxel 1 --certify --json -o " + at(out));
    ASSERT_EQ(answer.status, 0) << out << answer.errors;
    const SortedJson certificate = SortedJson::parse(answer.out).at("certificate");
    EXPECT_EQ(certificate["verdict"], "WARN") << certificate.dump(1);
    EXPECT_EQ(certificate["independent"], false);
    EXPECT_NE(certificate["reasons"].dump().find("file: triangles of plate.off"), std::string::npos);
    EXPECT_NEAR(certificate["voxel"]["volume_mm3"].get<double>(),
                certificate["mesh"]["volume_mm3"].get<double>(), 0.05 * 14400.0);
  }
}

/// A box of 7 x 28 x 28 mm and an octree of a ball: mixed operands in either order, in both formats.
TEST_F(OperationVerbs, ABooleanOfAMeshAndAnOctreeIsTheSameInBothKernelsAndNotIndependent) {
  brep::write_mesh(brep::shapes::box({3.2, -14, -14}, {10.2, 14, 14}), folder_ / "slab.off");
  const double ball = volume_mm3("measure " + at("ball.octree"));
  const double cut =
      volume_mm3("boolean " + at("ball.octree") + " intersection " + at("slab.off") + " -o " + at("cut.ply"));
  ASSERT_GT(cut, 0.05 * ball);
  EXPECT_NEAR(
      volume_mm3("boolean " + at("slab.off") + " intersection " + at("ball.octree") + " -o " + at("b.ply")),
      cut, 1e-9 * cut);
  // The boundary of the voxels holds exactly their volume, so that the parts add up.
  EXPECT_NEAR(
      volume_mm3("boolean " + at("ball.octree") + " difference " + at("slab.off") + " -o " + at("r.ply")),
      ball - cut, 1e-6 * ball);
  EXPECT_NEAR(volume_mm3("boolean " + at("slab.off") + " union " + at("ball.octree") + " -o " + at("u.ply")),
              ball + 7.0 * 28.0 * 28.0 - cut, 1e-6 * ball);
  for (const char* out : {"cut.ply", "cut.octree"}) {
    const CommandAnswer answer = run("boolean " + at("ball.octree") + " intersection " + at("slab.off") +
                                     " --certify --json -o " + at(out));
    ASSERT_EQ(answer.status, 0) << out << answer.errors;
    const SortedJson certificate = SortedJson::parse(answer.out).at("certificate");
    EXPECT_EQ(certificate["verdict"], "WARN") << certificate.dump(1);
    const std::string reasons = certificate["reasons"].dump();
    EXPECT_NE(reasons.find("not independent"), std::string::npos) << reasons;
    EXPECT_NE(reasons.find("file: triangles of slab.off; file: voxels of ball.octree"), std::string::npos)
        << reasons;
    EXPECT_NEAR(certificate["mesh"]["volume_mm3"].get<double>(), cut, 1e-9 * cut);
    EXPECT_NEAR(certificate["voxel"]["volume_mm3"].get<double>(), cut, 0.1 * cut);
  }
}

TEST_F(OperationVerbs, AMeshBeyondTheVoxelsOfAnOctreeIsWholeAsAMeshAndSaidToBeCutOffAsVoxels) {
  brep::write_mesh(brep::shapes::box({0, -2, -2}, {500, 2, 2}), folder_ / "long.off");
  const std::string asked = "boolean " + at("ball.octree") + " union " + at("long.off") + " -o ";
  EXPECT_GT(volume_mm3(asked + at("u.ply")), 400.0 * 16.0);
  const CommandAnswer voxels = run(asked + at("u.octree") + " --json");
  EXPECT_EQ(voxels.status, 0);
  EXPECT_NE(SortedJson::parse(voxels.out).at("findings").dump().find("beyond the voxels of the octree"),
            std::string::npos)
      << voxels.out;
  expect_refused(run(asked + at("u.ply") + " --certify"), "leave --certify out");
}

/// Octrees alone have an exact Boolean of voxels, which is no surface.
TEST_F(OperationVerbs, ABooleanOfOctreesAloneIsNoMesh) {
  expect_refused(run("boolean " + at("ball.octree") + " union " + at("ball.octree") + " -o " + at("x.ply")),
                 "octotomy mesh");
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
  // For whole voxels, an offset reaches those that stick out farthest, by up to a quarter of a millimetre
  // here.
  EXPECT_NEAR(volume_mm3("offset " + at("ball.off") + " --by 3 --voxel 0.5 -o " + at("margin.octree")),
              margin, 0.04 * margin);
  EXPECT_EQ(run("offset " + at("ball.octree") + " --by 3 -o " + at("x.octree")).status, 0);
  expect_refused(run("offset " + at("ball.octree") + " --by 3 -o " + at("x.ply")), "octotomy mesh");
}

TEST_F(OperationVerbs, WhatOneKernelAloneDoesIsSaid) {
  for (const std::string verb : {"smooth", "decimate"})
    expect_refused(run(verb + " " + at("ball.off") + " --certify -o " + at("x.ply")), "--certify");
  expect_refused(run("fill " + at("ball.octree") + " -o " + at("x.ply")), "octotomy mesh");
  EXPECT_EQ(run("fill " + at("ball.octree") + " -o " + at("full.octree")).status, 0);
}

TEST_F(OperationVerbs, OfOverlappingAndTouchingShellsTheUnionIsMeasured) {
  using brep::shapes::box;
  const brep::Triangles cube = box({0, 0, 0}, {2, 2, 2});
  brep::write_mesh(brep::shapes::together(cube, box({1, 1, 1}, {3, 3, 3})), folder_ / "over.ply");
  EXPECT_NEAR(volume_mm3("measure " + at("over.ply")), 15.0, 1e-12);
  brep::write_mesh(brep::shapes::together(cube, box({2, 2, 2}, {4, 4, 4})), folder_ / "corner.stl");
  EXPECT_NEAR(volume_mm3("measure " + at("corner.stl")), 16.0, 1e-3);
  brep::write_mesh(brep::shapes::together(cube, box({2, 2, 0}, {4, 4, 2})), folder_ / "edge.stl");
  EXPECT_NEAR(volume_mm3("measure " + at("edge.stl")), 16.0, 1e-3);
}

TEST_F(OperationVerbs, TrianglesThatFaceTheWrongWayAreTurned) {
  brep::Triangles ball = brep::shapes::sphere({0, 0, 0}, 10.0, 4);
  for (auto& face : ball.faces)
    if (ball.points_mm[face[0]].z < 0.0) std::swap(face[1], face[2]);
  brep::write_mesh(ball, folder_ / "half.ply");
  const brep::Triangles whole = brep::shapes::sphere({0, 0, 0}, 10.0, 4);
  brep::write_mesh(whole, folder_ / "whole.ply");
  brep::write_mesh(brep::shapes::inside_out(whole), folder_ / "inside_out.ply");
  EXPECT_EQ(volume_mm3("voxelise " + at("half.ply") + " -o " + at("half.octree")),
            volume_mm3("voxelise " + at("whole.ply") + " -o " + at("whole.octree")));
  const std::string rest = " intersection " + at("ball.off") + " -o " + at("x.ply");
  expect_refused(run("boolean " + at("inside_out.ply") + rest), "--orient");
  EXPECT_NEAR(volume_mm3("boolean " + at("inside_out.ply") + rest + " --orient"),
              volume_mm3("boolean " + at("whole.ply") + rest), 1e-9);
}

TEST_F(OperationVerbs, AnOpenSurfaceIsSmoothedAndDecimated) {
  brep::Triangles cap = brep::shapes::sphere({0, 0, 0}, 10.0, 4);
  std::erase_if(cap.faces, [&](const auto& face) { return cap.points_mm[face[0]].z < 0.0; });
  brep::write_mesh(cap, folder_ / "cap.ply");
  for (const std::string verb : {"smooth", "decimate"}) {
    const CommandAnswer answer = run(verb + " " + at("cap.ply") + " -o " + at("x.ply") + " --json");
    ASSERT_EQ(answer.status, 0) << answer.errors;
    const SortedJson told = SortedJson::parse(answer.out);
    EXPECT_TRUE(told.at("volume_mm3").is_null());
    EXPECT_FALSE(told.at("closed"));
    EXPECT_GT(told.at("area_mm2"), 500.0);
    expect_refused(run(verb + " " + at("cap.ply") + " -o " + at("x.octree")), "--mend");
  }
}

TEST_F(OperationVerbs, ASmallObjectIsNotDecimatedAway) {
  brep::write_mesh(brep::shapes::sphere({0, 0, 0}, 0.1, 4), folder_ / "metres.ply");
  const double before = volume_mm3("measure " + at("metres.ply"));
  EXPECT_NEAR(volume_mm3("decimate " + at("metres.ply") + " -o " + at("x.ply")), before, 0.02 * before);
}

TEST_F(OperationVerbs, ARefusalNamesTheOption) {
  expect_refused(run("mirror " + at("ball.off") + " --exactly"), "--plane");
  expect_refused(run("decimate " + at("ball.off") + " --max-error -1 -o " + at("x.ply")), "--max-error");
  expect_refused(run("repair " + at("ball.off") + " -o " + at("x.ply")), "--weld");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x.ply"));
}

}  // namespace
}  // namespace octotomy::planner
