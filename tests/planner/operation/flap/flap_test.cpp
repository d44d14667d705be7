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
  EXPECT_NE(
      refusal(two + same).find("must name 3 objects, one for each osteotomy; if the new bone has a free end"),
      std::string::npos);
}

/// The uncut fibula at the place of segment 1, the cuts of both segments on it, a screw in the middle of each,
/// and those screws where the segments are placed; then further steps.
Plan uncut_plan(const tests::ScratchFolder& folder, const std::string& more) {
  voxel::write_scene(bar_scene(), folder / "bar.nrrd");
  voxel::write_scene(verify::leg_phantom(), folder / "leg.nrrd");
  const std::string same = std::string(flap_fields) + still_face;
  std::string steps =
      R"({"id": "jaw", "do": "window", "scan": "ct", "low": 300},
         {"id": "gone", "do": "flap_space", "part": "resection", "aside_mm": 12, )" +
      same + R"(}, {"id": "uncut", "do": "flap_scan", "scan": "leg", "segment": 1, "uncut": true, )" + same +
      R"(}, {"id": "fibula", "do": "window", "low": 300, "scan": "uncut"})";
  for (const char* n : {"1", "2"}) {
    const std::string i(n);
    steps += R"(, {"id": "cuts_)" + i + R"(", "do": "flap_space", "uncut_at": 1, "number": )" + i + ", " +
             same + R"(}, {"id": "screw_)" + i + R"(", "do": "screw", "object": "fibula", "flap": "cuts_)" +
             i + R"(", "cuts": ["cuts_)" + i + R"("]}, {"id": "moved_)" + i +
             R"(", "do": "flap_move", "object": "screw_)" + i + R"(", "segment": "cuts_)" + i + R"("})";
  }
  return parse_plan(R"({"octotomy_plan": 1, "name": "flap", "scans": {"ct": {"path": "bar.nrrd"},
      "leg": {"path": "leg.nrrd"}}, "universe": {"voxel_mm": 1.0}, "steps": [)" +
                        steps + (more.empty() ? "" : ", " + more) + "]}",
                    folder.path());
}

TEST(FlapSteps, AGuideOnTheUncutBoneHasASlotForEachCutAndScrewsGoAlongWithTheirSegments) {
  const tests::ScratchFolder folder;
  const Plan plan = uncut_plan(
      folder,
      R"({"id": "guide", "do": "guide", "object": "fibula", "side": "inferior", "radius_mm": 8, "ends_mm": 24,
          "reach_mm": 10, "cuts": ["cuts_1", "cuts_2"], "slot_depth_mm": 8, "slot_end_mm": 2.5,
          "screws": ["screw_1", "screw_2"]},
         {"id": "goes_on", "do": "seating", "object": "guide", "against": ["fibula"], "seen_from": "inferior"})");
  EvaluateOptions quick;
  quick.certify = false;
  const Evaluation made = evaluate(plan, quick);
  // The bone's face, 8.5 mm off its axis, is turned downwards in both segments.
  for (const auto& [screw, x_mm] : {std::pair("moved_1", -15.0), {"moved_2", 15.0}}) {
    const Object& object = made.object(screw);
    ASSERT_TRUE(object.mesh.whole) << screw;
    glm::dvec3 low(0.0);
    double lowest_mm = 1e9;
    for (const glm::dvec3& p_mm : object.mesh.whole->triangles().points_mm)
      if (p_mm.z < lowest_mm) low = p_mm, lowest_mm = p_mm.z;
    EXPECT_NEAR(low.x, x_mm, 1.1) << screw;
    EXPECT_NEAR(low.y, 2.0, 1.1) << screw;
    EXPECT_NEAR(low.z, -8.5, 0.15) << screw;
  }
  const Json& details = made.object("guide").mesh.details;
  ASSERT_EQ(details.at("slots").size(), 4u) << details.dump(1);
  for (const Json& slot : details.at("slots")) EXPECT_NEAR(slot.at("width_mm").get<double>(), 1.2, 1e-9);
  ASSERT_EQ(details.at("holes").size(), 2u);
  constexpr double goal_mm = 0.01;
  for (const Json& hole : details.at("holes")) {
    ASSERT_FALSE(hole.at("off_axis_mm").is_null()) << details.dump(1);
    EXPECT_LT(hole.at("off_axis_mm").get<double>(), goal_mm);
  }
  // A saw that takes its kerf outside of segment 1: a point of the first cut's plane is beside the slot by less
  // than half its width, and the middle of the slot lies before the segment.
  const brep::SurfaceTree& guide = made.object("guide").mesh.within->tree();
  const glm::dvec3 along = glm::normalize(glm::dvec3(30, -16, 0)), cut_mm(-30, 10, -10);
  EXPECT_FALSE(guide.is_inside(cut_mm - 1.0 * along));
  EXPECT_TRUE(guide.is_inside(cut_mm + 1.0 * along));
  const Json measured = measurements_json(plan, made);
  EXPECT_EQ(measured.back().at("verdict"), "PASS") << measured.dump(1);
}

TEST(FlapSteps, GuidesAndScrewsThatCannotBeAreRefusedInASentence) {
  const auto expect_refused = [](const std::string& more, const std::string& words) {
    const tests::ScratchFolder folder;
    EvaluateOptions quick;
    quick.certify = false;
    try {
      evaluate(uncut_plan(folder, more), quick);
      ADD_FAILURE() << "accepted: " << more;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  const auto guide = [](const std::string& fields) {
    return R"({"id": "guide", "do": "guide", "object": "fibula", "side": "inferior", "reach_mm": 10, )" +
           fields + "}";
  };
  const auto screw = [](const std::string& fields) {
    return R"({"id": "s", "do": "screw", "object": "fibula", )" + fields + "}, ";
  };
  expect_refused(guide(R"("screws": ["screw_1"], "cuts": ["cuts_2"])"), "of 'cuts_2' misses the guide");
  expect_refused(
      screw(R"("flap": "cuts_1", "share": 0.96)") +
          guide(R"("screws": ["s", "screw_1"], "ends_mm": 24, "slot_end_mm": 2.5, "cuts": ["cuts_1"])"),
      "the sleeve of 's' runs through the slot of 'cuts_1'");
  expect_refused(guide(R"("screws": ["screw_1"], "least_wall_mm": 0.1)"), "least_wall_mm: must be from 0.3");
  expect_refused(guide(R"("cuts": ["cuts_1"])"), "the region is missing");
  expect_refused(screw(R"("flap": "cuts_1", "at": [0, 0, 0])") + guide(R"("screws": ["s"])"),
                 "states the axis a second time");
  expect_refused(screw(R"("flap": "cuts_1", "share": -0.5)") + guide(R"("screws": ["s"])"),
                 "beside segment 1");
  expect_refused(screw(R"("flap": "gone", "share": -0.5)") + guide(R"("screws": ["s"])"), "has no 'stumps'");
  expect_refused(screw(R"("flap": "jaw")") + guide(R"("screws": ["s"])"), "is not the space of a flap's");
  expect_refused(
      screw(R"("at": [0, 0, 0], "direction": [0, 0, 1], "share": 0.2)") + guide(R"("screws": ["s"])"),
      "applies only to 'flap'");
  expect_refused(R"({"id": "m", "do": "flap_move", "object": "screw_1", "segment": "gone"})",
                 "is not a segment's space on the uncut donor bone");
}

}  // namespace
}  // namespace octotomy::planner
