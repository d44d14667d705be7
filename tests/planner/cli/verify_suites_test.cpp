// SPDX-License-Identifier: AGPL-3.0-or-later
#include <fstream>
#include <gtest/gtest.h>

#include "brep/io/write_mesh.h"
#include "tests/planner/cli/command_line.h"
#include "verify/general_position.h"
#include "verify/random_expression.h"
#include "voxel/filter/label_map.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::planner {
namespace {

/// Two random sets of voxels as meshes and as label maps.
class Verify : public tests::CommandLine {
 protected:
  Verify() {
    voxel::Universe universe;
    universe.depth = 4;
    verify::Random random(11);
    std::vector<voxel::Octree> sets;
    for (const char* name : {"a.nrrd", "b.nrrd"}) {
      sets.push_back(verify::random_set(random, universe, 12).octree);
      voxel::write_scene(voxel::label_map(universe.lattice(), {&sets.back(), 1}).scene, folder_ / name);
    }
    // Surfaces that do not touch themselves, as those of noise would.
    const verify::GeneralPosition position = verify::general_position(sets);
    brep::write_mesh(position.operands[0].solid, folder_ / "a.ply");
    brep::write_mesh(position.operands[1].solid, folder_ / "b.ply");
  }
};

TEST_F(Verify, RandomQuestionsAgreeAndAreTheSameOfTheSameSeed) {
  const auto first = run("verify --random 2 --seed 5 --json --failures " + at("failures"));
  ASSERT_EQ(first.status, 0) << first.errors << first.out;
  const tests::Json json = tests::Json::parse(first.out);
  EXPECT_EQ(json["exact"]["verdicts"]["PASS"], 2);
  EXPECT_EQ(json["counts"]["FAIL"], 0);
  EXPECT_EQ(json["disagreements"].size(), 0U);
  EXPECT_GE(json["certificates"].size(), 2U);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "failures"));
  const tests::Json one = tests::Json::parse(run("verify --random 1 --seed 6 --threads 1 --json").out);
  EXPECT_EQ(one["certificates"][0]["operation"], json["certificates"][1]["operation"]);
  EXPECT_EQ(one["certificates"][0]["mesh"], json["certificates"][1]["mesh"]);
}

TEST_F(Verify, TheThesissTablesAgree) {
  const auto answer = run("verify --thesis --json");
  EXPECT_EQ(answer.status, 0) << answer.errors;
  const tests::Json json = tests::Json::parse(answer.out);
  EXPECT_GT(json["tables"].size(), 70U);
  EXPECT_GT(json["not_recomputed"].size(), 0U);
}

TEST_F(Verify, TwoMeshesAndTwoLabelMapsOfAnyProgram) {
  for (const char* operation : {"union", "intersection", "difference"}) {
    const auto maps = run("verify " + at("a.nrrd") + " " + operation + " " + at("b.nrrd") + " --json");
    EXPECT_EQ(maps.status, 0) << maps.errors << maps.out;
    const tests::Json json = tests::Json::parse(maps.out);
    EXPECT_EQ(json["certificates"][0]["tier"], "exact");
    EXPECT_GE(json["volume_mm3"], json["certificates"][0]["voxel"]["volume_mm3"]);
  }
  const auto meshes =
      run("verify " + at("a.ply") + " union " + at("b.ply") + " --voxel 0.7 --json --report " + at("page"));
  EXPECT_EQ(meshes.status, 0) << meshes.errors << meshes.out;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "page" / "report.html"));
  std::ifstream written(folder_ / "page" / "result.json");
  EXPECT_EQ(tests::Json::parse(written)["counts"], tests::Json::parse(meshes.out)["counts"]);
}

TEST_F(Verify, WhatCannotBeUnderstoodIsRefusedByName) {
  expect_refused(run("verify " + at("a.ply") + " minus " + at("b.ply")), "minus");
  expect_refused(run("verify " + at("a.ply") + " union " + at("b.nrrd")), "not one of each");
  expect_refused(run("verify " + at("a.ply") + " union " + at("none.ply")), "none.ply");
  expect_refused(run("verify --seed 3"), "--random");
  expect_refused(run("verify " + at("a.nrrd") + " union " + at("b.nrrd") + " --voxel 1"), "--voxel");
  expect_refused(run("verify --random 2 --thesis"), "one thing at a time");
}

}  // namespace
}  // namespace octotomy::planner
