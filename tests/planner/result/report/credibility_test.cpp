// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/credibility.h"

#include <gtest/gtest.h>

#include "planner/operation/table/json.h"
#include "tests/planner/result/report/page_data.h"

namespace octotomy::planner {
namespace {

/// The results of a run with one certified object and one size.
Json run() {
  return Json::parse(R"({"octotomy": "1", "plan": {"name": "p <q>"}, "universe": {"voxel_mm": [1, 1, 1]},
    "scans": [{"name": "ct", "modality": "CT", "sha256": "ab", "spacing_mm": [1, 1, 1],
               "audit": [{"check": "unit", "verdict": "PASS", "detail": "HU"}]}],
    "signatures": [{"by": "A. Reader", "changed_since": []}],
    "counts": {"PASS": 1, "WARN": 0, "FAIL": 0},
    "certificates": [{"object": "skull", "tier": "bounded", "verdict": "PASS", "resolved": true,
                      "detection_limit": {"volume_mm3": 4, "shift_mm": 0.1}}],
    "measurements": [{"id": "size", "object": "skull", "volume_mm3": 10,
        "volume": {"value": 10, "unit": "mm3", "half_width": 1, "coverage": 0.99, "sources": [{"name": "blur"}]}}]})");
}

const Json& factor(const Json& credibility, const std::string& name) {
  for (const Json& one : credibility.at("credibility_factors"))
    if (one.at("factor") == name) return one;
  throw std::runtime_error(name);
}

TEST(Credibility, ANumberNamesTheChecksThatThisRunDidForIt) {
  const Json made = credibility_json(run());
  ASSERT_EQ(made.at("numbers").size(), 1u);
  const Json& number = made.at("numbers")[0];
  EXPECT_EQ(number.at("quantity"), "volume of skull");
  ASSERT_EQ(number.at("supported_by").size(), 2u);
  EXPECT_EQ(number.at("supported_by")[0].at("sources")[0], "blur");
  EXPECT_EQ(number.at("supported_by")[1].at("object"), "skull");
  EXPECT_TRUE(number.at("gaps").empty());
  EXPECT_EQ(made.at("unsupported"), 0);
  EXPECT_EQ(made.at("credibility_factors").size(), 13u);
  EXPECT_EQ(factor(made, "use error").at("evidence")[0].at("by"), "A. Reader");
}

TEST(Credibility, WhatOnlyPeopleCanStateIsNullAndWhatWasNotDoneIsAGap) {
  const Json made = credibility_json(run());
  EXPECT_TRUE(made.at("question_of_interest").at("statement").is_null());
  EXPECT_TRUE(made.at("model_risk").at("model_influence").is_null());
  for (const char* name :
       {"numerical code verification", "model form", "output comparison", "test samples"}) {
    EXPECT_TRUE(factor(made, name).at("evidence").empty()) << name;
    EXPECT_TRUE(factor(made, name).at("gap").is_string()) << name;
  }
}

TEST(Credibility, WithoutItsChecksANumberLosesItsSupport) {
  Json bare = run();
  bare["certificates"] = Json::array();
  bare["signatures"][0]["changed_since"] = {"the plan"};
  bare["measurements"][0]["volume"]["half_width"] = nullptr;
  const Json made = credibility_json(bare);
  EXPECT_TRUE(made.at("numbers")[0].at("supported_by").empty());
  EXPECT_EQ(made.at("numbers")[0].at("gaps").size(), 2u);
  EXPECT_EQ(made.at("unsupported"), 1);
  EXPECT_TRUE(factor(made, "discretization error").at("evidence").empty());
  EXPECT_TRUE(factor(made, "use error").at("evidence").empty()) << "a signature of another plan is none";
}

TEST(Credibility, AFailedCertificateContradictsAndAnUnresolvedOneIsAGap) {
  Json failed = run();
  failed["certificates"][0]["verdict"] = "FAIL";
  Json made = credibility_json(failed);
  EXPECT_EQ(made.at("numbers")[0].at("contradicted_by").size(), 1u);
  EXPECT_EQ(made.at("unsupported"), 1);
  Json thin = run();
  thin["certificates"][0]["resolved"] = false;
  made = credibility_json(thin);
  EXPECT_NE(made.at("numbers")[0].at("gaps").dump().find("not resolved"), std::string::npos);
}

const Json& number(const Json& credibility, const std::string& quantity) {
  for (const Json& one : credibility.at("numbers"))
    if (one.at("quantity") == quantity) return one;
  throw std::runtime_error(quantity + " is not told of in " + credibility.at("numbers").dump());
}

TEST(Credibility, ContactsNameTheOtherKernelAndWhatNothingChecks) {
  Json told = run();
  told["measurements"].push_back(Json::parse(R"({"id": "bite", "object": "skull", "against": "jaw",
    "contacts": [{"nearest_mm": 0.1, "voxel_nearest_mm": 0.4, "half_width_mm": 0.5},
                 {"nearest_mm": 0.1, "voxel_nearest_mm": 0.9, "half_width_mm": 0.5},
                 {"nearest_mm": 0.1, "voxel_nearest_mm": null, "half_width_mm": 0.5}],
    "certain_count": 2, "area_mm2": 4.0, "overlap_mm3": 0.0})"));
  const Json made = credibility_json(told);
  const Json& first = number(made, "nearest at contact 1 of skull and jaw");
  ASSERT_EQ(first.at("supported_by").size(), 3u);
  EXPECT_EQ(first.at("supported_by")[1].at("check"), "the other kernel's answer");
  EXPECT_NE(first.at("gaps").dump().find("'jaw' has no certificate"), std::string::npos);
  EXPECT_EQ(number(made, "nearest at contact 2 of skull and jaw").at("contradicted_by").size(), 1u);
  EXPECT_NE(number(made, "nearest at contact 3 of skull and jaw").at("gaps").dump().find("one kernel"),
            std::string::npos);
  told["measurements"][1]["area_mm2"] = nullptr;
  const Json of_voxels = credibility_json(told);
  EXPECT_EQ(number(of_voxels, "nearest at contact 1 of skull and jaw").at("supported_by").size(), 2u)
      << "voxels do not vouch for themselves";
  for (const char* quantity : {"contacts of skull and jaw that are certain",
                               "area in contact of skull and jaw", "overlap of skull and jaw"})
    EXPECT_EQ(number(made, quantity).at("gaps").size(), 2u) << quantity;
  EXPECT_EQ(made.at("unsupported"), 1) << "the second contact's alone";
}

TEST(Credibility, AirwaysHaveTheirIntervalsAndTheOtherKernel) {
  Json told = run();
  told["measurements"].push_back(Json::parse(R"({"id": "narrow", "object": "air", "airway": {
    "volume_mm3": 900, "volume_half_width_mm3": 20, "volume_mesh_mm3": 910, "length_mm": 40,
    "narrowest": {"area_mm2": 15, "half_width_mm2": 2, "mesh_mm2": 15, "voxel_mm2": 12,
                  "half_width_terms": [{"name": "voxels"}]}}})"));
  const Json made = credibility_json(told);
  EXPECT_EQ(number(made, "airway volume of air").at("supported_by").size(), 2u);
  EXPECT_EQ(number(made, "narrowest section of air").at("contradicted_by")[0].at("difference"), 3.0);
  told["measurements"][1]["airway"]["narrowest"]["mesh_mm2"] = nullptr;
  const Json alone = credibility_json(told);
  EXPECT_EQ(number(alone, "narrowest section of air").at("supported_by").size(), 1u) << "the interval alone";
  EXPECT_TRUE(number(made, "centre line's length of air").at("supported_by").empty());
  EXPECT_EQ(made.at("unsupported"), 2);
}

