// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/verification.h"

#include <fstream>
#include <gtest/gtest.h>
#include <iterator>

#include "tests/planner/ball_scan.h"
#include "tests/planner/result/report/page_data.h"

namespace octotomy::planner {
namespace {

using tests::page_data;

/// Certificates of a ball and of what is left of it behind a cut.
class VerificationPage : public testing::Test {
 protected:
  VerificationPage() {
    voxel::write_scene(tests::ball_scene(12.0, 32), folder_ / "ball.nrrd");
    const Evaluation evaluation = evaluate(parse_plan(R"({
      "octotomy_plan": 1, "name": "ball", "scans": { "ct": { "path": "ball.nrrd" } },
      "steps": [
        { "id": "ball", "do": "window", "scan": "ct", "low": 0 },
        { "id": "cut", "do": "mask", "regions": [
          { "view": "left", "polygons_mm": [[[-30, 3.2], [30, 3.2], [30, 30], [-30, 30]]] } ] },
        { "id": "cup", "do": "combine", "expression": "ball - cut" } ] })",
                                                      folder_.path()));
    verification_.subject = "ball <b>.plan.json";
    verification_.answer = answer(evaluation.timings);
    verification_.answer["certificates"] = Json::array();
    for (const Object& object : evaluation.objects)
      if (object.certificate) {
        add(verification_.counts, *object.certificate);
        verification_.answer["certificates"].push_back(to_json(*object.certificate));
        verify::keep_worse(verification_.worst,
                           {*object.certificate, object.voxel.octree, object.mesh.within});
      }
    verification_.answer["counts"] = to_json(verification_.counts);
    verification_.not_covered = {"cut: a mask is certified together with the objects that it cuts"};
  }

  tests::ScratchFolder folder_;
  Verification verification_;
};

TEST_F(VerificationPage, HoldsTheAnswerThePicturesOfTheWorstAndWhatIsNotCovered) {
  const std::string page = verification_html(verification_);
  EXPECT_NE(page.find("ball &lt;b&gt;.plan.json"), std::string::npos);
  EXPECT_EQ(page.find("<b>.plan"), std::string::npos);
  const Json data = page_data(page);
  EXPECT_EQ(data["subject"], verification_.subject);
  const Json &shown = data["answer"]["certificates"], &all = verification_.answer["certificates"];
  ASSERT_EQ(shown.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(shown[i]["tolerance_mm3"], all[i]["tolerance_mm3"]);
    EXPECT_EQ(shown[i]["mesh"]["volume_mm3"], all[i]["mesh"]["volume_mm3"]);
    EXPECT_EQ(shown[i]["comparisons"].size(), all[i]["comparisons"].size());
    EXPECT_FALSE(shown[i].contains("terms")) << "no page shows them, and suites have thousands";
  }
  EXPECT_EQ(data["not_covered"], Json(verification_.not_covered));
  EXPECT_EQ(data["worst"]["pictures"].size(), 4u);
  EXPECT_EQ(data["worst"]["operation"], verification_.worst->certificate.operation);
  EXPECT_EQ(data["worst"]["colours"].size(), 9u);
}

TEST_F(VerificationPage, WithoutAnAnswerOfBothKernelsNothingIsDrawn) {
  verification_.worst.reset();
  EXPECT_TRUE(page_data(verification_html(verification_))["worst"].is_null());
}

TEST_F(VerificationPage, AnObjectThatIsNotResolvedIsMarkedAndNoSuccess) {
  verify::Certificate certificate = verification_.worst->certificate;
  certificate.unresolved = {2.0, "the object's smallest extent is 2.00 voxels, six are needed"};
  verification_.counts = {};
  add(verification_.counts, certificate);
  EXPECT_EQ(to_json(verification_.counts), Json({{"PASS", 1},
                                                 {"WARN", 0},
                                                 {"FAIL", 0},
                                                 {"not_resolved", 1},
                                                 {"without_evidence", 0},
                                                 {"without_certificate", 0}}));
  EXPECT_EQ(text_of(verification_.counts), "1 PASS (1 not resolved), 0 WARN, 0 FAIL");
  verification_.answer["certificates"] = Json::array({to_json(certificate)});
  EXPECT_EQ(verification_.answer["certificates"][0]["resolved"], false);
  EXPECT_EQ(verification_.answer["certificates"][0]["verdict"], "PASS");
  EXPECT_EQ(page_data(verification_html(verification_))["counts"]["pass_not_resolved"], 1);
}

TEST_F(VerificationPage, ObjectsWithoutACertificateAreCountedAsWithoutEvidence) {
  const Json before = to_json(verification_.counts);
  verification_.counts.without_certificate = 2;
  const Json counts = to_json(verification_.counts);
  EXPECT_EQ(counts.at("PASS"), before.at("PASS"));
  EXPECT_EQ(counts.at("without_certificate"), 2);
  EXPECT_EQ(counts.at("without_evidence").get<int>(), before.at("without_evidence").get<int>() + 2);
  EXPECT_NE(text_of(verification_.counts).find("0 FAIL, 2 without a certificate"), std::string::npos);
  EXPECT_EQ(page_data(verification_html(verification_))["counts"]["without_certificate"], 2);
}

TEST_F(VerificationPage, IsWrittenBesideItsJson) {
  write_verification(verification_, folder_ / "out");
  std::ifstream file(folder_ / "out" / "result.json");
  EXPECT_EQ(Json::parse(file), verification_.answer);
  EXPECT_GT(std::filesystem::file_size(folder_ / "out" / "report.html"), 20000U);
}

}  // namespace
}  // namespace octotomy::planner
