// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/report/credibility.h"

#include <gtest/gtest.h>

namespace octotomy::planner {
namespace {

using Json = nlohmann::ordered_json;

/// What a run with one certified object and one size tells.
Json run() {
  return Json::parse(R"({"octotomy": "1", "plan": {"name": "p <q>"}, "universe": {"voxel_mm": [1, 1, 1]},
    "scans": [{"name": "ct", "modality": "CT", "sha256": "ab", "spacing_mm": [1, 1, 1],
               "audit": [{"check": "unit", "verdict": "PASS", "detail": "HU"}]}],
    "signatures": [{"by": "A. Reader", "changed_since": []}],
    "counts": {"PASS": 1, "WARN": 0, "FAIL": 0},
    "certificates": [{"object": "skull", "tier": "bounded", "verdict": "PASS", "resolved": true,
                      "detection_limit": {"volume_mm3": 4, "shift_mm": 0.1}}],
    "measurements": [{"id": "size", "object": "skull",
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

TEST(Credibility, ThePageEscapesNamesAndSaysThatItClaimsNothing) {
  const std::string page = credibility_html(credibility_json(run()));
  EXPECT_NE(page.find("p &lt;q&gt;"), std::string::npos);
  EXPECT_EQ(page.find("p <q>"), std::string::npos);
  EXPECT_NE(page.find("claims no conformity"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
