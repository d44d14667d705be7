// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A hole in a real skull, filled by the other side's bone.
#include <algorithm>
#include <gtest/gtest.h>

#include "planner/operation/measure/near_surfaces.h"
#include "planner/plan/evaluate.h"
#include "planner/procedure/template/procedure.h"
#include "tests/planner/ball_scan.h"
#include "tests/reference_data.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/region_mask.h"

namespace octotomy::planner {
namespace {

/// The hole's outline from the front, two millimetres wider.
const std::vector<glm::dvec2> hole_mm{{80, 108},  {84, 93},   {86, 80},  {102, 81}, {104, 95},
                                      {103, 110}, {100, 132}, {96, 131}, {85, 119}};

std::string plan_text() {
  std::string polygon;
  for (const glm::dvec2& p : hole_mm)
    polygon += (polygon.empty() ? "[" : ", [") + std::to_string(p.x) + ", " + std::to_string(p.y) + "]";
  return R"({"octotomy_plan": 1, "name": "implant", "scans": {"ct": {"path": ")" +
         std::filesystem::absolute(tests::reference_data("ct_invesalius_cranium.nii.gz")).string() +
         R"("}}, "universe": {"voxel_mm": 1.0}, "steps": [
    {"id": "clean", "do": "remove_headrest", "scan": "ct"},
    {"id": "bone", "do": "window", "scan": "clean", "low": 300},
    {"id": "mirrored", "do": "mirror", "object": "bone", "point_mm": [121, -100, 80], "normal": [1, 0, 0],
     "fit": true},
    {"id": "about", "do": "mask", "regions": [{"view": "anterior", "polygons_mm": [[)" +
         polygon + R"(]]},
      {"view": "right", "polygons_mm": [[[130, 75], [210, 75], [210, 140], [130, 140]]]}]},
    {"id": "lacking", "do": "combine", "expression": "(mirrored - bone) & about"},
    {"id": "implant", "do": "parts", "object": "lacking", "largest": 1},
    {"id": "repaired", "do": "combine", "expression": "bone | implant"}]})";
}

/// The distances of the rim from the implant, ascending: of bone within the outline that faces the hole's
/// middle, as far as it is as thick as the other side's bone.
std::vector<double> rim_gaps_mm(const Evaluation& evaluation) {
  const brep::Triangles& triangles = evaluation.object("bone").mesh.within->triangles();
  std::vector<glm::dvec3> rim_mm;
  const glm::dvec2 middle(93.0, 106.0);
  for (const auto& face : triangles.faces) {
    const glm::dvec3 &a = triangles.points_mm[face[0]], &b = triangles.points_mm[face[1]],
                     &c = triangles.points_mm[face[2]];
    const glm::dvec3 p = (a + b + c) / 3.0, across = glm::cross(b - a, c - a);
    const glm::dvec2 inward = middle - glm::dvec2(p.x, p.z);
    if (p.y > -130.0 || p.y < -210.0 || !voxel::contains({hole_mm}, {p.x, p.z})) continue;
    if (glm::dot(glm::dvec2(across.x, across.z), inward) > 0.7 * glm::length(across) * glm::length(inward))
      rim_mm.push_back(p);
  }
  const std::vector<double> depths_mm =
      signed_distances_mm(*evaluation.object("mirrored").mesh.within, rim_mm);
  std::vector<glm::dvec3> covered_mm;
  for (std::size_t i = 0; i < rim_mm.size(); ++i)
    if (depths_mm[i] < -0.3) covered_mm.push_back(rim_mm[i]);
  std::vector<double> gaps_mm = evaluation.object("implant").mesh.within->tree().distances_mm(covered_mm);
  std::sort(gaps_mm.begin(), gaps_mm.end());
  return gaps_mm;
}

void expect_no_overlap(const Evaluation& evaluation) {
  const Object &bone = evaluation.object("bone"), &implant = evaluation.object("implant");
  EXPECT_TRUE(voxel::combine(evaluation.universe,
                             voxel::Expression(bone.voxel.octree) & voxel::Expression(implant.voxel.octree))
                  .is_empty());
  EXPECT_GT(least_distance_mm(*implant.mesh.within, *bone.mesh.within, 0.5), -0.01);
  EXPECT_NEAR(implant.mesh.within->measures().volume_mm3, 7500.0, 1500.0);
}

TEST(CranialImplant, FillsTheHoleToItsRimWithoutOverlap) {
  OCTOTOMY_NEEDS_DATA("ct_invesalius_cranium.nii.gz");
  const Evaluation evaluation = evaluate(parse_plan(plan_text(), "."), {});
  for (const Object& object : evaluation.objects) {
    if (!object.certificate) continue;
    const std::string reasons = testing::PrintToString(object.certificate->reasons);
    EXPECT_EQ(object.certificate->verdict, verify::Verdict::Pass)
        << object.id << ": " << verify::verdict_text(*object.certificate) << reasons;
    EXPECT_EQ(reasons.find("% of this tissue"), std::string::npos) << object.id << reasons;
  }
  expect_no_overlap(evaluation);
  const std::vector<double> gaps_mm = rim_gaps_mm(evaluation);
  ASSERT_GT(gaps_mm.size(), 500u);
  RecordProperty("rim_points", static_cast<int>(gaps_mm.size()));
  RecordProperty("largest_gap_um", static_cast<int>(1000.0 * gaps_mm.back()));
  EXPECT_LT(gaps_mm.back(), 0.5) << gaps_mm.size() << " points, median " << gaps_mm[gaps_mm.size() / 2];
}

TEST(CranialImplant, TheProcedureKeepsTheTypedGap) {
  OCTOTOMY_NEEDS_DATA("ct_invesalius_cranium.nii.gz");
  ProcedureInput input;
  input.scan = {{"path", std::filesystem::absolute(tests::reference_data("ct_invesalius_cranium.nii.gz"))}};
  input.folder = ".";
  input.landmarks = {{"midline_front", {121, -200, 60}},
                     {"midline_back", {121, -20, 60}},
                     {"midline_top", {121, -100, 150}}};
  // Eight points about the same outline.
  for (const glm::dvec2& p : std::vector<glm::dvec2>{
           {80, 108}, {84, 93}, {86, 80}, {104, 80}, {104.5, 110}, {100, 132}, {96, 131}, {85, 119}})
    input.landmarks.push_back({"rim_" + std::to_string(input.landmarks.size() - 2), {p.x, -170.0, p.y}});
  input.values = {{"reach_mm", 40}, {"rim_gap_mm", 0.3}};
  EvaluateOptions quick;
  quick.certify = false;
  const Evaluation evaluation = evaluate(
      parse_plan(plan_of(read_procedure("mirrored_reconstruction_front"), input).dump(), "."), quick);
  expect_no_overlap(evaluation);
  const std::vector<double> gaps_mm = rim_gaps_mm(evaluation);
  ASSERT_GT(gaps_mm.size(), 500u);
  RecordProperty("median_gap_um", static_cast<int>(1000.0 * gaps_mm[gaps_mm.size() / 2]));
  EXPECT_NEAR(gaps_mm[gaps_mm.size() / 2], 0.3, 0.1);
  EXPECT_LT(gaps_mm[gaps_mm.size() * 99 / 100], 0.5);
}

}  // namespace
}  // namespace octotomy::planner
