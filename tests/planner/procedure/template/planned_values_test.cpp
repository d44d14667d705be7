// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/procedure/template/planned_values.h"

#include <gtest/gtest.h>
#include <random>

#include "planner/operation/table/json.h"
#include "tests/planner/procedure/template/on_the_head.h"

namespace octotomy::planner {
namespace {

using tests::head_input, tests::head_landmarks;

const glm::dmat3 upright(1.0);

/// The steps of a plan of the procedure on the head phantom.
Json steps_with(const Procedure& procedure, const std::map<std::string, double>& values) {
  ProcedureInput input = head_input();
  for (const ProcedureScan& scan : procedure.scans) input.further_scans[scan.name] = {{"path", "leg.nrrd"}};
  input.values = values;
  return plan_of(procedure, input).at("steps");
}

std::map<std::string, PlannedValue> read_from(
    const Procedure& procedure, const Json& steps,
    const std::vector<brep::Landmark>& landmarks = head_landmarks()) {
  return planned_values(procedure, steps, [&] { return coordinates_of(landmarks, upright); });
}

Json& step_of(Json& steps, const std::string& id) {
  return *std::find_if(steps.begin(), steps.end(), [&](const Json& step) { return step.at("id") == id; });
}

TEST(PlannedValues, OfEveryProcedureAreThoseThatWereTyped) {
  for (const std::string& name : procedures()) {
    const Procedure procedure = with_all_options(read_procedure(name));
    int made_count = 0;
    for (int seed = 0; seed < 20; ++seed) {
      SCOPED_TRACE(name + ", seed " + std::to_string(seed));
      std::mt19937 random(static_cast<unsigned>(seed));
      std::map<std::string, double> typed;
      for (const ProcedureValue& value : procedure.values) {
        // Within a fifth of the range about the default; two decimals, as people type.
        const double reach = 0.2 * (value.most - value.least);
        const double number = value.preset + std::uniform_real_distribution(-reach, reach)(random);
        typed[value.name] = std::round(100.0 * std::clamp(number, value.least, value.most)) / 100.0;
        if (value.name == "by_symmetry") typed[value.name] = seed % 2;
      }
      Json steps;
      try {
        steps = steps_with(procedure, typed);
      } catch (const std::runtime_error&) {
        continue;  // these values together make no plan
      }
      ++made_count;
      const std::map<std::string, PlannedValue> read = read_from(procedure, steps);
      for (const auto& [value, number] : typed) {
        ASSERT_TRUE(read.contains(value)) << value << ": no step states it";
        EXPECT_NEAR(read.at(value).value, number, 1e-9) << value;
        EXPECT_TRUE(read.at(value).is_agreed) << value;
      }
    }
    EXPECT_GE(made_count, 5) << name;
  }
}

TEST(PlannedValues, AreThoseOfEditedSteps) {
  const Procedure procedure = read_procedure("le_fort_i");
  Json steps = steps_with(procedure, {{"forward_mm", 5}, {"kerf_mm", 0.7}});
  step_of(steps, "maxilla_moved")["by"]["forward_mm"] = 7.25;
  step_of(steps, "maxilla_moved")["by"].erase("up_mm");
  // A corner of the cut that was dragged is outvoted.
  step_of(steps, "below_cut_and_kerf")["regions"][1]["polygons_mm"][0][7][1] = -22.0;
  const auto read = read_from(procedure, steps);
  EXPECT_EQ(read.at("forward_mm").value, 7.25);
  EXPECT_TRUE(read.at("forward_mm").is_agreed);
  EXPECT_EQ(read.at("kerf_mm").value, 0.7);
  EXPECT_FALSE(read.at("kerf_mm").is_agreed) << "the dragged corner states another one";
  EXPECT_FALSE(read.contains("up_mm"));
}

TEST(PlannedValues, DoNotFollowALandmarkThatWasPlacedAgain) {
  const Procedure procedure = read_procedure("le_fort_i");
  const Json steps = steps_with(procedure, {{"kerf_mm", 0.7}, {"up_mm", 3}});
  std::vector<brep::Landmark> moved = head_landmarks();
  for (brep::Landmark& landmark : moved) landmark.p_mm += glm::dvec3(1.5, -2.0, 4.0);
  const auto read = read_from(procedure, steps, moved);
  EXPECT_EQ(read.at("kerf_mm").value, 0.7);
  EXPECT_TRUE(read.at("kerf_mm").is_agreed);
  EXPECT_EQ(read.at("up_mm").value, 3.0);
}

TEST(PlannedValues, BesideALandmarkAloneAreToBeCheckedOnceItWasPlacedAgain) {
  const Procedure procedure = read_procedure("genioplasty");
  const Json steps = steps_with(procedure, {{"below_foramen_mm", 7}});
  EXPECT_EQ(read_from(procedure, steps).at("below_foramen_mm").value, 7.0);
  EXPECT_TRUE(read_from(procedure, steps).at("below_foramen_mm").is_agreed);
  std::vector<brep::Landmark> moved = head_landmarks();
  for (brep::Landmark& landmark : moved)
    if (landmark.name != "pogonion") landmark.p_mm.z += 2.0;
  const PlannedValue read = read_from(procedure, steps, moved).at("below_foramen_mm");
  EXPECT_EQ(read.value, 9.0) << "the cut lies 9 mm below the present place";
  EXPECT_FALSE(read.is_agreed);
}

TEST(PlannedValues, OfStepsThatAreGoneAreLeftOut) {
  const Procedure procedure = read_procedure("le_fort_i");
  Json kept = Json::array();
  for (const Json& step : steps_with(procedure, {{"forward_mm", 5}, {"bone_low", 420}}))
    if (step.at("id") != "maxilla_moved") kept.push_back(step);
  const auto read = read_from(procedure, kept);
  EXPECT_FALSE(read.contains("forward_mm"));
  EXPECT_EQ(read.at("bone_low").value, 420.0);
  EXPECT_TRUE(read_from(procedure, Json::array()).empty());
}

}  // namespace
}  // namespace octotomy::planner
