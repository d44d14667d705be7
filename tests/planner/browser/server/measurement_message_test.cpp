// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/measurement_message.h"

#include <gtest/gtest.h>

namespace octotomy::planner::serve {
namespace {

const Json volume{{"value", 5000.0}, {"unit", "mm3"}, {"half_width", 10.0}};

TEST(MeasurementMessage, AQuestionOfTheSurfaceIsAnsweredByItsOwnNumber) {
  const Json told = measurement_message(
      {{"id", "way"}, {"object", "bone"}, {"volume", volume}, {"along", {{"length_mm", 31.5}}}});
  EXPECT_EQ(told["value"], 31.5);
  EXPECT_EQ(told["unit"], "mm");
  const Json section = measurement_message(
      {{"id", "cut"}, {"object", "bone"}, {"volume", volume}, {"section", {{"area_mm2", 120.0}}}});
  EXPECT_EQ(section["value"], 120.0);
  EXPECT_EQ(section["unit"], "mm2");
}

TEST(MeasurementMessage, AQuestionWithoutAnAnswerIsNotAnsweredByTheVolume) {
  for (const char* key : {"along", "section", "thickness", "curvature"}) {
    const Json told =
        measurement_message({{"id", "q"}, {"object", "bone"}, {"volume", volume}, {key, nullptr}});
    EXPECT_TRUE(told["value"].is_null()) << key;
    EXPECT_NE(told["unit"], "mm3") << key;
    EXPECT_NE(told["sentence"].get<std::string>().find("no answer yet"), std::string::npos)
        << told["sentence"];
  }
}

TEST(MeasurementMessage, ASizeIsTheVolume) {
  const Json told = measurement_message({{"id", "size"}, {"object", "bone"}, {"volume", volume}});
  EXPECT_EQ(told["value"], 5000.0);
  EXPECT_EQ(told["unit"], "mm3");
}

TEST(MeasurementMessage, AResultWithATableIsShownByItsFirstNumber) {
  const Json narrow{{"area_mm2", 88.5}, {"half_width_mm2", 3.5}};
  const Json airway = measurement_message({{"id", "narrow"},
                                           {"object", "air"},
                                           {"airway", {{"narrowest", narrow}}},
                                           {"findings", Json::array()}});
  EXPECT_EQ(airway["value"], 88.5);
  EXPECT_EQ(airway["half_width"], 3.5);
  EXPECT_EQ(airway["unit"], "mm2");
  EXPECT_EQ(airway["details"]["airway"]["narrowest"], narrow);
  const Json contacts = measurement_message({{"id", "bite"},
                                             {"object", "lower"},
                                             {"against", "upper"},
                                             {"contacts", Json::array({{{"nearest_mm", 0.2}}})},
                                             {"nearest_mm", 0.2}});
  EXPECT_EQ(contacts["value"], 0.2);
  EXPECT_EQ(contacts["says"], "1 contact of lower with upper, the nearest");
  const Json trials = measurement_message(
      {{"id", "doubt"},
       {"doubts",
        Json::array(
            {{{"what", "angle"}, {"of", "SNA"}, {"value", 82.0}, {"unit", "deg"}, {"half_width", 1.5}}})}});
  EXPECT_EQ(trials["value"], 82.0);
  EXPECT_EQ(trials["half_width"], 1.5);
  EXPECT_EQ(trials["unit"], "deg");
}

TEST(MeasurementMessage, ATableWithoutItsNumberStatesWhy) {
  const Json apart =
      measurement_message({{"id", "differ"},
                           {"a", "one"},
                           {"b", "two"},
                           {"mean_mm", nullptr},
                           {"findings", Json::array({"'one' has no mesh, see its findings"})}});
  EXPECT_TRUE(apart["value"].is_null());
  EXPECT_NE(apart["sentence"].get<std::string>().find("'one' has no mesh"), std::string::npos)
      << apart["sentence"];
  const Json guesses = measurement_message(
      {{"id", "guess"}, {"object", "skull"}, {"landmarks", Json::array()}, {"missing", Json::array()}});
  EXPECT_EQ(guesses["says"], "First guess of 0 landmarks");
  EXPECT_TRUE(guesses["value"].is_null());
  EXPECT_TRUE(measurement_message({{"id", "q"}, {"object", "bone"}}).is_null());
}

}  // namespace
}  // namespace octotomy::planner::serve
