// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/report.h"

#include <algorithm>
#include <gtest/gtest.h>

#include "planner/operation/object/mask.h"
#include "planner/operation/table/json.h"
#include "planner/result/report/report_page.h"
#include "tests/file_bytes.h"
#include "tests/planner/ball_scan.h"
#include "tests/planner/times.h"

namespace octotomy::planner {
namespace {

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
  const std::string page = tests::bytes_of(folder_ / "out/report.html");
  EXPECT_EQ(times(page, "<h2>Movements</h2>"), 1);
  EXPECT_EQ(times(page, "up 2.0 mm; pitch"), 1);
}

TEST_F(Report, ThePageNeedsNothingElse) {
  const std::string page = tests::bytes_of(folder_ / "out/report.html");
  EXPECT_EQ(times(page, "http"), 0);
  EXPECT_EQ(times(page, "<script"), 0);
  EXPECT_EQ(times(page, "<link"), 0);
  EXPECT_EQ(times(page, "<image "), times(page, "href=\"data:image/png;base64,"));
  // Two views before and after, eight views of the end.
  EXPECT_EQ(times(page, "<image "), 12);
  EXPECT_EQ(times(page, "<table>"), times(page, "</table>"));
  EXPECT_EQ(times(page, "<details"), times(page, "</details>"));
  for (const Object& object : result_.evaluation.objects)
    EXPECT_NE(page.find(object.id), std::string::npos) << object.id;
}

TEST_F(Report, EachPictureSaysWhatItShowsAndTheDarkHasColoursOfItsOwn) {
  const std::string page = tests::bytes_of(folder_ / "out/report.html");
  int pictures = 0;
  for (std::size_t at = 0; (at = page.find("role=\"img\"", at)) != std::string::npos; ++at, ++pictures)
    EXPECT_EQ(page.substr(at, 24).find(" aria-label=\""), 10u) << page.substr(at, 80);
  EXPECT_GT(pictures, 5);
  EXPECT_NE(page.find("prefers-color-scheme:dark"), std::string::npos);
}

TEST_F(Report, TextOfThePlanCannotBecomeMarkup) {
  const std::string page = tests::bytes_of(folder_ / "out/report.html");
  EXPECT_EQ(times(page, "<b>bold"), 0);
  EXPECT_NE(page.find("A &lt;b&gt;bold&lt;/b&gt; &amp; &quot;quoted&quot; plan"), std::string::npos);
}

TEST_F(Report, TheMasksOutlineStandsWhereItWasDrawn) {
  // The cut's lower edge is at z = 3.2, above the middle of the picture before, whose centre is known.
  const auto group = std::find_if(result_.pictures.begin(), result_.pictures.end(),
                                  [](const PictureGroup& g) { return g.name == "before"; });
  ASSERT_NE(group, result_.pictures.end());
  const ScenePicture& left = group->pictures.front();
  ASSERT_EQ(left.view, "left");
  const double y = 0.5 * left.size_px - (3.2 - left.centre_mm.y) * left.size_px / left.width_mm;
  char text[32];
  std::snprintf(text, sizeof text, " %.2f", y);
  const std::string page = report_html(result_);
  const auto outline = page.find("stroke-dasharray");
  ASSERT_NE(outline, std::string::npos);
  EXPECT_NE(page.substr(outline, 200).find(text), std::string::npos)
      << "expected" << text << " in " << page.substr(outline, 200);
}

TEST_F(Report, AnOutlineElsewhereIsNotTaken) {
  Action elsewhere(*find_operation("mask"));
  static_cast<Mask*>(elsewhere.value())->regions = {{"anterior", {{{0, 0}, {1, 0}, {1, 1}}}}};
  result_.plan.steps[1].action = elsewhere;
  EXPECT_EQ(report_html(result_).find("stroke-dasharray"), std::string::npos);
}

TEST_F(Report, ADisagreementIsTheFirstThingSaid) {
  EXPECT_NE(report_html(result_).find("The two kernels agree"), std::string::npos);
  result_.evaluation.objects.change(0).certificate->verdict = verify::Verdict::Fail;
  EXPECT_EQ(verdict_counts(result_.evaluation).fail, 1);
  EXPECT_NE(report_html(result_).find("The two kernels disagree"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
