// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/report.h"

#include <algorithm>
#include <gtest/gtest.h>

#include "planner/operation/table/json.h"
#include "planner/result/report/drawn_page.h"
#include "planner/result/report/report_page.h"
#include "tests/file_bytes.h"
#include "tests/planner/ball_scan.h"
#include "tests/planner/result/report/page_data.h"
#include "tests/planner/times.h"

namespace octotomy::planner {
namespace {

using tests::page_data;
using tests::times;

class Report : public testing::Test {
 protected:
  Report() {
    voxel::write_scene(tests::ball_scene(12.0, 32), folder_ / "ball.nrrd");
    const SortedJson plan = SortedJson::parse(R"({
      "octotomy_plan": 1, "name": "A <b>bold</b> & \"quoted\" plan",
      "scans": { "ct": { "path": "ball.nrrd" } },
      "steps": [
        { "id": "ball", "do": "window", "scan": "ct", "low": 0 },
        { "id": "cut", "do": "mask", "regions": [
          { "view": "left", "polygons_mm": [[[-30, 3.2], [30, 3.2], [30, 30], [-30, 30]]] } ] },
        { "id": "cap", "do": "combine", "expression": "ball & cut" },
        { "id": "cup", "do": "combine", "expression": "ball - cut" },
        { "id": "lifted", "do": "move", "object": "cap", "translate_mm": [0, 0, 2] },
        { "id": "nothing", "do": "combine", "expression": "cup & lifted" },
        { "id": "all", "do": "combine", "expression": "cup | lifted" },
        { "id": "cap_size", "do": "measure", "object": "cap" },
        { "id": "none_size", "do": "measure", "object": "nothing" },
        { "id": "lift", "do": "measure", "object": "cup", "to": "lifted" },
        { "id": "wide", "do": "measure", "points_mm": [[-12, 0, 0], [12, 0, 0]] },
        { "id": "corner", "do": "measure", "points_mm": [[-12, 0, 0], [0, 0, 0], [0, 5, 5]] },
        { "id": "surface", "do": "export", "object": "lifted", "path": "pieces/cap.stl" },
        { "id": "label", "do": "export", "object": "lifted", "path": "cap.nrrd" },
        { "id": "deck", "do": "export", "object": "lifted", "path": "cap.inp" },
        { "id": "void", "do": "export", "object": "nothing", "path": "nothing.stl" } ] })");
    result_.plan = parse_plan(plan.dump(), folder_.path());
    result_.evaluation = evaluate(result_.plan);
    result_.pictures = plan_pictures(result_.plan, result_.evaluation);
    json_ = write_result(result_, folder_ / "out");
  }

  tests::ScratchFolder folder_;
  Result result_;
  nlohmann::ordered_json json_;
};

TEST_F(Report, TheFolderHoldsWhatTheAnswerSays) {
  EXPECT_EQ(SortedJson::parse(tests::bytes_of(folder_ / "out/result.json")), SortedJson(json_));
  for (const char* name : {"report.html", "pieces/cap.stl", "cap.nrrd", "cap.inp", "views/after_anterior.png",
                           "views/before_left.png", "tables/measurements.csv", "tables/certificates.csv",
                           "tables/movements.csv"})
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out" / name)) << name;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/nothing.stl"));
  for (const auto& exported : json_["exports"]) {
    const auto path = folder_.path() / "out" / exported["path"].get<std::string>();
    EXPECT_EQ(exported["written"].get<bool>(), std::filesystem::exists(path)) << path;
    if (!exported["written"].get<bool>()) {
      EXPECT_FALSE(exported["findings"].empty()) << path;
    }
  }
}

TEST_F(Report, NamesOfAResultAreThoseOfEachFileOfADeck) {
  const Plan plan =
      parse_plan(R"({"octotomy_plan": 1, "name": "deck", "scans": {"ct": {"path": "ball.nrrd"}}, "steps": [
      {"id": "ball", "do": "window", "scan": "ct", "low": 0},
      {"id": "tets", "do": "export", "object": "ball", "path": "decks/ball.node"}]})",
                 folder_.path());
  const std::vector<std::filesystem::path> names = result_names(plan);
  for (const char* name : {"result.json", "decks/ball.node", "decks/ball.ele", "decks/ball.face"})
    EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
}

TEST_F(Report, AnswersHaveTheirKeysAndAMissingOneIsNull) {
  EXPECT_EQ(json_["octotomy"], OCTOTOMY_VERSION);
  for (const char* stage : {"read", "octree", "isosurface", "boolean_voxel", "boolean_mesh", "certify",
                            "render", "tetrahedralise", "write"})
    EXPECT_TRUE(json_["timings_ms"].contains(stage)) << stage;
  ASSERT_EQ(json_["measurements"].size(), 5u);
  EXPECT_NEAR(json_["measurements"][0]["volume_mm3"].get<double>(), tests::cap_mm3(12.0, 3.2), 250.0);
  EXPECT_EQ(json_["measurements"][1]["volume_mm3"], 0.0);
  EXPECT_TRUE(json_["measurements"][1]["centroid_mm"].is_null());
  EXPECT_TRUE(json_["measurements"][1]["difference_percent"].is_null());
  EXPECT_GT(json_["measurements"][0]["volume_half_width_mm3"], 0.0);
  // Lifted by two millimetres, two voxels.
  EXPECT_NEAR(json_["measurements"][2]["gap_mesh_mm"].get<double>(), 2.0, 0.01);
  EXPECT_NEAR(json_["measurements"][2]["gap_mm"].get<double>(), 2.0,
              json_["measurements"][2]["gap_half_width_mm"].get<double>());
  EXPECT_EQ(json_["measurements"][3]["distance_mm"], 24.0);
  EXPECT_NEAR(json_["measurements"][4]["angle_deg"].get<double>(), 90.0, 1e-12);
  EXPECT_GT(json_["measurements"][4]["angle_half_width_deg"], 0.0);
  EXPECT_EQ(json_["certificates"].size(), 6u);
  for (const auto& certificate : json_["certificates"])
    for (const char* key :
         {"operation", "tier", "lineage", "voxel", "mesh", "difference_mm3", "tolerance_mm3", "terms",
          "symmetric_difference_mm3", "hausdorff_mm", "verdict", "timings_ms"})
      EXPECT_TRUE(certificate.contains(key)) << key;
}

