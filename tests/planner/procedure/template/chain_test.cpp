// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/procedure/template/chain.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <optional>

#include "planner/operation/table/json.h"
#include "tests/planner/procedure/template/on_the_head.h"
#include "tests/voxel/scratch_folder.h"
#include "verify/phantom/head_phantom.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::planner {
namespace {

/// The landmarks of the head phantom that a procedure needs.
std::vector<brep::Landmark> landmarks_of(const Procedure& procedure) {
  std::vector<brep::Landmark> wanted = tests::head_landmarks();
  std::erase_if(wanted, [&](const brep::Landmark& mark) {
    return std::none_of(procedure.landmarks.begin(), procedure.landmarks.end(),
                        [&](const ProcedureLandmark& each) { return each.name == mark.name; });
  });
  return wanted;
}

/// The head phantom in voxels of 2 mm, and a plan of a procedure on it.
class Chain : public testing::Test {
 protected:
  void SetUp() override {
    verify::HeadOptions coarse;
    coarse.voxel_mm = 2.0;
    voxel::write_scene(verify::head_phantom(coarse), folder_ / "head.nrrd");
  }

  ProcedureInput input(std::vector<brep::Landmark> landmarks, std::map<std::string, double> values) const {
    ProcedureInput made;
    made.scan = {{"path", "head.nrrd"}};
    made.landmarks = std::move(landmarks);
    made.values = std::move(values);
    made.voxel_mm = 2.0;
    made.folder = folder_.path();
    return made;
  }
  Plan planned(const char* name, std::map<std::string, double> values) const {
    const Procedure procedure = read_procedure(name);
    return parse_plan(plan_of(procedure, input(landmarks_of(procedure), std::move(values))).dump(),
                      folder_.path());
  }
  Evaluation evaluated(const Plan& plan) const {
    EvaluateOptions options;
    options.certify = options.meshes = false;
    return evaluate(plan, options);
  }
  Chained after(const Plan& plan, const char* name, std::map<std::string, double> values) const {
    const Procedure procedure = read_procedure(name);
    return chained(plan, evaluated(plan), procedure, input(landmarks_of(procedure), std::move(values)));
  }
  Plan read(const Chained& made) const { return parse_plan(made.plan.dump(), folder_.path()); }

