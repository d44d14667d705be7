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

}  // namespace
}  // namespace octotomy::planner::serve