TEST_F(Report, AMovementIsToldInWordsWithItsSigns) {
  ASSERT_EQ(json_["movements"].size(), 1u);
  EXPECT_EQ(json_["movements"][0]["object"], "lifted");
  EXPECT_EQ(json_["movements"][0]["words"], "up 2.0 mm; pitch 0.0\u00b0, yaw 0.0\u00b0, roll 0.0\u00b0");
  EXPECT_NEAR(json_["movements"][0]["centroid"]["up_mm"].get<double>(), 2.0, 1e-12);
  EXPECT_NE(json_["movement_words"].get<std::string>().find("Pitch is positive where the front goes up"),
            std::string::npos);
}

TEST_F(Report, ThePageHoldsTheResultItsPicturesAndNothingElse) {
  const std::string page = tests::bytes_of(folder_ / "out/report.html");
  const Json data = page_data(page);
  EXPECT_EQ(data["kind"], "report");
  Json result = data["result"];
  // The time to write is known after the page is written.
  result["timings_ms"] = json_["timings_ms"];
  EXPECT_EQ(result, json_);
  EXPECT_EQ(times(page, "<script"), 2);
  EXPECT_EQ(times(page, "<link"), 0);
  EXPECT_NE(page.find("script-src " + page_script_source() + "\">"), std::string::npos);
  ASSERT_EQ(data["pictures"].size(), 2u);
  EXPECT_EQ(data["pictures"][0]["pictures"].size(), 2u) << "two views before";
  EXPECT_EQ(data["pictures"][1]["pictures"].size(), 8u) << "eight views of the end";
  EXPECT_EQ(data["contents"].size(), data["result"]["exports"].size());
}

TEST_F(Report, TextOfThePlanCannotBecomeMarkup) {
  result_.plan.name = "</script><b>bold</b> & \"quoted\"";
  const std::string page = report_html(result_);
  EXPECT_EQ(times(page, "<b>bold"), 0);
  EXPECT_EQ(times(page, "</script>"), 2);
  EXPECT_NE(page.find("<h1>&lt;/script&gt;&lt;b&gt;bold&lt;/b&gt; &amp; &quot;quoted&quot;</h1>"),
            std::string::npos);
}

TEST_F(Report, TheMasksOutlineIsOfItsViewAlone) {
  for (const Json& group : report_data(result_)["pictures"])
    for (const Json& picture : group["pictures"]) {
      const Json expected = picture["view"] == "left"
                                ? Json::parse("[[[-30, 3.2], [30, 3.2], [30, 30], [-30, 30]]]")
                                : Json::array();
      EXPECT_EQ(picture["outlines_mm"], expected) << picture["view"];
    }
}

TEST_F(Report, CountsOfThePageFollowTheCertificates) {
  EXPECT_EQ(report_data(result_)["counts"]["FAIL"], 0);
  result_.evaluation.objects.change(0).certificate->verdict = verify::Verdict::Fail;
  EXPECT_EQ(verdict_counts(result_.evaluation).fail, 1);
  const Json counts = report_data(result_)["counts"];
  EXPECT_EQ(counts["FAIL"], 1);
  EXPECT_EQ(counts["pass_not_resolved"], verdict_counts(result_.evaluation).pass_not_resolved);
}

TEST_F(Report, AFailOfAMeasurementCountsBesideTheCertificates) {
  result_.measurements = Json::parse(R"([
      {"id": "seats", "object": "cap", "verdict": "FAIL", "findings": ["'cap' binds on 'cup'", "more"]},
      {"id": "prints", "object": "cap", "verdict": "WARN", "findings": []},
      {"id": "unknown", "object": "cap", "verdict": null, "findings": ["no mesh"]},
      {"id": "size", "object": "cap", "volume_mm3": 1.0}])");
  const MeasuredVerdicts found = measured_verdicts(result_.measurements);
  EXPECT_EQ(found.failed, std::vector<std::string>{"'seats': 'cap' binds on 'cup'"});
  const Json expected = Json::parse(R"({"PASS": 0, "WARN": 1, "FAIL": 1})");
  EXPECT_EQ(counts_json(result_)["measured"], expected);
  EXPECT_EQ(report_data(result_)["counts"]["measured"], expected);
  EXPECT_EQ(counts_json(result_)["FAIL"], 0) << "certificates are counted by themselves";
}

}  // namespace
}  // namespace octotomy::planner
