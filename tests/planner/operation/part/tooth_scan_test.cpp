// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A scan of a ball's cap, with a bump that the ball does not have, stands for a scan of teeth.
#include <cmath>
#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "brep/io/write_mesh.h"
#include "brep/shape/scan_blend.h"
#include "planner/operation/table/json.h"
#include "tests/brep/shapes.h"
#include "tests/planner/operation/altered.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

constexpr double bump_mm = 0.5;

/// The cap above z = 9 mm of a ball of the plan's radius, in a pose of its own. Within 4 mm of the axis it
/// rises by the bump.
void write_cap(const std::filesystem::path& path) {
  brep::Triangles ball = brep::shapes::sphere({0, 0, 0}, ball_radius_mm, 5);
  std::erase_if(ball.faces, [&](const auto& face) { return ball.points_mm[face[0]].z < 9.0; });
  for (glm::dvec3& p : ball.points_mm) {
    const double off_axis = std::min(std::hypot(p.x, p.y) / 4.0, 1.0);
    if (p.z > 0.0) p *= 1.0 + bump_mm / ball_radius_mm * std::pow(1.0 - off_axis * off_axis, 2.0);
    p = glm::dvec3(-p.y + 100.0, p.x, p.z - 7.0);
  }
  brep::write_mesh(brep::mesh_of(ball), path);
}

/// Three places on the ball at z = 18, and the same on the scan.
const std::string cap_points =
    R"("points": [[8.7, 0, 18], [-4.35, 7.53, 18], [-4.35, -7.53, 18]],
       "scan_points": [[100, 8.7, 11], [92.47, -4.35, 11], [107.53, -4.35, 11]])";

std::string scan_step(const std::string& path, const std::string& points, const std::string& more = "") {
  return R"({"id": "sharp", "do": "tooth_scan", "object": "ball", "path": ")" + path + "\", " + points +
         more + "}";
}

TEST(ToothScanStep, TheScansBumpStandsOnTheObjectAndTheResultSaysWhichPartIsTheScans) {
  const ScratchFolder folder;
  write_cap(folder / "cap.stl");
  const Evaluation made = evaluate(ball_plan(folder, scan_step("cap.stl", cap_points)), {});
  const Object &ball = made.objects.at("ball"), &sharp = made.objects.at("sharp");
  ASSERT_TRUE(sharp.mesh.within);
  const brep::Size &before = ball.mesh.within->size(), &after = sharp.mesh.within->size();
  EXPECT_NEAR(after.high_mm.z, ball_radius_mm + bump_mm, 0.1);
  EXPECT_NEAR(before.high_mm.z, ball_radius_mm, 0.1);
  // Below the depth nothing moves.
  EXPECT_NEAR(after.low_mm.z, before.low_mm.z, 1e-9);
  EXPECT_NEAR(after.volume_mm3 - before.volume_mm3, bump_mm * M_PI * 16.0 / 3.0, 12.0);
  EXPECT_EQ(sharp.mesh.within->components().size(), 1u);
  const nlohmann::ordered_json& from = sharp.mesh.details.at("surface_from");
  const double scan = from.at("scan_mm2").get<double>(), border = from.at("border_mm2").get<double>(),
               object = from.at("object_mm2").get<double>();
  // Caps of a sphere: 2 pi r h, from the top to 3.5 and to 5 mm below the plane of the points.
  EXPECT_NEAR(scan, 2.0 * M_PI * ball_radius_mm * 5.5, 45.0);
  EXPECT_NEAR(border, 2.0 * M_PI * ball_radius_mm * 1.5, 45.0);
  EXPECT_NEAR(scan + border + object, after.area_mm2, 1.0);
  ASSERT_TRUE(sharp.certificate);
  EXPECT_NE(verify::to_string(sharp.certificate->verdict), "FAIL")
      << testing::PrintToString(sharp.certificate->reasons);
}

