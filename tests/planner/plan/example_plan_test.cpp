// SPDX-License-Identifier: AGPL-3.0-or-later
// The example plan on the head phantom, whose truth is known: the closed form cut, moved and joined point by
// point.
#include <gtest/gtest.h>
#include <map>
#include <string>

#include "planner/plan/evaluate.h"
#include "tests/planner/ball_scan.h"
#include "verify/phantom/head_phantom.h"
#include "verify/phantom/sample_volume.h"
#include "voxel/solid/expression.h"
#include "voxel/solid/region_mask.h"

namespace octotomy::planner {
namespace {

// Volumes of the objects of planner/le_fort_i.plan.json, by sampling the closed form. The cut's box is
// sampled by cells that its planes do not divide, or each plane would err by up to half a cell.
std::map<std::string, double> truths_mm3() {
  const voxel::Box cut{{-40, -90, -60}, {40, -20, -25}};
  const auto in_cut = [=](const glm::dvec3& p) {
    return glm::all(glm::greaterThanEqual(p, cut.low_mm)) && glm::all(glm::lessThanEqual(p, cut.high_mm));
  };
  const auto bone = [](const glm::dvec3& p) { return verify::head_contains(verify::HeadPart::Bone, p); };
  voxel::Motion motion;
  motion.translate_mm = {0, -6, 2};
  motion.degrees = 5;
  motion.axis = {1, 0, 0};
  motion.about_mm = {0, -40, -30};
  const glm::dmat4 still_from_moved = glm::inverse(voxel::moved_from_still(motion));
  const auto overlap = [=](const glm::dvec3& p) {
    const glm::dvec3 still(still_from_moved * glm::dvec4(p, 1.0));
    return in_cut(still) && bone(still) && bone(p) && !in_cut(p);
  };
  const voxel::Box reach{cut.low_mm - 12.0, cut.high_mm + 12.0};
  const double maxilla = verify::sample_volume(cut, 0.5, bone).volume_mm3;
  const double rest = verify::sample_volume(verify::head_bounds(), 1.0, bone).volume_mm3 - maxilla;
  return {{"maxilla", maxilla},
          {"rest", rest},
          {"advanced", maxilla},
          {"result", rest + maxilla - verify::sample_volume(reach, 0.5, overlap).volume_mm3}};
}

TEST(ExamplePlan, EachFragmentIsWithinOnePerCentOfItsTruthInBothKernels) {
  const tests::ScratchFolder folder;
  const voxel::Scene head = verify::head_phantom();
  voxel::write_scene(head, folder / "head.nrrd");
  Plan plan = read_plan(std::string(OCTOTOMY_SOURCE_DIR) + "/planner/le_fort_i.plan.json");
  plan.scans.at("ct").path = folder / "head.nrrd";
  const Evaluation evaluation = evaluate(plan);
  for (const auto& [id, truth_mm3] : truths_mm3()) {
    const Object& object = evaluation.object(id);
    EXPECT_NEAR(object.voxel.measures.volume_mm3 / truth_mm3, 1.0, 0.01) << id << " by voxels";
    ASSERT_TRUE(object.mesh.within) << id;
    EXPECT_NEAR(object.mesh.within->measures().volume_mm3 / truth_mm3, 1.0, 0.01) << id << " by meshes";
    ASSERT_TRUE(object.certificate.has_value()) << id;
    EXPECT_EQ(object.certificate->verdict, verify::Verdict::Pass) << id;
    RecordProperty(id + "_truth_mm3", std::to_string(truth_mm3));
    RecordProperty(id + "_voxel_mm3", std::to_string(object.voxel.measures.volume_mm3));
    RecordProperty(id + "_mesh_mm3", std::to_string(object.mesh.within->measures().volume_mm3));
  }
  // Advanced and raised, the piece meets the bone above it.
  EXPECT_GT(evaluation.object("overlap").voxel.measures.volume_mm3, 100.0);
}

}  // namespace
}  // namespace octotomy::planner
