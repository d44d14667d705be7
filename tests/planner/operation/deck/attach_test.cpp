// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Soft tissue about a bone of two pieces, one of which the plan moves.
#include "planner/operation/deck/attach.h"

#include <gtest/gtest.h>

#include "convert/deck/displacement_field.h"
#include "planner/operation/deck/region_deck.h"
#include "planner/plan/evaluate.h"
#include "tests/planner/ball_scan.h"
#include "tests/planner/solved_deck.h"
#include "tests/run_command.h"
#include "voxel/solid/expression.h"

namespace octotomy::planner {
namespace {

bool within(const glm::ivec3& v, int low, int high) {
  return glm::all(glm::greaterThanEqual(v, glm::ivec3(low))) && glm::all(glm::lessThan(v, glm::ivec3(high)));
}

/// A cube of bone in a cube of tissue, and a crumb of tissue by itself.
voxel::Scene bone_in_tissue() {
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice(glm::ivec3(32), glm::dvec3(1.0), glm::dvec3(-15.5));
  scene.meaning = voxel::Meaning::Hounsfield;
  voxel::Int16Samples samples;
  for (int z = 0; z < 32; ++z)
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) {
        const glm::ivec3 v(x, y, z);
        samples.push_back(within(v, 12, 20) ? 1000 : within(v, 6, 26) || within(v, 28, 30) ? 50 : -1000);
      }
  scene.samples = std::move(samples);
  return scene;
}

class Attach : public testing::Test {
 protected:
  Attach() { voxel::write_scene(bone_in_tissue(), folder_ / "head.nrrd"); }