  tests::ScratchFolder folder_;
};

double volume(const Evaluation& evaluation, const char* id) {
  return evaluation.objects.at(id).voxel.measures.volume_mm3;
}

TEST_F(Chain, AChinIsCutFromTheJawWhereTheJawHasGone) {
  const Plan jaws = planned("bilateral_sagittal_split", {{"forward_mm", 6}});
  const Chained made = after(jaws, "genioplasty", {{"forward_mm", 4}});
  EXPECT_NE(std::find(made.carried.begin(), made.carried.end(), "pogonion"), made.carried.end());
  const Evaluation both = evaluated(read(made));
  const Evaluation alone = evaluated(planned("genioplasty", {{"forward_mm", 4}}));
  // The same chin, 6 mm in front of where it is cut alone.
  EXPECT_NEAR(volume(both, "genioplasty_chin") / volume(alone, "chin"), 1.0, 0.01);
  const auto centre = [](const Evaluation& evaluation, const char* id) {
    return evaluation.objects.at(id).voxel.measures.centroid_mm.value();
  };
  const glm::dvec3 by_mm = centre(both, "genioplasty_chin_moved") - centre(alone, "chin_moved");
  EXPECT_NEAR(by_mm.y, -6.0, 0.2);
  EXPECT_NEAR(by_mm.z, 0.0, 0.2);
  EXPECT_EQ(outcome_of(read(made)), "genioplasty_planned");
}

TEST_F(Chain, ALandmarkGoesWithItsOwnPieceAloneAndNeverWithAMirrorImage) {
  // Two pieces, of which the first is moved to where the second one was.
  const Plan plan =
      parse_plan(R"json({"octotomy_plan": 1, "name": "p", "scans": {"ct": {"path": "head.nrrd"}},
      "universe": {"voxel_mm": 2}, "steps": [
      {"id": "skull", "do": "window", "scan": "ct", "low": 300},
      {"id": "lower", "do": "mask", "regions": [{"view": "anterior",
          "polygons_mm": [[[-60, -110], [60, -110], [60, -86], [-60, -86]]]}]},
      {"id": "upper", "do": "mask", "regions": [{"view": "anterior",
          "polygons_mm": [[[-60, -86], [60, -86], [60, -62], [-60, -62]]]}]},
      {"id": "chin_piece", "do": "combine", "expression": "skull & lower"},
      {"id": "tooth_piece", "do": "combine", "expression": "skull & upper"},
      {"id": "chin_up", "do": "move", "object": "chin_piece", "translate_mm": [0, 0, 20]},
      {"id": "tooth_up", "do": "move", "object": "tooth_piece", "translate_mm": [0, 0, 30]},
      {"id": "image", "do": "mirror", "object": "skull", "point_mm": [0, 0, 0], "normal": [0, 1, 0]},
      {"id": "planned", "do": "combine", "expression": "(skull - lower - upper) | chin_up | tooth_up | image"}]})json",
                 folder_.path());
  const Chained made = after(plan, "genioplasty", {});
  for (const Json& step : made.plan["steps"])
    if (step["id"] == "genioplasty_chin_moved") {
      const Json& about = step["turn"]["about_mm"];  // the pogonion
      EXPECT_NEAR(about[0].get<double>(), 0.0, 1e-9);
      EXPECT_NEAR(about[1].get<double>(), -87.0, 1e-9);
      EXPECT_NEAR(about[2].get<double>(), -73.0, 1e-9) << "once, with the chin";
    }
  EXPECT_NE(std::find(made.carried.begin(), made.carried.end(), "menton"), made.carried.end());
}

TEST_F(Chain, EachProcedureHasNamesOfItsOwnAndEachStaysEditable) {
  const Plan first = planned("genioplasty", {{"forward_mm", 4}});
  const Plan second = read(after(first, "genioplasty", {{"up_mm", 2}}));
  const Plan third = read(after(second, "genioplasty", {{"left_mm", 1}}));
  std::vector<std::string> ids;
  for (const Step& step : third.steps) ids.push_back(step.id);
  for (const char* id : {"chin", "genioplasty_chin", "genioplasty_2_chin", "genioplasty_2_planned"})
    EXPECT_EQ(std::count(ids.begin(), ids.end(), id), 1) << id;
  // Without its own steps the plan before is as it was.
  Json whole = Json::parse(third.text), kept = Json::array();
  for (const Json& step : whole["steps"])
    if (!step["id"].get<std::string>().starts_with("genioplasty")) kept.push_back(step);
  EXPECT_EQ(kept, Json::parse(first.text)["steps"]);
}

TEST(Procedures, SayWhatTheyActOnAndWhatTheyEndWith) {
  for (const std::string& name : procedures()) {
    const Procedure procedure = read_procedure(name);
    const auto step_of = [&](const std::string& id) {
      const auto step = std::find_if(procedure.steps.begin(), procedure.steps.end(),
                                     [&](const Json& each) { return each.value("id", "") == id; });
      return step == procedure.steps.end() ? Json::object() : *step;
    };
    EXPECT_EQ(step_of(procedure.acts_on).value("do", ""), "window") << name;
    EXPECT_EQ(step_of(procedure.acts_on).value("scan", ""), "ct") << name;
    EXPECT_EQ(step_of(procedure.outcome).value("do", ""), "combine") << name;
  }
}

