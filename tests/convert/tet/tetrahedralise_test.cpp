// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/tetrahedralise.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "tests/convert/surfaces.h"

namespace octotomy::convert {
namespace {

using tests::ball;
using tests::box;
using tests::inside_out;
using tests::together;

/// The message of the exception that the call throws; empty if it throws none.
template <typename Error>
std::string refusal(const brep::Triangles& solid, const TetOptions& options = {}) {
  try {
    tetrahedralise(brep::mesh_of(solid), options);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

bool contains_text(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Whether a point lies in one of the tetrahedra.
bool filled(const Tetrahedra& t, const glm::dvec3& p) {
  return std::any_of(t.tets.begin(), t.tets.end(), [&](const auto& tet) {
    for (std::size_t i = 0; i < 4; ++i) {
      std::array<glm::dvec3, 4> q;
      for (std::size_t j = 0; j < 4; ++j) q.at(j) = t.nodes_mm[tet.at(j)];
      q.at(i) = p;
      if (glm::dot(glm::cross(q[1] - q[0], q[2] - q[0]), q[3] - q[0]) < 0.0) return false;
    }
    return true;
  });
}

TEST(Tetrahedralise, ACubeIsFilledToItsVolumeWithPositiveQualityTetrahedra) {
  const Tetrahedra t = tetrahedralise(brep::mesh_of(box({-5, -5, -5}, {5, 5, 5})));
  const TetQuality q = quality(t);
  EXPECT_NEAR(q.volume_mm3, 1000.0, 1e-9 * 1000.0);
  EXPECT_GT(q.min_volume_mm3, 0.0);
  EXPECT_EQ(t.method, "TetGen -pYq1.4");
  EXPECT_TRUE(t.findings.empty());
  // The boundary is kept: only the cube's own corners are on it.
  EXPECT_EQ(t.boundary_nodes, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7}));
}

TEST(Tetrahedralise, ABallIsFilledToTheVolumeOfItsTriangles) {
  const brep::Triangles surface = ball({100, -50, 20}, 30.0, 4);
  const Tetrahedra t = tetrahedralise(brep::mesh_of(surface));
  const double volume = tests::volume_mm3(surface);
  EXPECT_NEAR(quality(t).volume_mm3, volume, 1e-9 * volume);
  EXPECT_EQ(t.boundary_nodes.size(), surface.points_mm.size());
  EXPECT_GT(t.nodes_mm.size(), surface.points_mm.size());
  EXPECT_GT(quality(t).min_dihedral_deg, 1.0);
}

TEST(Tetrahedralise, ALimitOnVolumeMakesMoreAndSmallerTetrahedra) {
  const brep::Mesh surface = brep::mesh_of(ball({0, 0, 0}, 30.0, 4));
  TetOptions options;
  options.max_volume_mm3 = 10.0;
  const Tetrahedra fine = tetrahedralise(surface, options);
  EXPECT_EQ(fine.method, "TetGen -pYq1.4a8.5");
  EXPECT_GT(fine.tets.size(), tetrahedralise(surface).tets.size());
  // Beside triangles that must stay, TetGen gives up on a few.
  std::size_t larger = 0;
  for (const auto& [a, b, c, d] : fine.tets) {
    const auto& p = fine.nodes_mm;
    if (glm::dot(glm::cross(p[b] - p[a], p[c] - p[a]), p[d] - p[a]) / 6.0 > *options.max_volume_mm3) ++larger;
  }
  EXPECT_LT(larger, fine.tets.size() / 100);
}

TEST(Tetrahedralise, NoElementOfABoxOfTwelveTrianglesIsLargerThanAllowed) {
  const brep::Mesh surface = brep::mesh_of(box({0, 0, 0}, {20, 20, 20}));
  for (const Mesher mesher : {Mesher::TetGen, Mesher::Mesh3, Mesher::Stuffing}) {
    TetOptions options;
    options.mesher = mesher;
    options.max_volume_mm3 = 20.0;
    const Tetrahedra t = tetrahedralise(surface, options);
    double largest_mm3 = 0.0;
    for (std::size_t i = 0; i < t.tets.size(); ++i)
      largest_mm3 = std::max(largest_mm3, six_volumes(corners_mm(t, i)) / 6.0);
    const bool is_told = std::any_of(t.findings.begin(), t.findings.end(), [](const std::string& finding) {
      return contains_text(finding, "elements are larger than the 20 mm3 ");
    });
    EXPECT_EQ(largest_mm3 > 20.0, is_told) << t.method << ": " << largest_mm3;
    EXPECT_LT(largest_mm3, 25.0) << t.method;
  }
}

TEST(Tetrahedralise, NewPointsOnTheSurfaceAreMadeWhereTheyAreAllowed) {
  TetOptions options;
  options.keep_boundary = false;
  options.max_volume_mm3 = 5.0;
  const Tetrahedra t = tetrahedralise(brep::mesh_of(box({0, 0, 0}, {10, 10, 10})), options);
  EXPECT_EQ(t.method, "TetGen -pq1.4a4.25");
  EXPECT_GT(t.boundary_nodes.size(), 8U);
  EXPECT_NEAR(quality(t).volume_mm3, 1000.0, 1e-6);
}

TEST(Tetrahedralise, ACavityStaysEmpty) {
  const brep::Triangles shell = together(ball({0, 0, 0}, 20.0, 3), inside_out(ball({2, 0, 0}, 9.0, 3)));
  const Tetrahedra t = tetrahedralise(brep::mesh_of(shell));
  const double volume = tests::volume_mm3(shell);
  EXPECT_NEAR(quality(t).volume_mm3, volume, 1e-9 * volume);
  EXPECT_FALSE(filled(t, {2, 0, 0}));
  EXPECT_TRUE(filled(t, {-15, 0.1, 0.2}));
}

TEST(Tetrahedralise, AnIslandInACavityIsFilledAndTheCavityIsNot) {
  const brep::Triangles nested = together(
      together(ball({0, 0, 0}, 20.0, 3), inside_out(ball({0, 0, 0}, 14.0, 3))), ball({1, 0, 0}, 12.0, 3));
  const Tetrahedra t = tetrahedralise(brep::mesh_of(nested));
  const double volume = tests::volume_mm3(nested);
  EXPECT_NEAR(quality(t).volume_mm3, volume, 1e-9 * volume);
  EXPECT_TRUE(filled(t, {1, 0.1, 0.2}));
  EXPECT_FALSE(filled(t, {-12.3, 0.1, 0.2}));
}

TEST(Tetrahedralise, SeparatePartsAreAllFilled) {
  const Tetrahedra t =
      tetrahedralise(brep::mesh_of(together(box({0, 0, 0}, {1, 1, 1}), box({5, 0, 0}, {7, 1, 1}))));
  EXPECT_NEAR(quality(t).volume_mm3, 3.0, 1e-9);
}

TEST(Tetrahedralise, PartsThatTouchAtAPointOrAnEdgeShareItsNodes) {
  const Tetrahedra at_point =
      tetrahedralise(brep::mesh_of(together(box({0, 0, 0}, {1, 1, 1}), box({1, 1, 1}, {2, 2, 2}))));
  EXPECT_NEAR(quality(at_point).volume_mm3, 2.0, 1e-9);
  EXPECT_EQ(at_point.boundary_nodes.size(), 15U);
  const Tetrahedra along_edge =
      tetrahedralise(brep::mesh_of(together(box({0, 0, 0}, {1, 1, 1}), box({1, 1, 0}, {2, 2, 1}))));
  EXPECT_NEAR(quality(along_edge).volume_mm3, 2.0, 1e-9);
  EXPECT_EQ(along_edge.boundary_nodes.size(), 14U);
}

TEST(Tetrahedralise, AnOpenSurfaceIsRefusedAndTheMessageSaysWhere) {
  brep::Triangles open = box({0, 0, 0}, {1, 1, 1});
  open.faces.pop_back();
  EXPECT_TRUE(contains_text(refusal<voxel::Error>(open), "open at ("));
}

TEST(Tetrahedralise, FlatTinyInsideOutAndEmptySolidsAreRefusedByName) {
  EXPECT_TRUE(contains_text(refusal<voxel::Error>(box({0, 0, 0}, {100, 100, 1e-7})), "flat"));
  EXPECT_TRUE(contains_text(refusal<voxel::Error>(box({0, 0, 0}, {1e-4, 1e-4, 1e-4})), "millimetres?"));
  EXPECT_TRUE(contains_text(refusal<voxel::Error>(inside_out(box({0, 0, 0}, {1, 1, 1}))), "inside out"));
  EXPECT_TRUE(contains_text(refusal<voxel::Error>({}), "encloses nothing"));
}

TEST(Tetrahedralise, OptionsOutOfRangeAreRefused) {
  TetOptions options;
  options.radius_edge = 0.5;
  EXPECT_FALSE(refusal<std::invalid_argument>(box({0, 0, 0}, {1, 1, 1}), options).empty());
  options = {};
  options.max_volume_mm3 = 0.0;
  EXPECT_FALSE(refusal<std::invalid_argument>(box({0, 0, 0}, {1, 1, 1}), options).empty());
}

TEST(Tetrahedralise, ASurfaceThatIntersectsItselfFailsWithAMessageThatNamesTheSwitches) {
  const std::string message =
      refusal<std::runtime_error>(together(box({0, 0, 0}, {10, 10, 10}), ball({10.5, 4.7, 5.2}, 4.0, 2)));
  EXPECT_TRUE(contains_text(message, "-pYq1.4Q")) << message;
  EXPECT_TRUE(contains_text(message, "intersect")) << message;
}

TEST(Tetrahedralise, ATimeLimitTooSmallIsNamedWithWhatToTry) {
  TetOptions options;
  options.time_limit = std::chrono::milliseconds(1);
  const std::string message = refusal<std::runtime_error>(ball({0, 0, 0}, 30.0, 6), options);
  EXPECT_TRUE(contains_text(message, "time limit of 1 ms")) << message;
  EXPECT_TRUE(contains_text(message, "raise it")) << message;
  EXPECT_TRUE(contains_text(message, "-pQ")) << "the last rung of the ladder was tried: " << message;
}

TEST(Tetrahedralise, AMemoryLimitTooSmallIsNamedWithWhatToTry) {
  TetOptions options;
  options.memory_limit_bytes = 20ULL << 20;
  const std::string message = refusal<std::runtime_error>(ball({0, 0, 0}, 30.0, 5), options);
  EXPECT_TRUE(contains_text(message, "memory")) << message;
}

TEST(Tetrahedralise, ErrorsSayByTheirCodeWhatGaveOut) {
  const auto code_of = [](const brep::Triangles& solid, const TetOptions& options) {
    try {
      tetrahedralise(brep::mesh_of(solid), options);
    } catch (const voxel::Error& error) {
      return error.code();
    }
    return voxel::ErrorCode::Input;
  };
  TetOptions hurried;
  hurried.time_limit = std::chrono::milliseconds(1);
  EXPECT_EQ(code_of(ball({0, 0, 0}, 30.0, 6), hurried), voxel::ErrorCode::Resource);
  EXPECT_EQ(code_of(inside_out(box({0, 0, 0}, {1, 1, 1})), {}), voxel::ErrorCode::Geometry);
  EXPECT_EQ(code_of(together(box({0, 0, 0}, {10, 10, 10}), ball({10.5, 4.7, 5.2}, 4.0, 2)), {}),
            voxel::ErrorCode::Geometry);
}

TEST(Tetrahedralise, StopsOnRequestWithoutTryingAgain) {
  std::stop_source source;
  source.request_stop();
  TetOptions options;
  options.mesher = Mesher::Best;
  options.progress.stop = source.get_token();
  const std::string message = refusal<voxel::Stopped>(ball({0, 0, 0}, 30.0, 6), options);
  EXPECT_TRUE(contains_text(message, "stopped on request")) << message;
  EXPECT_FALSE(contains_text(message, "-pYQ")) << message;
}

/// A wedge whose edge is sharper than a solver's smallest angle: no mesher that keeps it can be better.
brep::Triangles wedge(double degrees) {
  const double high_mm = 20.0 * std::tan(degrees * M_PI / 180.0);
  return {{{0, 0, 0}, {20, 0, 0}, {20, 0, high_mm}, {0, 20, 0}, {20, 20, 0}, {20, 20, high_mm}},
          {{0, 1, 2}, {3, 5, 4}, {0, 4, 1}, {0, 3, 4}, {1, 5, 2}, {1, 4, 5}, {0, 5, 3}, {0, 2, 5}}};
}

TEST(Tetrahedralise, AnEdgeSharperThanASolverTakesIsStuffedAndTheFindingsSayHowFarTheSurfaceMoved) {
  ASSERT_FALSE(tests::fault_in_closedness(wedge(3.0)));
  TetOptions options;
  options.mesher = Mesher::TetGen;
  EXPECT_LT(quality(tetrahedralise(brep::mesh_of(wedge(3.0)), options)).min_dihedral_deg, fit_dihedral_deg())
      << "the wedge is no hard case";
  options.mesher = Mesher::Stuffing;
  options.max_volume_mm3 = 0.01;
  const Tetrahedra t = tetrahedralise(brep::mesh_of(wedge(3.0)), options);
  EXPECT_EQ(t.method, "isosurface stuffing");
  EXPECT_GT(quality(t).min_dihedral_deg, 10.0);
  EXPECT_FALSE(fault_in_shape(t));
  EXPECT_NEAR(quality(t).volume_mm3 / tests::volume_mm3(wedge(3.0)), 1.0, 0.05);
  ASSERT_EQ(t.findings.size(), 1u);
  EXPECT_TRUE(contains_text(t.findings[0], "all within")) << t.findings[0];
  EXPECT_EQ(t.boundary_nodes, boundary_nodes(t.tets));
}

TEST(Tetrahedralise, BestIsNeverUnfitWhereStuffingHoldsTheVolume) {
  TetOptions options;
  options.mesher = Mesher::Best;
  options.max_volume_mm3 = 0.01;
  const Tetrahedra t = tetrahedralise(brep::mesh_of(wedge(3.0)), options);
  EXPECT_FALSE(fault_in_shape(t)) << *fault_in_shape(t);
}

TEST(Tetrahedralise, ASurfaceOfMoreTrianglesThanTheTimeAllowsIsStuffedAtOnce) {
  TetOptions options;
  options.mesher = Mesher::Best;
  options.time_limit = std::chrono::milliseconds(100);
  const Tetrahedra t = tetrahedralise(brep::mesh_of(ball({0, 0, 0}, 20.0, 4)), options);
  EXPECT_EQ(t.method, "isosurface stuffing");
  EXPECT_TRUE(contains_text(t.findings.front(), "2048 triangles are more than")) << t.findings.front();
}

TEST(Tetrahedralise, WhatIsThinnerThanCellsIsRefusedByTheShareThatIsMissing) {
  TetOptions options;
  options.mesher = Mesher::Stuffing;
  EXPECT_TRUE(contains_text(refusal<voxel::Error>(box({0, 0, 0}, {20, 20, 0.01}), options),
                            "% of the volume: the solid is thinner than cells"));
}

}  // namespace
}  // namespace octotomy::convert
