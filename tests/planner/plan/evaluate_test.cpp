// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/evaluate.h"

#include <gtest/gtest.h>

#include "planner/operation/table/json.h"
#include "planner/plan/sha256.h"
#include "tests/planner/ball_scan.h"
#include "tests/reference_data.h"

namespace octotomy::planner {
namespace {

using tests::ball_mm3;
using tests::cap_mm3;

constexpr double scanned_radius_mm = 20.0;

/// A ball's scan, and a plan on it that starts with the ball and a mask of z >= 5.3.
class Evaluate : public testing::Test {
 protected:
  Evaluate() {
    voxel::write_scene(tests::ball_scene(scanned_radius_mm), folder_ / "ball.nrrd");
    plan_ = {{"octotomy_plan", 1},
             {"name", "ball"},
             {"scans", {{"ct", {{"path", "ball.nrrd"}}}}},
             {"steps", SortedJson::array()}};
    add({{"id", "ball"}, {"do", "window"}, {"scan", "ct"}, {"low", 0}});
    const SortedJson cap{{-40, 5.3}, {40, 5.3}, {40, 40}, {-40, 40}};
    add({{"id", "top"},
         {"do", "mask"},
         {"regions", {{{"view", "anterior"}, {"polygons_mm", SortedJson::array({cap})}}}}});
  }
  void add(const SortedJson& step) { plan_["steps"].push_back(step); }
  Evaluation evaluated(const EvaluateOptions& options = {}) const {
    return evaluate(parse_plan(plan_.dump(), folder_.path()), options);
  }
  std::string refusal() const {
    try {
      evaluated();
      return "";
    } catch (const std::runtime_error& error) {
      return error.what();
    }
  }

