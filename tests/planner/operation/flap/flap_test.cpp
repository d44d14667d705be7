// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>
#include <gtest/gtest.h>

#include "planner/operation/table/json.h"
#include "planner/plan/evaluate.h"
#include "planner/plan/plan_results.h"
#include "tests/planner/ball_scan.h"
#include "tests/planner/ct_scene.h"
#include "verify/phantom/leg_phantom.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::planner {
namespace {

/// A jaw that is a bar along x, between y = 4 and 16, z = -7 and 7.
voxel::Scene bar_scene() {
  return tests::ct_scene({120, 64, 48}, {1, 1, 1}, {-59.5, -31.5, -23.5},
                         [](const glm::ivec3& /*at*/, const glm::dvec3& p) {
                           return std::abs(p.x) < 55 && p.y > 4 && p.y < 16 && std::abs(p.z) < 7 ? 560 : 40;
                         });
}

constexpr const char* flap_fields =
    R"("curve": [[-30, 10, 0], [0, -6, 0], [30, 10, 0]], "donor": [[30, 12, 105], [33, 16, -105]],
       "start_mm": 40, "reach_mm": 10, )";
constexpr const char* still_face = R"("face": [45, 12, 105])";

/// A flap of two segments of the phantom's fibula; the second segment's face may be another one.
Plan flap_plan(const tests::ScratchFolder& folder, const std::string& second_face = still_face) {
  voxel::write_scene(bar_scene(), folder / "bar.nrrd");
  voxel::write_scene(verify::leg_phantom(), folder / "leg.nrrd");
  const std::string same = std::string(flap_fields) + still_face;
  std::string steps = R"({"id": "jaw", "do": "window", "scan": "ct", "low": 300})";
  for (const char* n : {"1", "2"}) {
    const std::string i(n), fields = std::string(flap_fields) + (i == "1" ? still_face : second_face);
    steps += R"(, {"id": "donor_)" + i + R"(", "do": "flap_scan", "scan": "leg", "segment": )" + i + ", " +
             fields + R"(}, {"id": "bone_)" + i + R"(", "do": "window", "low": 300, "scan": "donor_)" + i +
             R"("}, {"id": "between_)" + i + R"(", "do": "flap_space", "number": )" + i + ", " + same +
             R"(}, {"id": "segment_)" + i + R"(", "do": "combine", "expression": "bone_)" + i +
             " & between_" + i + R"("})";
  }
  for (const char* n : {"1", "2", "3"}) {
    const std::string k(n),
        a = k == "1"   ? "jaw"
            : k == "2" ? "bone_1"
                       : "bone_2",
        b = k == "1"   ? "bone_1"
            : k == "2" ? "bone_2"
                       : "jaw";
    steps += R"(, {"id": "slab_)" + k + R"(", "do": "flap_space", "part": "osteotomy", "number": )" + k +
             ", " + same + R"(}, {"id": "contact_)" + k + R"(", "do": "combine", "expression": ")" + a +
             " & " + b + " & slab_" + k + R"("})";
  }
  steps += R"(, {"id": "gone", "do": "flap_space", "part": "resection", "aside_mm": 12, )" + same +
           R"(}, {"id": "flap", "do": "flap", "segments": ["segment_1", "segment_2"],
               "contacts": ["contact_1", "contact_2", "contact_3"], )" +
           same + "}";
  return parse_plan(R"({"octotomy_plan": 1, "name": "flap", "scans": {"ct": {"path": "bar.nrrd"},
      "leg": {"path": "leg.nrrd"}}, "universe": {"voxel_mm": 1.0}, "steps": [)" +
                        steps + "]}",
                    folder.path());
}

Json flap_answer(const Plan& plan, const Evaluation& evaluation) {
  for (const Json& one : measurements_json(plan, evaluation))
    if (one.contains("flap_segments")) return one;
  return {};
}

constexpr double half_turn = 0.4899573262537283;  // atan(16 / 30)

