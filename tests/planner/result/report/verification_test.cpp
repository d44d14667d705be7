// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/verification.h"

#include <fstream>
#include <gtest/gtest.h>
#include <iterator>

#include "tests/planner/ball_scan.h"
#include "tests/planner/times.h"

namespace octotomy::planner {
namespace {

using tests::times;

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
    verification_.not_covered = {"cut: a mask is certified with what it cuts"};
  }

  tests::ScratchFolder folder_;
  Verification verification_;
};

TEST_F(VerificationPage, ShowsEveryQuantityTheWorstInPicturesAndWhatIsNotCovered) {
  const std::string page = verification_html(verification_);
  EXPECT_NE(page.find("ball &lt;b&gt;.plan.json"), std::string::npos);
  EXPECT_EQ(page.find("<b>.plan"), std::string::npos);
  EXPECT_NE(page.find("The two kernels agree"), std::string::npos);
  for (const char* quantity :
       {"volume", "area", "centroid", "inertia", "symmetric difference", "hausdorff95"})
    EXPECT_NE(page.find("<td>" + std::string(quantity) + "</td>"), std::string::npos) << quantity;
  EXPECT_EQ(times(page, "data:image/png;base64,"), 4);
  EXPECT_NE(page.find("a mask is certified with what it cuts"), std::string::npos);
  EXPECT_EQ(page.find(">FAIL<"), std::string::npos);
  EXPECT_EQ(times(page, "<script"), 0);
}

TEST_F(VerificationPage, AFailureIsSeenInTheHeadTheTableAndThePlot) {
  Json& certificate = verification_.answer["certificates"][1];
  certificate["verdict"] = "FAIL";
  certificate["reasons"] = {"volume differs by 9 mm3 where theory allows 3"};
  for (Json& comparison : certificate["comparisons"])
    if (comparison["quantity"] == "volume") {
      comparison["difference"] = 9.0;
      comparison["tolerance"] = 3.0;
      comparison["verdict"] = "FAIL";
    }
  verification_.counts.pass -= 1;
  verification_.counts.fail += 1;
  const std::string page = verification_html(verification_);
  EXPECT_NE(page.find("The two kernels disagree"), std::string::npos);
  EXPECT_EQ(times(page, ">FAIL<"), 2) << "of the certificate and of the quantity";
  EXPECT_NE(page.find("volume differs by 9 mm3"), std::string::npos);
  EXPECT_NE(page.find("fill=\"#b3261e\""), std::string::npos);
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
  const std::string page = verification_html(verification_);
  EXPECT_NE(page.find("The two kernels agree on objects that voxels do not resolve"), std::string::npos);
  EXPECT_NE(page.find(">PASS, not resolved<"), std::string::npos);
  EXPECT_NE(page.find("smallest extent is 2.00 voxels"), std::string::npos);
  EXPECT_EQ(page.find("Observed against allowed"), std::string::npos);
}

TEST_F(VerificationPage, ObjectsWithoutACertificateAreCountedAsWithoutEvidence) {
  const Json before = to_json(verification_.counts);
  EXPECT_EQ(verification_html(verification_).find("without a certificate"), std::string::npos);
  verification_.counts.without_certificate = 2;
  const Json counts = to_json(verification_.counts);
  EXPECT_EQ(counts.at("PASS"), before.at("PASS"));
  EXPECT_EQ(counts.at("without_certificate"), 2);
  EXPECT_EQ(counts.at("without_evidence").get<int>(), before.at("without_evidence").get<int>() + 2);
  EXPECT_NE(text_of(verification_.counts).find("0 FAIL, 2 without a certificate"), std::string::npos);
  EXPECT_NE(verification_html(verification_).find("2 objects without a certificate"), std::string::npos);
}

TEST_F(VerificationPage, AmongManyTheWorstAreListed) {
  Json many = Json::array();
  for (int i = 0; i < 50; ++i) {
    Json one = verification_.answer["certificates"][0];
    one["operation"] = "question " + std::to_string(i);
    if (i == 41) one["verdict"] = "WARN";
    many.push_back(one);
  }
  verification_.answer["certificates"] = many;
  const std::string page = verification_html(verification_);
  EXPECT_NE(page.find("The 30 worst of 50 certificates"), std::string::npos);
  EXPECT_EQ(times(page, "<code>question "), 30);
  EXPECT_LT(page.find("question 41<"), page.find("question 0<"));
}

TEST_F(VerificationPage, IsWrittenBesideItsJson) {
  write_verification(verification_, folder_ / "out");
  std::ifstream file(folder_ / "out" / "result.json");
  EXPECT_EQ(Json::parse(file), verification_.answer);
  EXPECT_GT(std::filesystem::file_size(folder_ / "out" / "report.html"), 20000U);
}

}  // namespace
}  // namespace octotomy::planner
