// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/deck/node_sets.h"

#include "brep/io/write_mesh.h"
#include "convert/deck/calculix_result.h"
#include "tests/brep/shapes.h"
#include "tests/file_bytes.h"
#include "tests/planner/cli/program/command_line.h"

namespace octotomy::planner {
namespace {

using tests::CommandAnswer;
using tests::quoted;
using tests::SortedJson;

class NodeSets : public tests::CommandLine {
 protected:
  NodeSets() {
    brep::write_mesh(brep::shapes::box({-5, -5, 0}, {5, 5, 20}), folder_ / "column.off");
    brep::write_mesh(brep::shapes::box({-9, -9, 20}, {9, 9, 30}), folder_ / "plate.off");
    write("marks.json", R"({ "landmarks": [ { "name": "corner", "point_mm": [6, 6, 21] } ] })");
  }
  CommandAnswer tet(const std::string& options) {
    return run("tet " + at("column.off") + " --max-volume 4 --refine-boundary -o " + at("column.inp") +
               " --json " + options);
  }
};

TEST_F(NodeSets, OfPlanesBallsPointsLandmarksAndMeshesHoldTheirNodesAlone) {
  const CommandAnswer answer =
      tet("--nodes LOW=0,0,0,0,0,1 --nodes BALL=5,5,20,3 --nodes ONE=5,5,0 --landmarks " + at("marks.json") +
          " --nodes MARK=corner --nodes HIGH=" + (folder_ / "plate.off").string());
  ASSERT_EQ(answer.status, 0) << answer.errors;
  const SortedJson sets = SortedJson::parse(answer.out)["node_sets"];
  EXPECT_GE(sets["LOW"], 9);
  EXPECT_EQ(sets["ONE"], 1);
  EXPECT_EQ(sets["MARK"], 1);
  EXPECT_GE(sets["BALL"], 1);
  EXPECT_GE(sets["HIGH"], 9);
  EXPECT_LT(sets["BALL"], sets["HIGH"]);
  const std::string deck = tests::bytes_of(folder_ / "column.inp");
  EXPECT_NE(deck.find("*NSET, NSET=MARK\n"), std::string::npos);
  EXPECT_EQ(deck.find("*STEP"), std::string::npos) << "nothing is prescribed";
}

TEST_F(NodeSets, WhatNamesNoPlaceOrNoMotionIsRefusedByName) {
  expect_refused(tet("--nodes LOW=0,0,5.5,0,0"), "is none of these: a point");
  expect_refused(tet("--nodes HIGH=0,0,40,0,0,1"), "HIGH would be empty");
  expect_refused(tet("--nodes A=5,5,0 --nodes A=5,5,20"), "comes twice");
  expect_refused(tet("--nodes Pin=5,5,0 --nodes PIN=5,5,20"), "the same name for solvers");
  for (const std::string own : {"SURFACE", "surface", "SOLID", "Nsolid"})
    expect_refused(tet("--nodes " + own + "=5,5,0"), "a set that every deck has");
  expect_refused(tet("--nodes 9A=5,5,0"), "--nodes: '9A' is not a name");
  expect_refused(tet("--nodes A=5,5,0 --fix B"), "none of the sets");
  expect_refused(tet("--nodes A=5,5,0 --move A=0,0,1"), "no nodes are fixed");
  expect_refused(tet("--nodes A=5,5,0 --nodes B=5,5,20 --fix B --move A=1"), "is not a motion");
  expect_refused(tet("--nodes A=0,0,0,0,0,1 --nodes B=-5,-5,0 --fix A --move B=0,0,1"), "shares nodes");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "column.inp"));
}

TEST_F(NodeSets, AColumnThatIsPressedByItsEndsMovesByHalfInTheMiddleInCalculix) {
  OCTOTOMY_NEEDS_PROGRAM("ccx", "calculix-ccx");
  for (const std::string order : {"1", "2"}) {
    const CommandAnswer answer = tet(
        "--nodes LOW=0,0,0,0,0,1 --nodes HIGH=0,0,20,0,0,1 --fix LOW --move HIGH=0,0,-0.1 --order " + order);
    ASSERT_EQ(answer.status, 0) << answer.errors;
    const std::string deck = tests::bytes_of(folder_ / "column.inp");
    EXPECT_TRUE(std::all_of(deck.begin(), deck.end(), [](unsigned char c) { return c < 0x80; })) << "ASCII";
    const CommandAnswer ccx =
        tests::run_command("cd " + quoted(folder_ / "") + " && ccx -i column", folder_ / "");
    ASSERT_EQ(ccx.status, 0) << ccx.out;
    EXPECT_EQ(ccx.out.find("*ERROR"), std::string::npos) << ccx.out;
    // The deck's nodes, read from its lines.
    std::istringstream lines(deck.substr(deck.find("*NODE")));
    std::string line;
    std::getline(lines, line);
    std::vector<double> heights;
    while (std::getline(lines, line) && line[0] != '*') {
      heights.push_back(std::stod(line.substr(line.rfind(',') + 1)));
    }
    const auto moved = convert::read_displacements(folder_ / "column.frd", heights.size());
    double middle = 0.0, count = 0.0;
    for (std::size_t i = 0; i < heights.size(); ++i) {
      ASSERT_TRUE(moved[i]);
      if (heights[i] == 0.0) {
        EXPECT_NEAR(moved[i]->z, 0.0, 1e-9);
      }
      if (heights[i] == 20.0) {
        EXPECT_NEAR(moved[i]->z, -0.1, 1e-6);
      }
      if (std::abs(heights[i] - 10.0) > 2.0) continue;
      middle += moved[i]->z + 0.1 * (heights[i] - 10.0) / 20.0;
      ++count;
    }
    ASSERT_GT(count, 5.0);
    EXPECT_NEAR(middle / count, -0.05, 0.002) << "order " << order;
  }
}

}  // namespace
}  // namespace octotomy::planner
