// SPDX-License-Identifier: AGPL-3.0-or-later
// The pieces that procedures cut from the head phantom, and where each goes.
#include <gtest/gtest.h>
#include <memory>

#include "planner/plan/evaluate.h"
#include "planner/procedure/template/procedure.h"
#include "tests/planner/procedure/template/on_the_head.h"
#include "tests/voxel/scratch_folder.h"
#include "verify/phantom/head_phantom.h"
#include "verify/phantom/leg_phantom.h"
#include "voxel/filter/components.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::planner {
namespace {

/// The head phantom and the leg as a donor, in voxels of 2 mm; plans with the voxel kernel alone.
class OnPhantoms : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<tests::ScratchFolder>();
    verify::HeadOptions coarse;
    coarse.voxel_mm = 2.0;
    voxel::write_scene(verify::head_phantom(coarse), *folder_ / "head.nrrd");
    voxel::write_scene(verify::leg_phantom(), *folder_ / "leg.nrrd");
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static Evaluation planned(const char* name, const std::map<std::string, double>& values) {
    ProcedureInput input = tests::head_input();
    input.folder = folder_->path();
    input.voxel_mm = 2.0;
    input.values = values;
    // The condyles' tops; in the other tests' list they lie in the joint.
    for (brep::Landmark& mark : input.landmarks)
      if (mark.name.starts_with("condyle_")) mark.p_mm = {mark.p_mm.x, -4.0, -9.0};
    const Procedure procedure = read_procedure(name);
    for (const ProcedureScan& scan : procedure.scans) input.further_scans[scan.name] = {{"path", "leg.nrrd"}};
    EvaluateOptions quick;
    quick.certify = quick.meshes = false;
    return evaluate(parse_plan(plan_of(procedure, input).dump(), folder_->path()), quick);
  }

  struct Piece {
    const char* name;
    double least_cm3, most_cm3;
    std::vector<std::string> taken, left;
  };
  /// A piece holds its landmarks and no others, and is one part but for some voxels at its cuts.
  static void expect_piece(const Evaluation& evaluation, const Piece& piece) {
    const Object& object = evaluation.object(piece.name);
    const double cm3 = object.voxel.measures.volume_mm3 / 1000.0;
    EXPECT_GT(cm3, piece.least_cm3) << piece.name;
    EXPECT_LT(cm3, piece.most_cm3) << piece.name;
    for (const std::string& mark : piece.taken)
      EXPECT_TRUE(tests::has(evaluation, piece.name, mark)) << piece.name << ", " << mark;
    for (const std::string& mark : piece.left)
      EXPECT_FALSE(tests::has(evaluation, piece.name, mark)) << piece.name << ", " << mark;
    EXPECT_GT(static_cast<double>(voxel::components(object.voxel.octree).voxel_counts.front()),
              0.98 * static_cast<double>(object.voxel.octree.voxel_count()))
        << piece.name;
  }
  static void expect_way(const glm::dvec3& way_mm, double forward_mm, double left_mm, double up_mm) {
    EXPECT_LT(glm::distance(way_mm, {left_mm, -forward_mm, up_mm}), 1e-3);
  }
  static double volume_mm3(const Evaluation& evaluation, const char* id) {
    return evaluation.object(id).voxel.measures.volume_mm3;
  }

  static std::unique_ptr<tests::ScratchFolder> folder_;
};
std::unique_ptr<tests::ScratchFolder> OnPhantoms::folder_;

TEST_F(OnPhantoms, ACondylotomyFreesBothCondylesOfTheMandibleAndTheSkull) {
  const Evaluation made = planned("condylotomy", {{"forward_mm", -4},
                                                  {"kerf_mm", 2},
                                                  {"condyles_forward_mm", 1},
                                                  {"condyles_out_mm", 6},
                                                  {"condyles_up_mm", -3}});
  expect_piece(made, {"distal",
                      70,
                      95,
                      {"lower_incisor", "menton", "coronoid_left", "coronoid_right", "lingula_left"},
                      {"condyle_left", "condyle_right", "incisor", "molar_left", "zygoma_left"}});
  expect_piece(made,
               {"left_condyle", 2, 5, {"condyle_left"}, {"coronoid_left", "lingula_left", "zygoma_left"}});
  expect_piece(
      made, {"right_condyle", 2, 5, {"condyle_right"}, {"coronoid_right", "lingula_right", "zygoma_right"}});
  for (const char* mark : {"menton", "lower_incisor", "condyle_left", "condyle_right"})
    EXPECT_FALSE(tests::has(made, "rest", mark)) << mark;
  expect_way(tests::way_mm(made, "distal_moved", "lower_incisor"), -4, 0, 0);
  expect_way(tests::way_mm(made, "left_condyle_moved", "condyle_left"), 1, 6, -3);
  expect_way(tests::way_mm(made, "right_condyle_moved", "condyle_right"), 1, -6, -3);
  const double pieces_mm3 = volume_mm3(made, "distal") + volume_mm3(made, "left_condyle") +
                            volume_mm3(made, "right_condyle") + volume_mm3(made, "rest");
  EXPECT_LT(pieces_mm3, volume_mm3(made, "skull") - 200.0);
  EXPECT_GT(pieces_mm3, volume_mm3(made, "skull") - 2000.0);
}