/// The answer with what lies within `radius_mm` of the top of the axis moved outward.
Answer with_moved_cusp(const Evaluation& made, const std::string& id, double radius_mm, double by_mm) {
  brep::Triangles mesh = made.object(id).mesh.within.value().triangles();
  std::size_t moved = 0;
  for (glm::dvec3& p : mesh.points_mm) {
    if (p.z < 0.0 || std::hypot(p.x, p.y) > radius_mm) continue;
    p += by_mm * glm::normalize(p);
    ++moved;
  }
  EXPECT_GT(moved, 100u);
  brep::Solid solid = brep::trusted_solid(std::move(mesh), brep::Proof::Connection);
  voxel::Octree voxels = convert::voxelise(made.universe, solid.linked());
  return {std::move(voxels), std::move(solid)};
}

TEST(ToothScanStep, AMovedCuspFailsInEitherKernelAndOneWithinTheAllowanceDoesNot) {
  const ScratchFolder folder;
  write_cap(folder / "cap.stl");
  const Evaluation made = evaluate(ball_plan(folder, scan_step("cap.stl", cap_points)), {});
  constexpr double cusp_mm = 5.0;
  for (const double by_mm : {-0.9, 0.9})
    expect_fails_as(made, "sharp", with_moved_cusp(made, "sharp", cusp_mm, by_mm), "moved cusp");
  const double allowance_mm = brep::scan_blend_allowance_mm({});
  for (const double by_mm : {-2.0 * allowance_mm, 2.0 * allowance_mm}) {
    const verify::Certificate moved =
        altered_certificate(made, "sharp", with_moved_cusp(made, "sharp", cusp_mm, by_mm), Altered::Mesh);
    EXPECT_EQ(verify::to_string(moved.verdict), "FAIL") << by_mm << testing::PrintToString(moved.reasons);
  }
  const verify::Certificate right = altered_certificate(
      made, "sharp", with_moved_cusp(made, "sharp", cusp_mm, 0.25 * allowance_mm), Altered::Mesh);
  EXPECT_NE(verify::to_string(right.verdict), "FAIL") << testing::PrintToString(right.reasons);
}

TEST(ToothScanStep, CellsThatAreTypedAreUsed) {
  const ScratchFolder folder;
  write_cap(folder / "cap.stl");
  EvaluateOptions options;
  options.certify = false;
  const auto faces = [&](const std::string& more) {
    return evaluate(ball_plan(folder, scan_step("cap.stl", cap_points, more)), options)
        .objects.at("sharp")
        .mesh.whole->triangles()
        .faces.size();
  };
  EXPECT_GT(faces(R"(, "cell_mm": 0.4)"), 2 * faces(R"(, "cell_mm": 0.8)"));
  EXPECT_NE(ball_refusal(folder, scan_step("cap.stl", cap_points, R"(, "cell_mm": 0.01)")).find("cell_mm"),
            std::string::npos);
}

TEST(ToothScanStep, RefusesAScanThatDoesNotFitInASentenceThatSaysWhy) {
  const ScratchFolder folder;
  write_cap(folder / "cap.stl");
  const auto expect_refused_with = [&](const std::string& step, const std::string& words) {
    const std::string refused = made_refusal(folder, step);
    EXPECT_NE(refused.find(words), std::string::npos) << refused;
  };
  expect_refused_with(scan_step("cap.stl", R"("points": [[8.7, 0, 18], [-4.35, 7.53, 18]],
      "scan_points": [[100, 8.7, 11], [92.47, -4.35, 11]])"),
                      "points");
  expect_refused_with(scan_step("cap.stl", cap_points, R"(, "unit": "m")"), "its unit is probably");
  expect_refused_with(scan_step("cap.stl", cap_points, R"(, "unit": "um")"), "its unit is probably");
  expect_refused_with(scan_step("cap.stl", cap_points, R"(, "radius_mm": 5)"), "crowns");
  std::ofstream(folder / "empty.stl").flush();
  expect_refused_with(scan_step("empty.stl", cap_points), "empty.stl");
  expect_refused_with(scan_step("cap.stl", R"("points": [[8.7, 0, 28], [-4.35, 7.53, 28], [-4.35, -7.53, 28]],
      "scan_points": [[100, 8.7, 11], [92.47, -4.35, 11], [107.53, -4.35, 11]])"),
                      "mm off 'ball'");
  brep::write_mesh(brep::mesh_of(brep::shapes::sphere({500, 0, 0}, 20.0, 3)), folder / "far.stl");
  expect_refused_with(scan_step("far.stl", cap_points), "mm off 'far.stl'");
}

}  // namespace
}  // namespace octotomy::planner
