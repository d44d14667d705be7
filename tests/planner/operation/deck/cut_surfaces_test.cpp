// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A ball cut in two, whole and moved.
#include "planner/operation/deck/cut_surfaces.h"

#include <gtest/gtest.h>
#include <map>
#include <numbers>

#include "convert/tet/octree_tetrahedra.h"
#include "convert/tet/tetrahedralise.h"
#include "planner/plan/evaluate.h"
#include "tests/planner/ball_scan.h"
#include "voxel/solid/expression.h"

namespace octotomy::planner {
namespace {

constexpr double ball_radius_mm = 10.0;

class CutSurfaces : public testing::Test {
 protected:
  CutSurfaces() {
    voxel::write_scene(tests::ball_scene(ball_radius_mm, 32), folder_ / "ball.nrrd");
    EvaluateOptions uncertified;
    uncertified.certify = false;
    evaluation_ = evaluate(
        parse_plan(R"({ "octotomy_plan": 1, "name": "ball", "scans": { "ct": { "path": "ball.nrrd" } },
      "steps": [ { "id": "ball", "do": "window", "scan": "ct", "low": 0 },
                 { "id": "saw", "do": "mask", "regions": [ { "view": "anterior",
                     "polygons_mm": [[[-20, 2], [20, 2], [20, 20], [-20, 20]]] } ] },
                 { "id": "upper", "do": "combine", "expression": "ball & saw" },
                 { "id": "lower", "do": "combine", "expression": "ball - saw" },
                 { "id": "turned", "do": "move", "object": "upper", "translate_mm": [1, -2, 0.5],
                   "rotate": { "degrees": 25, "axis": [1, 0, 0], "about_mm": [0, 0, 2] } } ] })",
                   folder_.path()),
        uncertified);
  }

  /// Each surface's vector area and area.
  struct Area {
    glm::dvec3 vector_mm2{0.0};
    double mm2 = 0.0;
  };
  std::map<std::string, Area> areas(const std::string& id, const convert::Tetrahedra& tetrahedra) const {
    std::map<std::string, Area> areas;
    for (const convert::DeckSurface& surface : cut_surfaces(evaluation_.object(id), tetrahedra))
      for (const convert::ElementFace& face : surface.faces) {
        const auto [a, b, c] = convert::corners_of(tetrahedra, face);
        const auto& p = tetrahedra.nodes_mm;
        const glm::dvec3 half = 0.5 * glm::cross(p[b] - p[a], p[c] - p[a]);
        areas[surface.name].vector_mm2 += half;
        areas[surface.name].mm2 += glm::length(half);
      }
    return areas;
  }
  convert::Tetrahedra filled(const std::string& id) const {
    convert::TetOptions options;
    options.mesher = convert::Mesher::Mesh3;
    return convert::tetrahedralise(*evaluation_.object(id).mesh.within, options);
  }

  tests::ScratchFolder folder_;
  Evaluation evaluation_;
};

/// The disc 2 mm above the middle.
constexpr double disc_mm2 = std::numbers::pi * (ball_radius_mm * ball_radius_mm - 4.0);

TEST_F(CutSurfaces, OfBothPiecesAreTheDiscThatTheSawLeftFacingEachOther) {
  for (const std::string id : {"upper", "lower"}) {
    const auto areas = this->areas(id, filled(id));
    ASSERT_EQ(areas.size(), 2U) << id;
    const Area& cut = areas.at("CUT_saw");
    EXPECT_NEAR(cut.mm2 / disc_mm2, 1.0, 0.03) << id;
    EXPECT_NEAR(cut.vector_mm2.z / cut.mm2, id == "upper" ? -1.0 : 1.0, 0.01) << "flat, and outward";
    EXPECT_NEAR(areas.at("OUTER").vector_mm2.z, -cut.vector_mm2.z, 1e-6) << "the rest of a closed surface";
  }
}

TEST_F(CutSurfaces, GoWithAPieceThatMoves) {
  const auto areas = this->areas("turned", filled("turned"));
  const Area& cut = areas.at("CUT_saw");
  EXPECT_NEAR(cut.mm2 / disc_mm2, 1.0, 0.03);
  const glm::dvec3 down =
      glm::dmat3(voxel::moved_from_still({{0, 0, 0}, 25.0, {1, 0, 0}, {0, 0, 2}})) * glm::dvec3(0, 0, -1);
  EXPECT_GT(glm::dot(cut.vector_mm2, down) / cut.mm2, 0.99);
}

TEST_F(CutSurfaces, OfVoxelsElementsAreWholeFacesOfVoxels) {
  const convert::Tetrahedra voxels =
      convert::tetrahedra_of(evaluation_.object("upper").voxel.octree, convert::BoundaryCells::Voxels);
  EXPECT_NEAR(areas("upper", voxels).at("CUT_saw").mm2 / disc_mm2, 1.0, 0.06);
}

TEST_F(CutSurfaces, WhatNothingCutIsAllOuter) {
  const auto areas = this->areas("ball", filled("ball"));
  ASSERT_EQ(areas.size(), 1U);
  EXPECT_NEAR(areas.at("OUTER").mm2 / (4.0 * std::numbers::pi * ball_radius_mm * ball_radius_mm), 1.0, 0.02);
}

}  // namespace
}  // namespace octotomy::planner
