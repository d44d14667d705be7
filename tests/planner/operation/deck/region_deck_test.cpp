// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Bone, soft tissue, soft tissue and bone upon each other, each 4 mm high, as one deck.
#include "planner/operation/deck/region_deck.h"

#include <gtest/gtest.h>
#include <set>

#include "planner/plan/evaluate.h"
#include "tests/planner/ball_scan.h"
#include "tests/planner/solved_deck.h"

namespace octotomy::planner {
namespace {

using tests::set_of;
using tests::solved;

voxel::Scene pile() {
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice(glm::ivec3(16), glm::dvec3(1.0), glm::dvec3(0.5));
  scene.meaning = voxel::Meaning::Hounsfield;
  voxel::Int16Samples samples;
  for (int z = 0; z < 16; ++z)
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x) {
        const bool in_block = x >= 5 && x < 11 && y >= 5 && y < 11;
        samples.push_back(static_cast<std::int16_t>(in_block ? 100 * (z / 4 + 1) : -1000));
      }
  scene.samples = std::move(samples);
  return scene;
}

class RegionDecks : public testing::Test {
 protected:
  RegionDecks() { voxel::write_scene(pile(), folder_ / "pile.nrrd"); }

  Plan plan(const std::string& keys) const {
    return parse_plan(R"({ "octotomy_plan": 1, "name": "pile", "scans": { "ct": { "path": "pile.nrrd" } },
      "steps": [ { "id": "floor", "do": "window", "scan": "ct", "low": 90, "high": 110 },
                 { "id": "lower", "do": "window", "scan": "ct", "low": 190, "high": 210 },
                 { "id": "upper", "do": "window", "scan": "ct", "low": 290, "high": 310 },
                 { "id": "roof", "do": "window", "scan": "ct", "low": 390, "high": 410 },
                 { "id": "shifted", "do": "move", "object": "floor", "translate_mm": [1.25, 0, 0] },
                 { "id": "raised", "do": "move", "object": "roof", "translate_mm": [0, 0, 0.5] },
                 { "id": "deck", "do": "export", "object": "upper", "path": "pile.inp", )" +
                          keys + " } ] }",
                      folder_.path());
  }
  RegionDeck deck(const std::string& keys) const {
    const Plan the = plan(keys);
    const Evaluation evaluation = evaluate(the);
    return region_deck(evaluation.objects, evaluation.object("upper"), the.steps.back().action.get<Deck>());
  }

  tests::ScratchFolder folder_;
};

TEST_F(RegionDecks, WhatSlidesFollowsItsOwnBoneAndWhatSharesNodesIsSheared) {
  OCTOTOMY_NEEDS_PROGRAM("ccx", "calculix-ccx");
  const std::string held = R"("regions": ["lower"], "moved": ["shifted"], "fixed": ["roof"])";
  const RegionDeck slides = deck(held + R"(, "sliding": [["lower", "upper"]])");
  ASSERT_EQ(slides.options.contacts.size(), 1U);
  const std::vector<glm::dvec3> apart = solved(slides, folder_);
  for (std::size_t t = 0; t < slides.tetrahedra.tets.size(); ++t)
    for (const std::uint32_t node : slides.tetrahedra.tets[t]) {
      const bool is_lower = slides.tetrahedra.region_of_tet[t] == 1;
      EXPECT_LT(glm::distance(apart[node], glm::dvec3(is_lower ? 1.25 : 0.0, 0, 0)), 1e-4) << is_lower;
    }
  const RegionDeck shares = deck(held);
  EXPECT_TRUE(shares.options.contacts.empty());
  const std::vector<glm::dvec3> together = solved(shares, folder_);
  double middle_mm = 0.0;
  for (std::size_t node = 0; node < together.size(); ++node)
    if (shares.tetrahedra.nodes_mm[node] == glm::dvec3(8, 8, 8)) middle_mm = together[node].x;
  EXPECT_NEAR(middle_mm, 0.5 * 1.25, 0.05) << "half-way between the bones, by symmetry";
}

TEST_F(RegionDecks, RegionsThatThePlanMovesGoAsAWholeAndStretchWhatIsBetween) {
  OCTOTOMY_NEEDS_PROGRAM("ccx", "calculix-ccx");
  const RegionDeck bar = deck(R"("regions": ["lower", "floor", "raised"], "moved": ["raised"],
      "fixed": ["floor"], "material": { "youngs_modulus_mpa": 0.015, "poisson_ratio": 0.0 })");
  std::set<std::uint32_t> of_raised;
  for (std::size_t t = 0; t < bar.tetrahedra.tets.size(); ++t)
    if (bar.tetrahedra.region_of_tet[t] == 3)
      of_raised.insert(bar.tetrahedra.tets[t].begin(), bar.tetrahedra.tets[t].end());
  // At least the corners on the region's faces; voxels within may be joined to larger cells.
  EXPECT_GE(of_raised.size(), 7U * 7 * 5 - 5 * 5 * 3);
  EXPECT_EQ(set_of(bar, "MOVED_raised").nodes.size(), of_raised.size()) << "all nodes of the region";
  const std::vector<glm::dvec3> displacements = solved(bar, folder_);
  for (std::size_t node = 0; node < displacements.size(); ++node) {
    const double z_mm = bar.tetrahedra.nodes_mm[node].z;
    const double up_mm = 0.5 * std::clamp((z_mm - 4.0) / 8.0, 0.0, 1.0);
    EXPECT_LT(glm::distance(displacements[node], glm::dvec3(0, 0, up_mm)), 1e-5) << z_mm;
  }
}

TEST_F(RegionDecks, SmoothElementsAreHeldByRegionsOfTheirOwnDeckAlone) {
  const std::string keys = R"("smooth_mm": 2, "moved": ["raised"], "regions": ["lower", "raised")";
  const RegionDeck smooth = deck(keys + R"(, "floor"], "fixed": ["floor"], "sliding": [["upper", "lower"]])");
  EXPECT_EQ(smooth.tetrahedra.method, "Mesh_3 of labels");
  std::vector<bool> is_moved(smooth.tetrahedra.nodes_mm.size(), false);
  for (const std::uint32_t node : set_of(smooth, "MOVED_raised").nodes) is_moved[node] = true;
  for (std::size_t t = 0; t < smooth.tetrahedra.tets.size(); ++t)
    for (const std::uint32_t node : smooth.tetrahedra.tets[t])
      if (smooth.tetrahedra.region_of_tet[t] == 2) {
        EXPECT_TRUE(is_moved[node]);
      }
  ASSERT_EQ(smooth.options.contacts.size(), 1U);
  EXPECT_EQ(smooth.options.contacts[0].name, "upper_TO_lower");
  EXPECT_THROW(plan(keys + R"(], "fixed": ["floor"])"), std::runtime_error) << "the floor is no region";
}

TEST_F(RegionDecks, ARegionThatNothingHoldsIsLeftOutWithItsContact) {
  const RegionDeck loose =
      deck(R"("regions": ["lower"], "fixed": ["roof"], "sliding": [["upper", "lower"]])");
  EXPECT_NEAR(convert::quality(loose.tetrahedra).volume_mm3, 6.0 * 6 * 4, 1e-9);
  EXPECT_TRUE(loose.options.contacts.empty());
  ASSERT_EQ(loose.options.surfaces.size(), 3U) << "on the roof, free, and what slid";
  EXPECT_EQ(loose.options.surfaces[0].name, "ON_roof");
  EXPECT_NE(loose.findings.back().find("144.0 mm"), std::string::npos) << loose.findings.back();
}

TEST_F(RegionDecks, PairsThatCannotSlideAreRefused) {
  for (const char* keys :
       {R"("regions": ["lower"], "sliding": [["upper", "roof"]])", R"("sliding": [["upper", "lower"]])",
        R"("regions": ["lower"], "sliding": [["upper", "upper"]])",
        R"("regions": ["lower"], "sliding": ["upper"])"})
    EXPECT_THROW(plan(keys), std::runtime_error) << keys;
  EXPECT_THROW(deck(R"("regions": ["floor"], "sliding": [["upper", "floor"]])"), std::runtime_error)
      << "they do not touch";
}

}  // namespace
}  // namespace octotomy::planner
