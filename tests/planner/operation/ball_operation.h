// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cmath>
#include <gtest/gtest.h>
#include <string>

#include "planner/plan/evaluate.h"
#include "tests/planner/ball_scan.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::tests {

constexpr double ball_radius_mm = 20.0;
/// The radius of balls for tests that certify many answers; they have an eighth of the voxels.
constexpr double small_radius_mm = 10.0;

/// A plan on a ball about the origin, in voxels of 1 mm: the object "ball", then the steps. The scan is 3.2
/// radii a side.
inline planner::Plan ball_plan(const ScratchFolder& folder, const std::string& steps,
                               double radius_mm = ball_radius_mm) {
  voxel::write_scene(ball_scene(radius_mm, static_cast<int>(std::lround(3.2 * radius_mm))),
                     folder / "ball.nrrd");
  return planner::parse_plan(R"({"octotomy_plan": 1, "name": "ball", "scans": {"ct": {"path": "ball.nrrd"}},
      "universe": {"voxel_mm": 1.0}, "steps": [{"id": "ball", "do": "window", "scan": "ct", "low": 0}, )" +
                                 steps + "]}",
                             folder.path());
}

/// Expects the volume of both kernels within `share` of the truth, and a certificate that passes.
inline void expect_certified(const planner::Object& object, double truth_mm3, double share) {
  EXPECT_NEAR(object.voxel.measures.volume_mm3 / truth_mm3, 1.0, share) << object.id;
  ASSERT_TRUE(object.mesh.within) << object.id << testing::PrintToString(object.findings);
  EXPECT_NEAR(object.mesh.within->measures().volume_mm3 / truth_mm3, 1.0, share) << object.id;
  ASSERT_TRUE(object.certificate) << object.id;
  EXPECT_EQ(verify::to_string(object.certificate->verdict), "PASS")
      << object.id << testing::PrintToString(object.certificate->reasons);
}

/// Expects the volume of both kernels within `share` of the truth, and a certificate that states that one
/// code made both answers, so that their agreement is no PASS.
inline void expect_not_independent(const planner::Object& object, double truth_mm3, double share) {
  EXPECT_NEAR(object.voxel.measures.volume_mm3 / truth_mm3, 1.0, share) << object.id;
  ASSERT_TRUE(object.mesh.within) << object.id << testing::PrintToString(object.findings);
  EXPECT_NEAR(object.mesh.within->measures().volume_mm3 / truth_mm3, 1.0, share) << object.id;
  ASSERT_TRUE(object.certificate) << object.id;
  EXPECT_EQ(verify::to_string(object.certificate->verdict), "WARN") << object.id;
  const std::string reasons = testing::PrintToString(object.certificate->reasons);
  EXPECT_NE(reasons.find("not independent"), std::string::npos) << object.id << reasons;
}

/// The refusal of a plan with these steps; empty if it is read.
inline std::string ball_refusal(const ScratchFolder& folder, const std::string& steps) {
  try {
    ball_plan(folder, steps);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

/// The refusal of a plan with these steps when it is read or its objects are made; empty if they are made.
inline std::string made_refusal(const ScratchFolder& folder, const std::string& steps) {
  try {
    planner::EvaluateOptions options;
    options.certify = false;
    planner::evaluate(ball_plan(folder, steps), options);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

/// Steps for the caps "upper", above 5 mm, and "lower", below -5 mm; then further ones.
inline std::string ball_caps(const std::string& more) {
  return R"({"id": "high", "do": "mask", "regions": [{"view": "anterior",
          "polygons_mm": [[[-30, 5], [30, 5], [30, 30], [-30, 30]]]}]},
      {"id": "low", "do": "mask", "regions": [{"view": "anterior",
          "polygons_mm": [[[-30, -5], [30, -5], [30, -30], [-30, -30]]]}]},
      {"id": "upper", "do": "combine", "expression": "ball & high"},
      {"id": "lower", "do": "combine", "expression": "ball & low"}, )" +
         more;
}

}  // namespace octotomy::tests
