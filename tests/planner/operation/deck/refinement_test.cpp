// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/deck/refinement.h"

#include <gtest/gtest.h>

#include "planner/plan/plan.h"
#include "planner/plan/plan_results.h"
#include "tests/planner/ball_scan.h"

namespace octotomy::planner {
namespace {

class RefinementOfDecks : public testing::Test {
 protected:
  RefinementOfDecks() { voxel::write_scene(tests::ball_scene(10.0, 32), folder_ / "ball.nrrd"); }

  Plan plan(const std::string& keys) const {
    return parse_plan(R"({ "octotomy_plan": 1, "name": "ball", "scans": { "ct": { "path": "ball.nrrd" } },
      "steps": [ { "id": "ball", "do": "window", "scan": "ct", "low": 0 },
                 { "id": "cut", "do": "mask", "regions": [ { "view": "anterior",
                     "polygons_mm": [[[-20, 0], [20, 0], [20, 20], [-20, 20]]] } ] },
                 { "id": "upper", "do": "combine", "expression": "ball & cut" },
                 { "id": "deck", "do": "export", "object": "upper", )" +
                          keys + " } ] }",
                      folder_.path());
  }
  tests::ScratchFolder folder_;
};

TEST_F(RefinementOfDecks, DecksOfOneObjectMayBeGradedEachInItsOwnWay) {
  const Plan even = plan(R"("path": "even.vtu")");
  const Plan at_point = plan(R"("path": "at_point.vtu", "finer": [{ "at": [0, 0, 10], "size_mm": 0.5 }])");
  const Plan along_cut = plan(R"("path": "along_cut.vtu", "finer": [{ "at": "cut", "size_mm": 1 }])");
  const Evaluation evaluation = evaluate(even);
  Timings timings;
  std::map<std::string, std::shared_ptr<const void>> kept;
  const auto tets = [&](const Plan& plan) {
    return write_file(plan, evaluation, plan.steps.back(), folder_.path(), timings, kept)
        .details["tets"]
        .get<double>();
  };
  const double evenly = tets(even);
  EXPECT_GT(tets(at_point), 1.1 * evenly);
  EXPECT_GT(tets(along_cut), 1.5 * evenly);
  EXPECT_EQ(tets(even), evenly);
}

TEST_F(RefinementOfDecks, AnObjectWithoutAMeshIsNamedAndNothingIsWritten) {
  const Plan along_cut = plan(R"("path": "deck.vtu", "finer": [{ "at": "cut", "size_mm": 1 }])");
  Evaluation evaluation = evaluate(along_cut);
  evaluation.objects.change(1).mesh.within.reset();
  Timings timings;
  const Exported deck = write_files(along_cut, evaluation, folder_.path(), timings).back();
  EXPECT_FALSE(deck.written);
  EXPECT_NE(deck.findings.front().find("surface of 'cut'"), std::string::npos) << deck.findings.front();
}

TEST_F(RefinementOfDecks, PlacesWithoutSizeOrMeaningAreRefused) {
  for (const char* keys :
       {R"("path": "d.vtu", "finer": [{ "at": [0, 0, 0] }])",
        R"("path": "d.vtu", "finer": [{ "size_mm": 1 }])",
        R"("path": "d.vtu", "finer": [{ "at": [0, 0], "size_mm": 1 }])",
        R"("path": "d.vtu", "finer": [{ "at": "nothing", "size_mm": 1 }])",
        R"("path": "d.vtu", "finer": [{ "at": [0, 0, 0], "size_mm": 0 }])",
        R"("path": "d.vtu", "finer": { "at": [0, 0, 0], "size_mm": 1 })",
        R"("path": "d.stl", "finer": [{ "at": [0, 0, 0], "size_mm": 1 }])",
        R"("path": "d.vtu", "regions": ["ball"], "finer": [{ "at": [0, 0, 0], "size_mm": 1 }])"})
    EXPECT_THROW(plan(keys), std::runtime_error) << keys;
}

}  // namespace
}  // namespace octotomy::planner