TEST(FlapSteps, SegmentsAndContactsHaveTheClosedFormOfTheFibula) {
  const tests::ScratchFolder folder;
  const Plan plan = flap_plan(folder);
  const Evaluation evaluation = evaluate(plan);
  const double section = verify::LegFibula().section_mm2(), length = std::hypot(30.0, 16.0);
  for (const char* id : {"segment_1", "segment_2"}) {
    const Object& object = evaluation.object(id);
    // Its section is the same on either side of its axis, so that tilted cuts take what they leave.
    EXPECT_NEAR(object.voxel.measures.volume_mm3 / (section * length), 1.0, 0.02) << id;
    ASSERT_TRUE(object.mesh.within) << id;
    EXPECT_NEAR(object.mesh.within->measures().volume_mm3 / (section * length), 1.0, 0.01) << id;
    ASSERT_TRUE(object.certificate);
    EXPECT_EQ(verify::to_string(object.certificate->verdict), "PASS") << id;
  }
  const Json flap = flap_answer(plan, evaluation);
  ASSERT_EQ(flap.at("osteotomies").size(), 3u);
  const Json& joint = flap.at("osteotomies")[1];
  const double truth = section / std::cos(half_turn),
               lacks = joint.at("slab_lacks_at_most_mm2").get<double>();
  for (const char* key : {"contact_voxels_mm2", "contact_mesh_mm2"}) {
    EXPECT_LT(joint.at(key).get<double>(), 1.04 * truth) << key;
    EXPECT_GT(joint.at(key).get<double>(), 0.96 * (truth - lacks)) << key;
  }
  EXPECT_EQ(joint.at("verdict"), "PASS");
  EXPECT_NEAR(flap.at("flap_segments")[1].at("angle_to_last_deg").get<double>(), glm::degrees(2 * half_turn),
              1e-9);
  EXPECT_NEAR(flap.at("flap_segments")[0].at("first_cut").at("at_mm").get<double>(), 40.0, 1e-9);
  // The space of the resection is a prism between square ends: the sides of its mitre even out.
  const double octagon = 8.0 * std::tan(0.39269908169872414) * 12.0 * 12.0;
  const Object& gone = evaluation.object("gone");
  EXPECT_NEAR(gone.mesh.whole->measures().volume_mm3, 2.0 * length * octagon, 1e-6 * octagon);
  EXPECT_NEAR(gone.voxel.measures.volume_mm3 / (2.0 * length * octagon), 1.0, 0.01);
}

TEST(FlapSteps, ASegmentThatIsTwistedMeetsLessBone) {
  const tests::ScratchFolder folder;
  const Plan plan = flap_plan(folder, R"("face": [30, 27, 105])");
  EvaluateOptions quick;
  quick.certify = false;
  const Evaluation evaluation = evaluate(plan, quick);
  const Json joint = flap_answer(plan, evaluation).at("osteotomies")[1];
  const double truth = verify::LegFibula().section_mm2() / std::cos(half_turn);
  EXPECT_LT(joint.at("contact_mesh_mm2").get<double>(),
            0.96 * (truth - joint.at("slab_lacks_at_most_mm2").get<double>()));
}

TEST(FlapSteps, RefusalsPointAtThePlace) {
  const auto refusal = [](const std::string& fields) {
    const tests::ScratchFolder folder;
    try {
      parse_plan(
          R"({"octotomy_plan": 1, "name": "f", "scans": {"ct": {"path": "a.nrrd"}}, "steps": [
              {"id": "p", "do": "window", "scan": "ct", "low": 0}, {"id": "q", "do": "window", "scan": "ct", "low": 0},
              {"id": "a", )" +
              fields + "}]}",
          folder.path());
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string same = std::string(flap_fields) + still_face;
  EXPECT_NE(refusal(R"("do": "flap_scan", "scan": "ct", "segment": 3, )" + same).find("which has 2 segments"),
            std::string::npos);
  EXPECT_NE(refusal(R"("do": "flap_space", "part": "osteotomy", "number": 4, )" + same).find("number"),
            std::string::npos);
  EXPECT_NE(refusal(R"("do": "flap_space", "part": "resection", "aside_mm": 70, )" + same).find("aside_mm"),
            std::string::npos);
  EXPECT_NE(refusal(R"("do": "flap", "segments": [], "contacts": [], )" + same).find("segments"),
            std::string::npos);
  const std::string two = R"("do": "flap", "segments": ["p", "q"], "contacts": ["p"], )";
  EXPECT_NE(refusal(two + same).find("must name 3 objects, one an osteotomy; without the last"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
