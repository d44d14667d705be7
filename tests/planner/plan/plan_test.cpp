// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/plan.h"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

#include "planner/operation/object/mask.h"
#include "planner/operation/table/field_json.h"
#include "planner/operation/table/json.h"
#include "tests/voxel/scratch_folder.h"

namespace octotomy::planner {
namespace {

SortedJson le_fort_i() {
  std::ifstream file(std::string(OCTOTOMY_SOURCE_DIR) + "/planner/le_fort_i.plan.json");
  return SortedJson::parse(file);
}

/// The message with which a plan is refused; empty if it is accepted.
std::string refusal(const std::string& text) {
  try {
    parse_plan(text, "/plans");
    return "";
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}
std::string refusal(const SortedJson& plan) {
  return refusal(plan.dump());
}

/// A step's fields as they would be written.
SortedJson printed(const Step& step) {
  Action action = step.action;
  return SortedJson::parse(print_fields(action.operation().fields, action.value()).dump());
}

/// The step of le_fort_i with this id.
SortedJson& step(SortedJson& plan, const std::string& id) {
  for (SortedJson& step : plan["steps"])
    if (step["id"] == id) return step;
  throw std::out_of_range(id);
}

void expect_says(const std::string& said, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(said.find(part), std::string::npos) << "refusal: '" << said << "'\nlacks:   '" << part << "'";
}

TEST(Plan, TheExampleIsReadWithEveryNumberInItsPlace) {
  const Plan plan = read_plan(std::string(OCTOTOMY_SOURCE_DIR) + "/planner/le_fort_i.plan.json");
  EXPECT_EQ(plan.voxel_mm, 1.0);
  EXPECT_EQ(scan_path(plan, plan.scans.at("ct")), plan.folder / "head.nrrd");
  ASSERT_GE(plan.steps.size(), 7u);
  const SortedJson window = printed(plan.steps[0]);
  EXPECT_EQ(window, SortedJson::parse(R"({"scan": "ct", "low": 300.0})"));
  const auto& mask = plan.steps[1].action.get<Mask>();
  ASSERT_EQ(mask.regions.size(), 2u);
  EXPECT_EQ(mask.regions[0].view, "anterior");
  EXPECT_EQ(mask.regions[1].polygons_mm[0][0], glm::dvec2(-90, -60));
  EXPECT_EQ(printed(plan.steps[4]),
            SortedJson::parse(R"({"object": "maxilla", "translate_mm": [0.0, -6.0, 2.0],
      "rotate": {"degrees": 5.0, "axis": [1.0, 0.0, 0.0], "about_mm": [0.0, -40.0, -30.0]}})"));
  EXPECT_EQ(verb(plan.steps[1]), "mask");
  EXPECT_EQ(verb(plan.steps.back()), "deck");
}

TEST(Plan, AScanSaysItsSeriesAndWhatItsFileDoesNot) {
  SortedJson plan = le_fort_i();
  plan["scans"]["ct"] = {{"path", "head.raw"},
                         {"spacing_mm", {0.5, 0.5, 1.25}},
                         {"raw", {{"dims", {512, 512, 300}}, {"type", "uint16"}, {"offset", 12}}}};
  const ScanSource raw = parse_plan(plan.dump(), "/plans").scans.at("ct");
  EXPECT_EQ(raw.read.spacing_mm, glm::dvec3(0.5, 0.5, 1.25));
  ASSERT_TRUE(raw.read.raw);
  EXPECT_EQ(raw.read.raw->dims, glm::ivec3(512, 512, 300));
  EXPECT_EQ(raw.read.raw->type, voxel::SampleType::UInt16);
  EXPECT_FALSE(raw.read.raw->big_endian);
  EXPECT_EQ(raw.read.raw->offset, 12u);
  plan["scans"]["ct"] = {{"path", "dicom"}, {"series", "bone kernel"}};
  EXPECT_EQ(parse_plan(plan.dump(), "/plans").scans.at("ct").read.series, "bone kernel");
  plan["scans"]["ct"] = {{"path", "head.raw"}, {"raw", {{"dims", {512, 512}}, {"type", "int16"}}}};
  expect_says(refusal(plan), {"scans, ct, raw, dims", "three numbers"});
  plan["scans"]["ct"]["raw"] = {{"dims", {512, 512, 2.5}}, {"type", "int16"}};
  expect_says(refusal(plan), {"dims", "whole number"});
  plan["scans"]["ct"]["raw"] = {{"dims", {5, 5, 5}}, {"type", "short"}};
  expect_says(refusal(plan), {"type", "'short'"});
  plan["scans"]["ct"]["raw"] = {{"dims", {5, 5, 5}}, {"type", "int16"}, {"ofset", 1}};
  expect_says(refusal(plan), {"ofset", "did you mean 'offset'"});
}

TEST(Plan, AScanKeepsTheFrameAndUnitThatItsFileStatesWrongly) {
  SortedJson plan = le_fort_i();
  plan["scans"]["ct"] = {{"path", "head.nrrd"}, {"frame", "right-anterior-superior"}, {"unit", "um"}};
  const ScanSource source = parse_plan(plan.dump(), "/plans").scans.at("ct");
  ASSERT_TRUE(source.read.frame);
  EXPECT_EQ(source.read.frame->name, "RAS");
  EXPECT_EQ(source.read.frame->lps_from_frame[1], glm::dvec3(0, -1, 0));
  ASSERT_TRUE(source.read.unit);
  EXPECT_EQ(source.read.unit->mm, 1e-3);
  plan["scans"]["ct"]["frame"] = "RAL";
  expect_says(refusal(plan), {"scans, ct, frame", "'RAL'", "RAS"});
  plan["scans"]["ct"]["frame"] = "LAS";
  plan["scans"]["ct"]["unit"] = "pixel";
  expect_says(refusal(plan), {"scans, ct, unit", "'pixel'", "inch"});
}

TEST(Plan, AnUnknownKeyIsRefusedWithTheStepAndTheNearestKnownOne) {
  SortedJson plan = le_fort_i();
  step(plan, "advanced")["translate"] = {0, -6, 2};
  expect_says(refusal(plan), {"step 'advanced'", "unknown key 'translate'", "did you mean 'translate_mm'?"});
  plan = le_fort_i();
  plan["universe"]["voxelmm"] = 1.0;
  expect_says(refusal(plan), {"universe", "'voxelmm'", "'voxel_mm'"});
  plan = le_fort_i();
  plan["step"] = SortedJson::array();
  expect_says(refusal(plan), {"'step'", "'steps'"});
}

TEST(Plan, AnUnknownStepIsRefusedWithTheStepsThereAre) {
  SortedJson plan = le_fort_i();
  step(plan, "maxilla")["do"] = "combin";
  expect_says(refusal(plan),
              {"step 'maxilla'", "unknown step 'combin'", "did you mean 'combine'?", "mask", "window"});
}

TEST(Plan, ANameIsRefusedBeforeItIsBound) {
  SortedJson plan = le_fort_i();
  std::swap(plan["steps"][0], plan["steps"][2]);
  expect_says(refusal(plan), {"step 'maxilla'", "no earlier step is called 'skull'"});
  plan = le_fort_i();
  step(plan, "maxilla")["expression"] = "maxilla & cut";
  expect_says(refusal(plan), {"no earlier step is called 'maxilla'"});
  plan = le_fort_i();
  step(plan, "result")["expression"] = "rest | advance";
  expect_says(refusal(plan), {"step 'result'", "did you mean 'advanced'?"});
}

TEST(Plan, AMeasurementIsNoObject) {
  SortedJson plan = le_fort_i();
  plan["steps"].push_back({{"id", "again"}, {"do", "measure"}, {"object", "overlap_size"}});
  expect_says(refusal(plan), {"step 'again'", "'overlap_size' is a measure step"});
}

TEST(Plan, AMeasureStepAsksForOneThing) {
  const auto refused = [](SortedJson measure) {
    SortedJson plan = le_fort_i();
    measure["id"] = "asked";
    measure["do"] = "measure";
    plan["steps"].push_back(measure);
    return refusal(plan);
  };
  EXPECT_EQ(refused({{"object", "rest"}, {"to", "advanced"}}), "");
  EXPECT_EQ(refused({{"points_mm", {{0, 0, 0}, {1, 0, 0}}}}), "");
  EXPECT_EQ(refused({{"points_mm", {{2, 0, 0}, {0, 0, 0}, {1, 0, 0}}}}), "");
  expect_says(refused({{"object", "rest"}, {"to", "rest"}}), {"step 'asked', to", "the object itself"});
  expect_says(refused({{"object", "rest"}, {"to", "advance"}}), {"to", "did you mean 'advanced'?"});
  expect_says(refused({{"to", "rest"}}), {"'object' is missing"});
  expect_says(refused({{"object", "rest"}, {"points_mm", {{0, 0, 0}, {1, 0, 0}}}}),
              {"excludes other measures"});
  expect_says(refused({{"points_mm", {{0, 0, 0}}}}), {"two points", "three for the angle"});
  expect_says(refused({{"points_mm", {{0, 0, 0}, {1, 0}}}}), {"points_mm[1]", "three numbers"});
  expect_says(refused({{"points_mm", {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}}}}),
              {"a leg of the angle has no length"});
}

TEST(Plan, IdsAreUniqueIdentifiers) {
  for (const char* id : {"two words", "1st", "a-b", "", "\xc3\xa4", "a.b"}) {
    SortedJson plan = le_fort_i();
    plan["steps"].push_back({{"id", id}, {"do", "measure"}, {"object", "skull"}});
    EXPECT_NE(refusal(plan), "") << "id '" << id << "' was taken";
  }
  SortedJson plan = le_fort_i();
  plan["steps"].push_back({{"id", "skull"}, {"do", "measure"}, {"object", "skull"}});
  expect_says(refusal(plan), {"'skull'", "taken"});
}

TEST(Plan, AnExpressionIsParsedBeforeAnythingIsEvaluated) {
  for (const char* expression :
       {"skull &", "skull cut", "(skull", "& cut", "move(skull, cut)", "skull + cut"}) {
    SortedJson plan = le_fort_i();
    step(plan, "maxilla")["expression"] = expression;
    expect_says(refusal(plan), {"step 'maxilla'", "expression"});
  }
}

TEST(Plan, NumbersAreFiniteNumbers) {
  std::string text = le_fort_i().dump();
  const std::string low = "\"low\":300";
  const auto at = text.find(low);
  ASSERT_NE(at, std::string::npos);
  EXPECT_NE(refusal(std::string(text).replace(at, low.size(), "\"low\":1e999")), "");
  EXPECT_NE(refusal(std::string(text).replace(at, low.size(), "\"low\":NaN")), "");
  expect_says(refusal(std::string(text).replace(at, low.size(), "\"low\":\"300\"")),
              {"step 'skull', low", "number"});
  EXPECT_EQ(refusal(text), "");
}

TEST(Plan, AKeySaidTwiceIsRefused) {
  std::string text = le_fort_i().dump();
  const std::string low = "\"low\":300";
  text.replace(text.find(low), low.size(), "\"low\":300,\"low\":400");
  expect_says(refusal(text), {"'low'", "twice"});
}

TEST(Plan, AnExportIsRefusedWhereNothingCouldWriteIt) {
  SortedJson plan = le_fort_i();
  step(plan, "piece")["path"] = "maxilla.stp";
  expect_says(refusal(plan), {"step 'piece'", "maxilla.stp", "did you mean '.stl'?"});
  for (const char* path :
       {"/tmp/maxilla.stl", "../maxilla.stl", "a/../../maxilla.stl", "views/maxilla.stl"}) {
    step(plan, "piece")["path"] = path;
    expect_says(refusal(plan), {"within the result folder"});
  }
  plan = le_fort_i();
  plan["steps"].push_back({{"id", "twin"}, {"do", "export"}, {"object", "skull"}, {"path", "./maxilla.stl"}});
  expect_says(refusal(plan), {"step 'twin'", "written by an earlier step"});
}

TEST(Plan, TheExtensionSaysWhatIsExported) {
  SortedJson plan = le_fort_i();
  step(plan, "piece")["path"] = "maxilla.nii.gz";
  const Plan read = parse_plan(plan.dump(), "/plans");
  for (const Step& each : read.steps) {
    if (each.action.operation().makes != Makes::File) continue;
    EXPECT_EQ(verb(each), each.id == "piece" ? "label_map" : "deck") << each.id;
  }
}

TEST(Plan, ARegionWithoutAreaOrOfAnUnknownViewIsRefused) {
  SortedJson plan = le_fort_i();
  step(plan, "cut")["regions"][0]["view"] = "front";
  expect_says(refusal(plan), {"step 'cut'", "regions[0]", "front", "anterior"});
  plan = le_fort_i();
  step(plan, "cut")["regions"][1]["polygons_mm"][0] = {{0, 0}, {1, 1}};
  expect_says(refusal(plan), {"step 'cut'"});
  plan = le_fort_i();
  step(plan, "cut")["regions"][1]["polygons_mm"][0][2] = {0, 0, 0};
  expect_says(refusal(plan), {"step 'cut'", "polygons_mm[0][2]", "two numbers"});
}

TEST(Plan, AnUpsideDownWindowAMoveOfNothingAndARotationWithoutAxisAreRefused) {
  SortedJson plan = le_fort_i();
  step(plan, "skull")["high"] = 200;
  expect_says(refusal(plan), {"step 'skull', high", "below"});
  plan = le_fort_i();
  step(plan, "advanced").erase("translate_mm");
  step(plan, "advanced").erase("rotate");
  expect_says(refusal(plan), {"step 'advanced'", "moves nothing"});
  plan = le_fort_i();
  step(plan, "advanced")["rotate"]["axis"] = {0, 0, 0};
  expect_says(refusal(plan), {"step 'advanced', rotate, axis"});
}

TEST(Plan, OnlyVersionOneIsRead) {
  SortedJson plan = le_fort_i();
  plan["octotomy_plan"] = 2;
  expect_says(refusal(plan), {"octotomy_plan"});
  plan.erase("octotomy_plan");
  expect_says(refusal(plan), {"'octotomy_plan' is missing"});
  EXPECT_NE(refusal(std::string("[]")), "");
  EXPECT_NE(refusal(std::string("{")), "");
  EXPECT_NE(refusal(std::string("")), "");
}

TEST(Plan, AFileThatIsNotAPlanIsNamed) {
  const tests::ScratchFolder folder;
  const auto path = folder / "not_a.plan.json";
  std::ofstream(path) << "{ \"octotomy_plan\": 1 ";
  try {
    read_plan(path);
    FAIL() << "half a plan was read";
  } catch (const std::runtime_error& error) {
    expect_says(error.what(), {path.string(), "no JSON"});
  }
  EXPECT_THROW(read_plan("/no/such.plan.json"), std::runtime_error);
}

TEST(Plan, NestedTooDeepIsRefused) {
  expect_says(refusal(std::string(100'000, '[')), {"nested more than 512 deep"});
}

}  // namespace
}  // namespace octotomy::planner
