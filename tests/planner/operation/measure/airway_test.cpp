// SPDX-License-Identifier: AGPL-3.0-or-later
#include <functional>
#include <gtest/gtest.h>
#include <numbers>

#include "planner/operation/measure/airway_sections.h"
#include "planner/operation/table/json.h"
#include "planner/plan/evaluate.h"
#include "planner/plan/plan_results.h"
#include "tests/planner/ball_scan.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::planner {
namespace {

using namespace tests;
/// Samples that are at least 0 inside; `depth_mm` is how deep a point is inside, negative outside.
Json measured(const ScratchFolder& folder, const std::function<double(const glm::dvec3&)>& depth_mm,
              const std::string& airway, const std::string& more = "") {
  voxel::Scene scene = ball_scene(1.0, 72);
  auto& samples = std::get<voxel::Int16Samples>(scene.samples);
  std::size_t at = 0;
  for (int z = 0; z < 72; ++z)
    for (int y = 0; y < 72; ++y)
      for (int x = 0; x < 72; ++x)
        samples[at++] = static_cast<std::int16_t>(
            std::lround(2000.0 * std::clamp(depth_mm(scene.lattice.lps_mm({x, y, z})), -0.5, 0.5)));
  voxel::write_scene(scene, folder / "tube.nrrd");
  const Plan plan = parse_plan(R"({"octotomy_plan": 1, "name": "tube", "scans": {"ct": {"path": "tube.nrrd"}},
      "universe": {"voxel_mm": 1.0}, "steps": [{"id": "air", "do": "window", "scan": "ct", "low": 0}, )" +
                                   more + R"({"id": "way", "do": "airway", )" + airway + "}]}",
                               folder.path());
  EvaluateOptions options;
  options.certify = false;
  return measurements_json(plan, evaluate(plan, options)).back().at("airway");
}

/// Straight along an oblique axis, 8 mm wide about a waist of 5 mm, from -25 to 25 mm along it.
const glm::dvec3 axis = glm::normalize(glm::dvec3(0.3, -0.2, 1.0));
double waist_radius_mm(double along_mm) {
  return 8.0 - 3.0 * std::exp(-along_mm * along_mm / 64.0);
}
double waisted_depth_mm(const glm::dvec3& p_mm) {
  const double along = glm::dot(p_mm, axis), h = 1e-3;
  const double slope = (waist_radius_mm(along + h) - waist_radius_mm(along - h)) / (2.0 * h);
  const double across = (waist_radius_mm(along) - glm::length(p_mm - along * axis)) / std::hypot(1.0, slope);
  return std::min(across, 25.0 - std::abs(along));
}

TEST(AirwayStep, FindsAWaistOnAnObliqueAxisInBothKernels) {
  const ScratchFolder folder;
  const Json airway = measured(folder, waisted_depth_mm, R"("object": "air", "begin": [-7, 5, -23],
      "end": [7, -5, 23])");
  const Json& least = airway.at("narrowest");
  const double truth_mm2 = std::numbers::pi * 25.0, half_width = least.at("half_width_mm2");
  EXPECT_NEAR(least.at("mesh_mm2").get<double>(), truth_mm2, half_width);
  EXPECT_NEAR(least.at("voxel_mm2").get<double>(), truth_mm2, half_width);
  EXPECT_LT(half_width, 0.15 * truth_mm2);
  const Json& at = least.at("at_mm");
  EXPECT_LT(glm::length(glm::dvec3(at[0], at[1], at[2])), 1.5) << at;
  const Json& direction = least.at("direction");
  EXPECT_GT(std::abs(glm::dot(glm::dvec3(direction[0], direction[1], direction[2]), axis)), 0.995);
  double volume_mm3 = 0.0;
  for (int i = 0; i < 5000; ++i)
    volume_mm3 += 0.01 * std::numbers::pi * std::pow(waist_radius_mm(-25.0 + 0.01 * (i + 0.5)), 2);
  EXPECT_NEAR(airway.at("volume_mm3").get<double>(), volume_mm3,
              airway.at("volume_half_width_mm3").get<double>());
  EXPECT_NEAR(airway.at("volume_mesh_mm3").get<double>() / volume_mm3, 1.0, 0.02);
  // Sections between the ends are those of the closed form.
  int compared = 0;
  for (const Json& section : airway.at("sections")) {
    const Json& p = section.at("at_mm");
    const double along = glm::dot(glm::dvec3(p[0], p[1], p[2]), axis);
    if (std::abs(along) > 14.0) continue;
    const double expected = std::numbers::pi * std::pow(waist_radius_mm(along), 2);
    EXPECT_NEAR(section.at("area_mm2").get<double>() / expected, 1.0, 0.08) << along;
    ++compared;
  }
  EXPECT_GT(compared, 20);
}

TEST(AirwayStep, ABentTubeIsCutSquareToItsBend) {
  const ScratchFolder folder;
  // Three quarters of a ring of radius 22 mm, 5 mm thick: a cut along an axis would be twice as large.
  const auto depth_mm = [](const glm::dvec3& p) {
    const double to_ring = 5.0 - glm::length(glm::dvec2(std::hypot(p.x, p.z) - 22.0, p.y));
    return std::min(to_ring, std::max(p.z, -p.x));
  };
  const Json airway =
      measured(folder, depth_mm, R"("object": "air", "begin": [22, 0, 1], "end": [-1, 0, -22])");
  EXPECT_NEAR(airway.at("narrowest").at("area_mm2").get<double>(), std::numbers::pi * 25.0,
              airway.at("narrowest").at("half_width_mm2").get<double>());
  EXPECT_NEAR(airway.at("length_mm").get<double>(), 1.5 * std::numbers::pi * 22.0, 7.0);
}

TEST(AirwayStep, RefusesEndsBesideItAndPartsThatDoNotMeet) {
  const ScratchFolder folder;
  const auto refusal = [&](const std::string& airway) -> std::string {
    try {
      measured(
          folder, [](const glm::dvec3& p) { return std::abs(p.z) - 5.0; }, airway);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal(R"("object": "air", "begin": [0, 0, -10], "end": [0, 0, 10])").find("no path through"),
            std::string::npos);
  const std::string beside = refusal(R"("object": "air", "begin": [0, 0, -10], "end": [90, 0, 10])");
  EXPECT_NE(beside.find("step 'way': the passage is farther than 5 mm"), std::string::npos) << beside;
  EXPECT_NE(refusal(R"("object": "air", "begin": [0, 0, 10], "end": [1, 0, 10])").find("shorter than"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
