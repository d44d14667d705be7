// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/procedure/cephalometry/measured.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <numbers>

namespace octotomy::planner {
namespace {

/// A face of chosen angles: nasion at the origin, sella straight behind it, forward is -y.
std::vector<MovedLandmark> face() {
  const double down_a = glm::radians(82.0), down_b = glm::radians(79.0);
  std::vector<MovedLandmark> all;
  const auto add = [&](const char* name, const glm::dvec3& p_mm) {
    all.push_back({{name, p_mm}, glm::dmat4(1.0)});
  };
  add("sella", {0, 70, 0});
  add("nasion", {0, 0, 0});
  add("a_point", {3, 60 * std::cos(down_a), -60 * std::sin(down_a)});
  add("b_point", {-2, 100 * std::cos(down_b), -100 * std::sin(down_b)});
  add("pogonion", {0, 25, -115});
  add("menton", {4, 30, -120});
  add("ans", {0, 2, -55});
  add("porion_left", {60, 90, -25});
  add("porion_right", {-60, 90, -25});
  add("orbitale_left", {32, 12, -25});
  add("orbitale_right", {-32, 12, -25});
  add("incisor", {1.5, 3, -82});
  add("lower_incisor", {0, 6, -79});
  add("molar_left", {25, 35, -80});
  add("molar_right", {-25, 35, -82});
  return all;
}

const CephalometricResult& of(const CephalometricResults& results, const std::string& name) {
  for (const CephalometricResult& result : results.measured)
    if (result.measure.name == name) return result;
  throw std::runtime_error("not measured: " + name);
}

CephalometricResults measure(const std::vector<MovedLandmark>& landmarks,
                             const glm::dmat3& head = glm::dmat3(1.0), const LandmarkDoubt& doubt = {}) {
  return measured(read_cephalometry("lateral"), landmarks, head, doubt);
}

TEST(Cephalometry, ValuesAreThoseOfTheFaceThatWasMade) {
  const CephalometricResults found = measure(face());
  EXPECT_NEAR(of(found, "SNA").before.value, 82.0, 1e-9);
  EXPECT_NEAR(of(found, "SNB").before.value, 79.0, 1e-9);
  EXPECT_NEAR(of(found, "ANB").before.value, 3.0, 1e-9);
  EXPECT_NEAR(of(found, "overjet").before.value, 3.0, 1e-9);
  EXPECT_NEAR(of(found, "overbite").before.value, 3.0, 1e-9);
  EXPECT_NEAR(of(found, "lower facial height").before.value, std::hypot(28.0, 65.0), 1e-9);
  EXPECT_NEAR(of(found, "lower share of facial height").before.value,
              100.0 * std::hypot(28.0, 65.0) / std::hypot(30.0, 120.0), 1e-9);
  EXPECT_NEAR(of(found, "A to nasion's vertical").before.value, -60 * std::cos(glm::radians(82.0)), 1e-9);
  EXPECT_NEAR(of(found, "upper mid-line").before.value, 1.5, 1e-9);
  EXPECT_NEAR(of(found, "chin mid-line").before.value, 4.0, 1e-9);
  EXPECT_NEAR(of(found, "occlusal cant").before.value, glm::degrees(std::atan2(2.0, 50.0)), 1e-9);
  // The profile is convex: A before the line from nasion to pogonion.
  EXPECT_GT(of(found, "convexity").before.value, 5.0);
  EXPECT_FALSE(of(found, "SNA").after);
}

TEST(Cephalometry, LipsAreMeasuredFromTheLineOfNoseAndChinAndForwardIsPositive) {
  std::vector<MovedLandmark> skin = face();
  const auto add = [&](const char* name, const glm::dvec3& p_mm) {
    skin.push_back({{name, p_mm}, glm::dmat4(1.0)});
  };
  // The line from nose to chin falls 4 in 3; the lips lie 4 mm behind it and 1 mm before it, square to the line.
  add("pronasale", {0, -30, -40});
  add("soft_pogonion", {0, 15, -100});
  add("upper_lip", {1, -30 + 0.4 * 45 + 4 * 0.8, -40 - 0.4 * 60 + 4 * 0.6});
  add("lower_lip", {0, -30 + 0.7 * 45 - 0.8, -40 - 0.7 * 60 - 0.6});
  // The septum's skin points forward.
  add("subnasale", {0, -10, -50});
  add("columella", {0, -20, -50});
  const CephalometricResults found = measure(skin);
  EXPECT_NEAR(of(found, "upper lip to E-line").before.value, -4.0, 1e-9);
  EXPECT_NEAR(of(found, "lower lip to E-line").before.value, 1.0, 1e-9);
  const glm::dvec2 lip(-30 + 0.4 * 45 + 4 * 0.8 + 10, -40 - 0.4 * 60 + 4 * 0.6 + 50);
  EXPECT_NEAR(of(found, "nasolabial angle").before.value, glm::degrees(std::acos(-lip.x / glm::length(lip))),
              1e-9);
}

TEST(Cephalometry, AHeadThatLiesAskewHasTheSameValues) {
  const glm::dmat3 turn(glm::rotate(glm::dmat4(1.0), 0.4, glm::normalize(glm::dvec3(1, 2, -1))));
  std::vector<MovedLandmark> askew = face();
  for (MovedLandmark& each : askew) each.landmark.p_mm = turn * each.landmark.p_mm + glm::dvec3(9, -40, 7);
  const CephalometricResults level = measure(face()), turned = measure(askew, turn);
  ASSERT_EQ(level.measured.size(), turned.measured.size());
  for (std::size_t i = 0; i < level.measured.size(); ++i)
    EXPECT_NEAR(level.measured[i].before.value, turned.measured[i].before.value, 1e-9)
        << level.measured[i].measure.name;
}

TEST(Cephalometry, WhatAPlanMovesChangesByAsMuchAndIsSurerThanTheValues) {
  std::vector<MovedLandmark> moved = face();
  for (MovedLandmark& each : moved)
    if (each.landmark.name == "incisor" || each.landmark.name == "a_point" ||
        each.landmark.name.starts_with("molar"))
      each.moved_from_still = glm::translate(glm::dmat4(1.0), glm::dvec3(-1.5, -6.0, 2.0));
  const CephalometricResults found = measure(moved);
  const CephalometricResult& overjet = of(found, "overjet");
  EXPECT_NEAR(overjet.change->value, 6.0, 1e-9);
  EXPECT_NEAR(of(found, "overbite").change->value, -2.0, 1e-9);
  EXPECT_NEAR(of(found, "upper mid-line").after->value, 0.0, 1e-9);
  EXPECT_EQ(of(found, "SNB").change->value, 0.0);
  EXPECT_EQ(of(found, "SNB").change->half_width, 0.0);
  EXPECT_LT(overjet.change->half_width, 0.3 * overjet.before.half_width);
  const double forward = glm::degrees(
      std::atan2(60 * std::sin(glm::radians(82.0)) - 2.0, 60 * std::cos(glm::radians(82.0)) - 6.0));
  EXPECT_NEAR(of(found, "SNA").after->value, forward, 1e-9);
}

TEST(Cephalometry, SkinThatNothingPredictsHasNoValueAfterTheOperation) {
  std::vector<MovedLandmark> skin = face();
  skin.push_back({{"pronasale", {0, -30, -40}}, glm::dmat4(1.0)});
  skin.push_back({{"soft_pogonion", {0, 15, -100}}, glm::dmat4(1.0)});
  skin.push_back({{"upper_lip", {0, -8, -60}}, glm::dmat4(1.0)});
  EXPECT_TRUE(measure(skin).unpredicted.empty());
  for (MovedLandmark& each : skin)
    if (each.landmark.name == "incisor")
      each.moved_from_still = glm::translate(glm::dmat4(1.0), glm::dvec3(0, -5, 0));
  const CephalometricResults open = measure(skin);
  EXPECT_FALSE(of(open, "upper lip to E-line").after);
  EXPECT_TRUE(of(open, "overjet").after);
  ASSERT_EQ(open.unpredicted.size(), 1u);
  EXPECT_EQ(open.unpredicted[0].second,
            (std::vector<std::string>{"pronasale", "soft_pogonion", "upper_lip"}));
  for (MovedLandmark& each : skin) each.is_predicted = true;
  skin.back().moved_from_still = glm::translate(glm::dmat4(1.0), glm::dvec3(0, -3, 0));
  const CephalometricResults found = measure(skin);
  EXPECT_TRUE(found.unpredicted.empty());
  // The line falls 4 in 3: forward by 3 mm is 2.4 mm square to it.
  EXPECT_NEAR(of(found, "upper lip to E-line").change->value, 2.4, 1e-9);
  // A ratio that errs by 0.5 mm forward (standard deviation) errs by 0.4 mm square to the line.
  EXPECT_LT(of(found, "upper lip to E-line").change->half_width, 0.2);
  skin.back().deviation_mm = {0, -0.5, 0};
  EXPECT_NEAR(of(measure(skin), "upper lip to E-line").change->half_width, 2.5758 * 0.4, 0.05);
}

TEST(Cephalometry, IntervalsAreThoseOfIndependentLandmarks) {
  // A distance between two landmarks, far apart, errs along its line by both errors.
  const CephalometricResults found = measure(face(), glm::dmat3(1.0), {0.8, 40000, 7});
  EXPECT_NEAR(of(found, "anterior facial height").before.half_width, 2.5758 * std::sqrt(2.0) * 0.8, 0.05);
  // The porions' line tilts by both of their errors over 120 mm; the incisor lies 82 mm below.
  EXPECT_NEAR(of(found, "upper mid-line").before.half_width,
              2.5758 * 0.8 * std::sqrt(2.0 + 2.0 * std::pow(82.0 / 120.0, 2.0)), 0.06);
  EXPECT_EQ(measure(face(), glm::dmat3(1.0), {0.0, 10, 1}).measured[0].before.half_width, 0.0);
}

TEST(Cephalometry, WhatIsNotMeasuredSaysWhichLandmarksAreLacking) {
  const CephalometricResults found = measure(face());
  for (const auto& [name, landmarks] : found.lacking) EXPECT_FALSE(landmarks.empty()) << name;
  const auto ratio = std::find_if(found.lacking.begin(), found.lacking.end(),
                                  [](const auto& each) { return each.first == "facial height ratio"; });
  ASSERT_NE(ratio, found.lacking.end());
  EXPECT_EQ(ratio->second, std::vector<std::string>{"gonion"});
  std::vector<MovedLandmark> same = face();
  same[0].landmark.p_mm = same[1].landmark.p_mm;
  EXPECT_THROW(measure(same), std::invalid_argument);
}

/// A distance that a landmark lacks, and differences of which each is of the one before with itself.
std::string chain(int differences) {
  std::string text = R"({"cephalometry": "own", "says": "s", "landmarks": [{"name": "a", "says": "s"},
    {"name": "b", "says": "s"}], "measures": [
    {"name": "m0", "says": "s", "kind": "distance", "points": ["a", "b"]})";
  for (int i = 1; i <= differences; ++i) {
    const std::string before = '"' + ("m" + std::to_string(i - 1)) + '"';
    text += R"(, {"name": "m)" + std::to_string(i) + R"(", "says": "s", "kind": "difference", "of": [)" +
            before + ", " + before + "]}";
  }
  return text + "]}";
}

TEST(Cephalometry, WhatIsLackingIsFoundOnceWhereEachMeasureNamesTheOneBeforeTwice) {
  const Cephalometry definitions = parse_cephalometry(chain(60));
  const MovedLandmark a{{"a", {0, 0, 0}}, glm::dmat4(1.0)}, b{{"b", {3, 0, 4}}, glm::dmat4(1.0)};
  const CephalometricResults found = measured(definitions, {a}, glm::dmat3(1.0));
  EXPECT_TRUE(found.measured.empty());
  ASSERT_EQ(found.lacking.size(), 61u);
  for (const auto& [name, landmarks] : found.lacking)
    EXPECT_EQ(landmarks, std::vector<std::string>{"b"}) << name;
  const CephalometricResults whole = measured(definitions, {a, b}, glm::dmat3(1.0), {1.0, 100, 1});
  ASSERT_EQ(whole.measured.size(), 61u);
  EXPECT_EQ(whole.measured[60].before.value, 0.0);
}

TEST(Cephalometry, ALandmarkThatIsNotPlacedIsTheMeanOfOthersAndErrsWithThem) {
  const Cephalometry definitions = parse_cephalometry(R"({"cephalometry": "own", "says": "s", "landmarks": [
    {"name": "left", "says": "s"}, {"name": "right", "says": "s"}, {"name": "base", "says": "s"},
    {"name": "middle", "says": "s", "mean_of": ["left", "right"]},
    {"name": "half way", "says": "s", "mean_of": ["middle", "base"]}], "measures": [
    {"name": "d", "says": "s", "kind": "distance", "plane": "space", "points": ["half way", "base"]}]})");
  const auto at = [](const char* name, const glm::dvec3& p_mm) {
    return MovedLandmark{{name, p_mm}, glm::dmat4(1.0)};
  };
  std::vector<MovedLandmark> placed{at("of nothing", {9, 9, 9}), at("left", {1, 0, 0}),
                                    at("right", {-1, 0, 0}), at("base", {0, 80, 0})};
  const LandmarkDoubt doubt{1.0, 40000, 1};
  const CephalometricValue of_means =
      measured(definitions, placed, glm::dmat3(1.0), doubt).measured[0].before;
  EXPECT_DOUBLE_EQ(of_means.value, 40.0);
  // (left + right) / 4 - base / 2 along the line.
  EXPECT_NEAR(of_means.half_width, 2.5758 * std::sqrt(1.0 / 16 + 1.0 / 16 + 1.0 / 4), 0.06);
  placed.push_back(at("half way", {0, 50, 0}));
  EXPECT_DOUBLE_EQ(measured(definitions, placed, glm::dmat3(1.0), doubt).measured[0].before.value, 30.0);
}

}  // namespace
}  // namespace octotomy::planner