TEST_F(OnPhantoms, ABodyOsteotomySetsTheFrontBackOntoWhereItsSlicesWere) {
  const Evaluation slices = planned("mandibular_body", {{"left_top_mm", 8},
                                                        {"left_bottom_mm", 8},
                                                        {"right_top_mm", 8},
                                                        {"right_bottom_mm", 8},
                                                        {"left_mm", 1}});
  expect_piece(slices, {"front",
                        20,
                        32,
                        {"lower_incisor", "menton", "pogonion", "body_crest_left", "body_border_right"},
                        {"incisor", "lower_molar_left", "lower_molar_right", "split_front_left"}});
  for (const char* slice : {"left_slice", "right_slice"}) expect_piece(slices, {slice, 3, 6, {}, {"menton"}});
  expect_way(tests::way_mm(slices, "front_moved", "lower_incisor"), -8, 1, 0);
  EXPECT_NEAR(volume_mm3(slices, "front") + volume_mm3(slices, "left_slice") +
                  volume_mm3(slices, "right_slice") + volume_mm3(slices, "rest"),
              volume_mm3(slices, "skull"), 1.0);

  // Wedges that are wider at the crest tilt the front backwards, about the lower border.
  const Evaluation wedges = planned("mandibular_body", {{"left_top_mm", 6},
                                                        {"left_bottom_mm", 2},
                                                        {"right_top_mm", 6},
                                                        {"right_bottom_mm", 2},
                                                        {"left_up_mm", 1},
                                                        {"right_up_mm", 1}});
  for (const char* crest : {"body_crest_left", "body_crest_right"})
    EXPECT_NEAR(tests::way_mm(wedges, "front_moved", crest).y, 6.0, 0.3);
  for (const char* border : {"body_border_left", "body_border_right"})
    EXPECT_NEAR(tests::way_mm(wedges, "front_moved", border).y, 2.0, 0.3);
  EXPECT_LT(volume_mm3(wedges, "left_slice"), 0.65 * volume_mm3(slices, "left_slice"));

  // The front turns to the side of the wider slice.
  const Evaluation uneven =
      planned("mandibular_body",
              {{"left_top_mm", 8}, {"left_bottom_mm", 8}, {"right_top_mm", 4}, {"right_bottom_mm", 4}});
  EXPECT_GT(tests::way_mm(uneven, "front_moved", "lower_incisor").x, 1.0);
}

TEST_F(OnPhantoms, ALeFortIInThreePiecesMovesEachByItself) {
  const Evaluation made = planned("le_fort_i_three_piece", {{"front_forward_mm", 5},
                                                            {"front_up_mm", 3},
                                                            {"left_mm", 1},
                                                            {"back_forward_mm", 2},
                                                            {"left_up_mm", 1},
                                                            {"right_up_mm", -1},
                                                            {"widen_mm", 6},
                                                            {"diverge_deg", 4},
                                                            {"split_mm", 2},
                                                            {"kerf_mm", 2}});
  expect_piece(made, {"front_maxilla", 12, 22, {"incisor"}, {"molar_left", "molar_right", "lower_incisor"}});
  expect_piece(made, {"left_maxilla", 8, 15, {"molar_left"}, {"incisor", "molar_right", "coronoid_left"}});
  expect_piece(made, {"right_maxilla", 8, 15, {"molar_right"}, {"incisor", "molar_left", "coronoid_right"}});
  expect_way(tests::way_mm(made, "front_moved", "incisor"), 5, 1, 3);
  expect_way(tests::way_mm(made, "left_moved", "molar_left"), 2, 4, 1);
  expect_way(tests::way_mm(made, "right_moved", "molar_right"), 2, -2, -1);
  // Behind the molar the left piece goes further to the left.
  EXPECT_GT(tests::way_mm(made, "left_moved", "pterygoid_left").x, 4.2);
  EXPECT_LT(tests::way_mm(made, "right_moved", "pterygoid_right").x, -2.2);
  const double pieces_mm3 = volume_mm3(made, "front_maxilla") + volume_mm3(made, "left_maxilla") +
                            volume_mm3(made, "right_maxilla");
  EXPECT_LT(pieces_mm3, volume_mm3(made, "maxilla") - 500.0);
  EXPECT_GT(pieces_mm3, volume_mm3(made, "maxilla") - 5000.0);
  EXPECT_TRUE(made.object("pieces_overlap").voxel.octree.is_empty());
}

TEST_F(OnPhantoms, ACostochondralGraftStandsWhereTheCondyleWas) {
  const Evaluation made =
      planned("costochondral_graft", {{"start_mm", 20}, {"donor_low", 300}, {"least_mm3", 200}});
  expect_piece(made, {"cut_out",
                      4,
                      14,
                      {"condyle_left"},
                      {"coronoid_left", "ramus_border_left", "condyle_right", "zygoma_left", "menton"}});
  const double length_mm = glm::distance(glm::dvec3(49, -13, -54), glm::dvec3(50, -5, -10));
  EXPECT_NEAR(volume_mm3(made, "segment_1") / (verify::LegFibula().section_mm2() * length_mm), 1.0, 0.05);
  EXPECT_TRUE(tests::has(made, "segment_1", "graft_ramus"));
  EXPECT_TRUE(tests::has(made, "segment_1", "graft_joint"));
  for (const char* mark : {"condyle_right", "coronoid_left", "menton", "zygoma_left", "incisor"})
    EXPECT_TRUE(tests::has(made, "rest", mark)) << mark;
  EXPECT_FALSE(made.object("contact_1").voxel.octree.is_empty());
  EXPECT_NEAR(volume_mm3(made, "rest") + volume_mm3(made, "cut_out"), volume_mm3(made, "skull"), 1500.0);
}

}  // namespace
}  // namespace octotomy::planner