  Plan plan(const std::string& keys) const {
    return parse_plan(R"({ "octotomy_plan": 1, "name": "face", "scans": { "ct": { "path": "head.nrrd" } },
      "steps": [ { "id": "skin", "do": "window", "scan": "ct", "low": -100 },
                 { "id": "bone", "do": "window", "scan": "ct", "low": 500 },
                 { "id": "cut", "do": "mask", "regions": [ { "view": "anterior",
                     "polygons_mm": [[[-20, 0], [20, 0], [20, 20], [-20, 20]]] } ] },
                 { "id": "piece", "do": "combine", "expression": "bone & cut" },
                 { "id": "rest", "do": "combine", "expression": "bone - cut" },
                 { "id": "soft", "do": "combine", "expression": "skin - bone" },
                 { "id": "raised", "do": "move", "object": "piece", "translate_mm": [0, 0, 1.5] },
                 { "id": "turned", "do": "move", "object": "raised",
                   "rotate": { "degrees": 5, "axis": [1, 0, 0], "about_mm": [0, -4, 2] } },
                 { "id": "deck", "do": "export", "object": "soft", "path": "face.inp", )" +
                          keys + " } ] }",
                      folder_ / "");
  }
  RegionDeck attached(const std::string& keys) const {
    const Plan the = plan(keys);
    const Evaluation evaluation = evaluate(the);
    return region_deck(evaluation.objects, evaluation.object("soft"), the.steps.back().action.get<Deck>());
  }

  tests::ScratchFolder folder_;
};

using tests::set_of;
using tests::solved;

TEST_F(Attach, NodesOnThePieceGoWhereThePlanPutItByAllItsMotions) {
  const RegionDeck face = attached(R"("moved": ["turned"], "fixed": ["rest"])");
  // The piece's and the rest's surfaces of 8 x 8 x 4 voxels, less the cut between them: five faces each, of
  // 9 x 9 x 5 corners without the inner ones. The rim of the cut goes with the piece.
  const convert::NodeSet& moved = set_of(face, "MOVED_turned");
  EXPECT_EQ(moved.nodes.size(), 9u * 9 * 5 - 7 * 7 * 4);
  const glm::dmat4 motion = voxel::moved_from_still({{0, 0, 0}, 5.0, {1, 0, 0}, {0, -4, 2}}) *
                            voxel::moved_from_still({{0, 0, 1.5}, 0.0, {1, 0, 0}, {0, 0, 0}});
  ASSERT_EQ(face.options.prescribed[0].node_set, "MOVED_turned");
  for (std::size_t i = 0; i < moved.nodes.size(); ++i) {
    const glm::dvec3 p_mm = face.tetrahedra.nodes_mm[moved.nodes[i]];
    const glm::dvec3 to_mm(motion * glm::dvec4(p_mm, 1.0));
    EXPECT_LT(glm::distance(p_mm + face.options.prescribed[0].displacement_mm[i], to_mm), 1e-12);
  }
  EXPECT_TRUE(face.options.prescribed[1].displacement_mm.empty());
}

TEST_F(Attach, TissueIsLiftedOffStationaryBoneNearerToThePieceThanTwiceItsMotion) {
  const RegionDeck face = attached(R"("moved": ["raised"], "fixed": ["rest"])");
  // The piece moves 1.5 mm; its lowest nodes are the rim at z = 0. Of the rest's surface below, the rings of
  // 32 nodes at 1 and 2 mm are freed; the ring at 3 mm and the floor of 9 x 9 nodes stay.
  EXPECT_EQ(set_of(face, "FIXED_rest").nodes.size(), 32u + 9 * 9);
  ASSERT_FALSE(face.findings.empty());
  EXPECT_NE(face.findings[0].find("'rest' at 64 of 177 nodes"), std::string::npos) << face.findings[0];
}

TEST_F(Attach, ElementsOfASmallMotionAcrossACutAreNotTurnedOver) {
  OCTOTOMY_NEEDS_PROGRAM("ccx", "calculix-ccx");
  const RegionDeck face = attached(R"("moved": ["raised"], "fixed": ["rest"])");
  EXPECT_TRUE(convert::DisplacementField(face.tetrahedra, solved(face, folder_), 20.0).turned_over().empty());
}

TEST_F(Attach, WhatNothingHoldsIsLeftOutAndTold) {
  const RegionDeck face = attached(R"("moved": ["turned"], "fixed": ["rest"])");
  EXPECT_NEAR(convert::quality(face.tetrahedra).volume_mm3, 20.0 * 20 * 20 - 8 * 8 * 8, 1e-6);
  ASSERT_EQ(face.findings.size(), 2u);
  EXPECT_NE(face.findings[1].find("8.0 mm"), std::string::npos) << face.findings[1];
}

TEST_F(Attach, TissueHeldByOnePieceAloneFollowsItRigidly) {
  OCTOTOMY_NEEDS_PROGRAM("ccx", "calculix-ccx");
  const RegionDeck face = attached(R"("moved": ["raised"])");
  for (const glm::dvec3& displacement : solved(face, folder_))
    EXPECT_LT(glm::distance(displacement, glm::dvec3(0, 0, 1.5)), 1e-5);
}

TEST_F(Attach, BoneNodesEndWhereThePlanPutThemAndTissueBetween) {
  OCTOTOMY_NEEDS_PROGRAM("ccx", "calculix-ccx");
  const RegionDeck face = attached(R"("moved": ["raised"], "fixed": ["rest"])");
  const std::vector<glm::dvec3> displacements = solved(face, folder_);
  for (const std::uint32_t node : set_of(face, "MOVED_raised").nodes)
    EXPECT_LT(glm::distance(displacements[node], glm::dvec3(0, 0, 1.5)), 1e-5);
  for (const std::uint32_t node : set_of(face, "FIXED_rest").nodes)
    EXPECT_LT(glm::length(displacements[node]), 1e-9);
  // Tissue that is pressed aside may rise slightly more than the piece that raises it; the skin above rises
  // more than that below.
  double above_mm = 0.0, below_mm = 0.0;
  for (std::size_t node = 0; node < displacements.size(); ++node) {
    EXPECT_LT(displacements[node].z, 1.05 * 1.5);
    const glm::dvec3& p_mm = face.tetrahedra.nodes_mm[node];
    if (p_mm == glm::dvec3(0, 0, 10)) above_mm = displacements[node].z;
    if (p_mm == glm::dvec3(0, 0, -10)) below_mm = displacements[node].z;
  }
  EXPECT_GT(above_mm, 1.0);
  EXPECT_LT(below_mm, 0.5 * above_mm);
}

TEST_F(Attach, ElementsMayBeLargerThanTheUniversesVoxels) {
  const RegionDeck fine = attached(R"("moved": ["raised"])");
  const RegionDeck coarse = attached(R"("moved": ["raised"], "element_mm": 2)");
  EXPECT_LT(4 * coarse.tetrahedra.tets.size(), fine.tetrahedra.tets.size());
  EXPECT_NEAR(convert::quality(coarse.tetrahedra).volume_mm3, 20.0 * 20 * 20 - 8 * 8 * 8, 1200.0);
}

TEST_F(Attach, RefusesWhatDoesNotTouchAndWhatWasNotMoved) {
  EXPECT_THROW(attached(R"("moved": ["raised"], "fixed": ["raised"])"), std::runtime_error);
  for (const char* keys :
       {R"("moved": ["piece"])", R"("fixed": ["deck"])", R"("element_mm": 2)",
        R"("moved": ["raised"], "element_mm": 0)",
        R"("moved": ["raised"], "material": {"youngs_modulus_mpa": 1, "poisson_ratio": 0.5})"})
    EXPECT_THROW(plan(keys), std::runtime_error) << keys;
}

}  // namespace
}  // namespace octotomy::planner