TEST(Credibility, TrialsSupportWhatTheyDoubtAndNameTheirErrors) {
  EXPECT_NE(factor(credibility_json(run()), "model inputs").at("gap").dump().find("trials step"),
            std::string::npos);
  Json told = run();
  told["measurements"].push_back(Json::parse(R"({"id": "doubt", "trials": 1000, "seed": 3,
    "errors": {"seating_mm": 0.5}, "doubts": [{"what": "gap", "of": "rest to moved", "value": 1.5,
    "unit": "mm", "half_width": 0.9, "coverage": 0.99, "sources": [{"name": "seating", "half_width": 0.9}]}]})"));
  told["movements"] = Json::parse(R"([{"object": "skull", "pitch_deg": 1, "yaw_deg": 0, "roll_deg": 0,
    "centroid": {"forward_mm": 6, "left_mm": 0, "up_mm": 2}}])");
  const Json made = credibility_json(told);
  const Json& support = number(made, "gap of rest to moved").at("supported_by")[0];
  EXPECT_EQ(support.at("check"), "trials");
  EXPECT_EQ(support.at("sources")[0], "seating");
  EXPECT_EQ(factor(made, "model inputs").at("evidence")[1].at("seed"), 3);
  EXPECT_NE(factor(made, "model inputs").at("gap").dump().find("were typed"), std::string::npos);
  EXPECT_EQ(number(made, "forward").at("supported_by")[0].at("check"), "certificate");
  EXPECT_EQ(tests::page_data(credibility_html(made))["credibility"], made);
}

TEST(Credibility, ThePageEscapesNamesAndSaysThatItClaimsNothing) {
  const std::string page = credibility_html(credibility_json(run()));
  EXPECT_NE(page.find("p &lt;q&gt;"), std::string::npos);
  EXPECT_EQ(page.find("p <q>"), std::string::npos);
  EXPECT_NE(page.find("claims no conformity"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