TEST(Procedures, RefuseAnOutcomeThatIsNoStep) {
  const std::string text = R"({"procedure": "p", "says": "s.", "landmarks": [], "values": [],
      "steps": [{"id": "skull", "do": "window", "scan": "ct", "low": 300}], "outcome": )";
  EXPECT_EQ(parse_procedure(text + R"("skull"})").outcome, "skull");
  try {
    parse_procedure(text + R"("planned"})");
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "outcome: no step is called 'planned'");
  }
}

TEST(OutcomeOf, AReconstructionIsItsRepairedBoneAndOfOtherPlansItIsNot) {
  const auto plan_with = [](const std::vector<std::string>& ids) {
    Json steps = Json::array();
    for (const std::string& id : ids)
      steps.push_back({{"id", id}, {"do", "window"}, {"scan", "ct"}, {"low", 300}});
    return parse_plan(
        Json{{"octotomy_plan", 1}, {"name", "p"}, {"scans", {{"ct", {{"path", "a.nrrd"}}}}}, {"steps", steps}}
            .dump(),
        ".");
  };
  std::vector<std::string> own;
  for (const Json& step : read_procedure("mirrored_reconstruction_side").steps) own.push_back(step.at("id"));
  EXPECT_EQ(outcome_of(plan_with(own)), "repaired");
  EXPECT_EQ(outcome_of(plan_with({"planned", "repaired"})), "planned") << "a step of another meaning";
  EXPECT_EQ(outcome_of(plan_with({"planned", "mirrored_reconstruction_side_repaired", "more"})),
            "mirrored_reconstruction_side_repaired");
  EXPECT_EQ(outcome_of(plan_with({"skull"})), std::nullopt);
}

TEST(ChainedSteps, AreKnownByTheProceduresNameAndTheirOwn) {
  const Procedure procedure = read_procedure("le_fort_i");
  EXPECT_TRUE(is_chained_step_of(procedure, "le_fort_i_maxilla"));
  EXPECT_TRUE(is_chained_step_of(procedure, "le_fort_i_2_maxilla"));
  EXPECT_FALSE(is_chained_step_of(procedure, "maxilla"));
  EXPECT_FALSE(is_chained_step_of(procedure, "le_fort_i_two_piece_maxilla"));
  EXPECT_FALSE(is_chained_step_of(procedure, "le_fort_i_mine"));
  EXPECT_EQ(name_before_chaining(procedure, "le_fort_i_2_maxilla"), "maxilla");
  EXPECT_EQ(name_before_chaining(procedure, "maxilla"), std::nullopt);
}

TEST_F(Chain, WhatCannotBeChainedIsRefusedWithAReason) {
  const auto refusal = [&](const Plan& plan, const char* name, std::map<std::string, double> values,
                           std::optional<std::vector<brep::Landmark>> landmarks = {}) {
    try {
      if (!landmarks) landmarks = landmarks_of(read_procedure("genioplasty"));
      chained(plan, evaluated(plan), read_procedure(name), input(*landmarks, std::move(values)));
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const Plan first = planned("genioplasty", {});
  EXPECT_NE(refusal(first, "genioplasty", {{"bone_low", 200}}).find("bone_low changes nothing"),
            std::string::npos);
  EXPECT_NE(refusal(first, "genioplasty", {{"forward", 2}}).find("forward_mm"), std::string::npos);
  EXPECT_NE(
      refusal(first, "genioplasty", {}, {{{"menton", {0, -80, -101}}}}).find("from the plan's landmark"),
      std::string::npos);
  EXPECT_NE(refusal(first, "le_fort_i", {}).find("lacks landmarks"), std::string::npos);
  const Plan bone = parse_plan(R"({"octotomy_plan": 1, "name": "b", "scans": {"ct": {"path": "head.nrrd"}},
      "universe": {"voxel_mm": 2}, "steps": [{"id": "bone", "do": "window", "scan": "ct", "low": 300}]})",
                               folder_.path());
  EXPECT_NE(refusal(bone, "genioplasty", {}).find("no step 'planned'"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