  tests::ScratchFolder folder_;
  SortedJson plan_;
};

/// A voxel count's rms error on curved boundary is up to 0.32 h^2 sqrt(S) (measured on spheres); four of
/// them, and where a plane cuts along the lattice, half a voxel of its area.
double counting_mm3(double area_mm2, double flat_mm2 = 0.0) {
  return 4.0 * 0.32 * std::sqrt(area_mm2) + 0.5 * flat_mm2;
}

TEST_F(Evaluate, BothKernelsFindABallAndItsCap) {
  add({{"id", "cap"}, {"do", "combine"}, {"expression", "ball & top"}});
  add({{"id", "cup"}, {"do", "combine"}, {"expression", "ball - top"}});
  add({{"id", "size"}, {"do", "measure"}, {"object", "cap"}});
  const Evaluation evaluation = evaluated();
  const double sphere_mm2 = 4.0 * M_PI * scanned_radius_mm * scanned_radius_mm;
  const double flat_mm2 = M_PI * (scanned_radius_mm * scanned_radius_mm - 5.3 * 5.3);
  const double truth[] = {ball_mm3(scanned_radius_mm), cap_mm3(scanned_radius_mm, 5.3),
                          ball_mm3(scanned_radius_mm) - cap_mm3(scanned_radius_mm, 5.3)};
  const char* names[] = {"ball", "cap", "cup"};
  for (int i = 0; i < 3; ++i) {
    const Object& object = evaluation.object(names[i]);
    EXPECT_NEAR(object.voxel.measures.volume_mm3, truth[i], counting_mm3(sphere_mm2, i == 0 ? 0.0 : flat_mm2))
        << names[i];
    ASSERT_TRUE(object.mesh.within) << names[i];
    // Chords of an edge length cut at most edge^2 / (8 r) of depth off the sphere.
    EXPECT_NEAR(object.mesh.within->measures().volume_mm3, truth[i],
                sphere_mm2 * 2.0 / (8.0 * scanned_radius_mm))
        << names[i];
    ASSERT_TRUE(object.certificate) << names[i];
    EXPECT_EQ(object.certificate->verdict, verify::Verdict::Pass)
        << names[i] << ": " << testing::PrintToString(object.certificate->reasons);
  }
  EXPECT_NEAR(evaluation.object("cap").mesh.within->measures().volume_mm3 +
                  evaluation.object("cup").mesh.within->measures().volume_mm3,
              evaluation.object("ball").mesh.within->measures().volume_mm3, 1e-6);
}

TEST_F(Evaluate, AMovedPieceGoesWhereTheMotionSaysInBothKernels) {
  add({{"id", "cap"}, {"do", "combine"}, {"expression", "ball & top"}});
  add({{"id", "turned"},
       {"do", "move"},
       {"object", "cap"},
       {"translate_mm", {-3, 4, 0}},
       {"rotate", {{"degrees", 90}, {"axis", {1, 0, 0}}, {"about_mm", {0, 0, 0}}}}});
  const Evaluation evaluation = evaluated();
  const Object& still = evaluation.object("cap");
  const Object& turned = evaluation.object("turned");
  // A right-handed quarter turn about x carries z to -y.
  const glm::dvec3 from = *still.mesh.within->measures().centroid_mm;
  const glm::dvec3 expected(from.x - 3.0, -from.z + 4.0, from.y);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR((*turned.mesh.within->measures().centroid_mm)[axis], expected[axis], 1e-9) << axis;
    EXPECT_NEAR((*turned.voxel.measures.centroid_mm)[axis], expected[axis], 0.5) << axis;
  }
}

TEST_F(Evaluate, APieceMovedTwiceIsSampledOnce) {
  add({{"id", "cap"}, {"do", "combine"}, {"expression", "ball & top"}});
  const SortedJson there{{"degrees", 17}, {"axis", {1, 2, 3}}, {"about_mm", {1, 2, 3}}};
  const SortedJson back{{"degrees", -17}, {"axis", {1, 2, 3}}, {"about_mm", {1, 2, 3}}};
  add({{"id", "out"}, {"do", "move"}, {"object", "cap"}, {"rotate", there}});
  add({{"id", "home"}, {"do", "move"}, {"object", "out"}, {"rotate", back}});
  const Evaluation evaluation = evaluated();
  EXPECT_FALSE(evaluation.object("out").voxel.octree == evaluation.object("cap").voxel.octree);
  EXPECT_TRUE(evaluation.object("home").voxel.octree == evaluation.object("cap").voxel.octree);
}

TEST_F(Evaluate, APieceThatLeavesTheScanGetsALargerUniverseOnTheSameVoxels) {
  const Evaluation before = evaluated();
  add({{"id", "gone"}, {"do", "move"}, {"object", "ball"}, {"translate_mm", {25, 0, 0}}});
  add({{"id", "farther"}, {"do", "move"}, {"object", "gone"}, {"translate_mm", {0, -60, 0}}});
  add({{"id", "back"}, {"do", "move"}, {"object", "farther"}, {"translate_mm", {-25, 60, 0}}});
  const Evaluation evaluation = evaluated();
  EXPECT_GT(evaluation.universe.side(), before.universe.side());
  const glm::dmat4 old_from_new =
      glm::inverse(before.universe.lps_from_voxel) * evaluation.universe.lps_from_voxel;
  EXPECT_TRUE(voxel::whole_voxel_offset(old_from_new));
  for (const char* id : {"ball", "gone", "farther", "back"}) {
    const Object& object = evaluation.object(id);
    EXPECT_EQ(object.voxel.measures.voxel_count, before.object("ball").voxel.measures.voxel_count) << id;
    EXPECT_EQ(object.certificate->verdict, verify::Verdict::Pass) << id;
    EXPECT_TRUE(object.findings.empty()) << object.findings.front();
  }
  EXPECT_TRUE(evaluation.object("back").voxel.octree == evaluation.object("ball").voxel.octree);
}

TEST_F(Evaluate, AMotionOfTenMetresIsRefused) {
  add({{"id", "far"}, {"do", "move"}, {"object", "ball"}, {"translate_mm", {0, 0, 10000}}});
  const std::string said = refusal();
  EXPECT_NE(said.find("step 'far'"), std::string::npos) << said;
  EXPECT_NE(said.find("out of the universe"), std::string::npos) << said;
}

TEST_F(Evaluate, VoxelsAloneEnlargeTheUniverse) {
  add({{"id", "gone"}, {"do", "move"}, {"object", "ball"}, {"translate_mm", {25, 0, 0}}});
  EvaluateOptions options;
  options.meshes = options.certify = false;
  const Evaluation evaluation = evaluated(options);
  const Object& gone = evaluation.object("gone");
  EXPECT_TRUE(gone.findings.empty()) << gone.findings.back();
  EXPECT_GT(gone.voxel.measures.volume_mm3, 0.9 * ball_mm3(scanned_radius_mm));
}

TEST_F(Evaluate, APieceThatIsDraggedKeepsTheScansUniverseAndReportsWhatLeftIt) {
  add({{"id", "gone"}, {"do", "move"}, {"object", "ball"}, {"translate_mm", {25, 0, 0}}});
  EvaluateOptions options;
  options.meshes = options.certify = false;
  options.only_look_up = true;
  const Evaluation evaluation = evaluated(options);
  const Object& gone = evaluation.object("gone");
  ASSERT_FALSE(gone.findings.empty());
  EXPECT_NE(gone.findings.back().find("outside of the universe"), std::string::npos) << gone.findings.back();
  EXPECT_LT(gone.voxel.measures.volume_mm3, 0.9 * ball_mm3(scanned_radius_mm));
}

TEST_F(Evaluate, AnEmptyOverlapMeasuresZeroInBothKernels) {
  add({{"id", "cap"}, {"do", "combine"}, {"expression", "ball & top"}});
  add({{"id", "cup"}, {"do", "combine"}, {"expression", "ball - top"}});
  add({{"id", "lifted"}, {"do", "move"}, {"object", "cap"}, {"translate_mm", {0, 0, 4}}});
  add({{"id", "overlap"}, {"do", "combine"}, {"expression", "cup & lifted"}});
  const Evaluation evaluation = evaluated();
  const Object& overlap = evaluation.object("overlap");
  EXPECT_EQ(overlap.voxel.measures.volume_mm3, 0.0);
  ASSERT_TRUE(overlap.mesh.within);
  EXPECT_EQ(overlap.mesh.within->measures().volume_mm3, 0.0);
  ASSERT_TRUE(overlap.certificate);
  EXPECT_NE(overlap.certificate->verdict, verify::Verdict::Fail);
}

TEST_F(Evaluate, AMasksNumbersAreOfWhatIsInTheUniverse) {
  const Evaluation evaluation = evaluated();
  const Object& top = evaluation.object("top");
  // Universe -32..32 in x and y; the mask reaches from z = 5.3 beyond 32, its sides beyond -32..32.
  const double truth_mm3 = 64.0 * 64.0 * (32.0 - 5.3);
  EXPECT_NEAR(top.mesh.within->measures().volume_mm3, truth_mm3, 1e-6);
  EXPECT_NEAR(top.voxel.measures.volume_mm3, truth_mm3, 0.5 * 64.0 * 64.0);
}

TEST_F(Evaluate, AWindowWithoutVoxelsNamesTheScansRange) {
  plan_["steps"][0]["low"] = 5000;
  const std::string said = refusal();
  EXPECT_NE(said.find("step 'ball'"), std::string::npos) << said;
  EXPECT_NE(said.find("-1000 to 1000"), std::string::npos) << said;
}

TEST_F(Evaluate, AMaskThatMissesTheUniverseIsRefusedWithItsBounds) {
  plan_["steps"][1]["regions"][0]["polygons_mm"][0] = {{100, 100}, {110, 100}, {110, 110}};
  const std::string said = refusal();
  EXPECT_NE(said.find("step 'top'"), std::string::npos) << said;
  EXPECT_NE(said.find("-32..32"), std::string::npos) << said;
}

TEST_F(Evaluate, AScanOfAnotherSha256IsRefused) {
  plan_["scans"]["ct"]["sha256"] = sha256_of_path(folder_ / "ball.nrrd");
  EXPECT_EQ(refusal(), "");
  plan_["scans"]["ct"]["sha256"] = std::string(64, '0');
  const std::string said = refusal();
  EXPECT_NE(said.find("scan 'ct'"), std::string::npos) << said;
  EXPECT_NE(said.find("another scan"), std::string::npos) << said;
}

TEST_F(Evaluate, StopsWhenAsked) {
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(evaluated({source.get_token(), {}, true}), Stopped);
}

TEST_F(Evaluate, TheDefaultUniverseIsAsFineAsTheScanButAtMost512ASide) {
  EXPECT_EQ(
      universe_of(voxel::axis_aligned_lattice({256, 256, 113}, {1, 1, 2}, {0, 0, 0}), std::nullopt).side(),
      256);
  const voxel::Universe fine =
      universe_of(voxel::axis_aligned_lattice({1000, 900, 700}, {0.2, 0.2, 0.3}, {0, 0, 0}), std::nullopt);
  EXPECT_EQ(fine.side(), 512);
  EXPECT_NEAR(fine.lattice().spacing_mm().x, 210.0 / 512.0, 1e-12);
}

TEST_F(Evaluate, RealSkullsAgreeInBothKernels) {
  OCTOTOMY_NEEDS_DATA("ct_philips_skullphantom_5mm");
  const Plan plan =
      read_plan(std::string(OCTOTOMY_SOURCE_DIR) + "/tests/planner/data/philips_skullphantom.plan.json");
  const Evaluation evaluation = evaluate(plan);
  for (const Object& object : evaluation.objects) {
    if (object.kind == "mask") continue;
    ASSERT_TRUE(object.certificate) << object.id << testing::PrintToString(object.findings);
    EXPECT_NE(object.certificate->verdict, verify::Verdict::Fail)
        << object.id << ": " << testing::PrintToString(object.certificate->reasons);
  }
  EXPECT_GT(evaluation.object("overlap").voxel.measures.volume_mm3, 0.0);
}

TEST(UniverseOf, HasAVoxelOnEverySampleOfACubicScanWhateverItsCounts) {
  for (const glm::ivec3& dims : {glm::ivec3(60, 61, 47), glm::ivec3(64, 63, 33), glm::ivec3(1, 2, 3)}) {
    const voxel::Lattice scan =
        voxel::axis_aligned_lattice(dims, glm::dvec3(0.7), glm::dvec3(-20.3, 11.17, 5.05));
    const voxel::Universe universe = universe_of(scan, std::nullopt);
    for (const glm::ivec3& corner : {glm::ivec3(0), dims - 1}) {
      const glm::dvec3 p = universe.lattice().voxel(scan.lps_mm(glm::dvec3(corner)));
      EXPECT_LT(glm::distance(p, glm::round(p)), 1e-9);
      EXPECT_TRUE(glm::all(glm::greaterThan(p, glm::dvec3(-0.1))) &&
                  glm::all(glm::lessThan(p, glm::dvec3(universe.side() - 0.9))));
    }
  }
}

TEST_F(Evaluate, APartOfAVoxelIsMovedByThatPart) {
  add({{"id", "moved"}, {"do", "move"}, {"object", "ball"}, {"translate_mm", {2.45, -0.4, 1.3}}});
  const Evaluation evaluation = evaluated();
  const glm::dvec3 by = *evaluation.object("moved").voxel.measures.centroid_mm -
                        *evaluation.object("ball").voxel.measures.centroid_mm;
  // All voxels read their sample at the same place between others, where linear interpolation of shares errs
  // by up to 0.055 of a voxel; moved by whole voxels the ball would be 0.45 mm off.
  EXPECT_NEAR(by.x, 2.45, 0.055);
  EXPECT_NEAR(by.y, -0.4, 0.055);
  EXPECT_NEAR(by.z, 1.3, 0.055);
  EXPECT_EQ(evaluation.object("moved").certificate->verdict, verify::Verdict::Pass);
}

TEST_F(Evaluate, AnExpressionOfMasksEndsWithTheUniverseInBothKernelsAlsoWhenItIsMoved) {
  add({{"id", "slab"}, {"do", "combine"}, {"expression", "top"}});
  add({{"id", "moved"}, {"do", "move"}, {"object", "slab"}, {"translate_mm", {9, 0, 0}}});
  add({{"id", "moved_mask"}, {"do", "move"}, {"object", "top"}, {"translate_mm", {0, 60.3, 0}}});
  const Evaluation evaluation = evaluated();
  for (const char* id : {"slab", "moved", "moved_mask"})
    EXPECT_EQ(evaluation.object(id).certificate->verdict, verify::Verdict::Pass)
        << id << ": " << SortedJson(evaluation.object(id).certificate->reasons);
}

}  // namespace
}  // namespace octotomy::planner
