// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/mesh3_tetrahedra.h"

#include <algorithm>
#include <gtest/gtest.h>

#include "brep/mesh/components.h"
#include "brep/mesh/distance.h"
#include "brep/mesh/measure.h"
#include "brep/shape/decimate.h"
#include "convert/surface/isosurface.h"
#include "convert/tet/element_faces.h"
#include "tests/convert/surfaces.h"
#include "tests/reference_data.h"
#include "voxel/scan/read_scene.h"

namespace octotomy::convert {
namespace {

using tests::ball;
using tests::box;
using tests::inside_out;
using tests::together;

Tetrahedra by_mesh3(const brep::Triangles& surface) {
  TetOptions options;
  options.mesher = Mesher::Mesh3;
  return tetrahedralise(brep::mesh_of(surface), options);
}

/// A ball whose faces are cut at a point close to one of their sides, so that no surface that keeps these
/// triangles is good.
brep::Triangles with_needles() {
  brep::Triangles t = ball({0, 0, 0}, 20.0, 3);
  const std::size_t faces = t.faces.size();
  for (std::size_t f = 0; f < faces; ++f) {
    const auto [a, b, c] = t.faces[f];
    const auto middle = static_cast<std::uint32_t>(t.points_mm.size());
    t.points_mm.push_back(0.49 * t.points_mm[a] + 0.49 * t.points_mm[b] + 0.02 * t.points_mm[c]);
    t.faces[f] = {a, b, middle};
    t.faces.push_back({b, c, middle});
    t.faces.push_back({c, a, middle});
  }
  return t;
}

TEST(Mesh3Tetrahedra, ABallHasItsVolumeAndNoFlatElement) {
  const brep::Triangles surface = ball({100, -50, 20}, 30.0, 4);
  const Tetrahedra t = by_mesh3(surface);
  EXPECT_EQ(t.method, "Mesh_3");
  EXPECT_EQ(t.boundary_nodes, boundary_nodes(t.tets));
  const TetQuality q = quality(t);
  EXPECT_NEAR(q.volume_mm3, tests::volume_mm3(surface),
              own_surface_volume_tolerance() * tests::volume_mm3(surface));
  EXPECT_GT(q.min_dihedral_deg, 7.0);
  EXPECT_GT(q.min_volume_mm3, 0.0);
}

TEST(Mesh3Tetrahedra, EveryPartAndCavityIsThereHoweverSmall) {
  const brep::Triangles parts = together(
      together(ball({0, 0, 0}, 20.0, 3), inside_out(ball({2, 0, 0}, 9.0, 3))), ball({60, 0, 0}, 1.5, 2));
  const Tetrahedra t = by_mesh3(parts);
  const double small_mm3 = tests::volume_mm3(ball({60, 0, 0}, 1.5, 2));
  double found_mm3 = 0.0;
  for (std::size_t i = 0; i < t.tets.size(); ++i) {
    const TetCorners corners = corners_mm(t, i);
    if (corners[0].x > 50.0) found_mm3 += six_volumes(corners) / 6.0;
    for (const glm::dvec3& p : corners) EXPECT_GT(glm::distance(p, {2, 0, 0}), 8.5) << "the cavity is filled";
  }
  // Ten times coarser than the part, a facet can be no better than this.
  EXPECT_NEAR(found_mm3, small_mm3, 0.2 * small_mm3);
  EXPECT_NEAR(quality(t).volume_mm3, tests::volume_mm3(parts), 1e-3 * tests::volume_mm3(parts));
}

TEST(Mesh3Tetrahedra, BestTakesItWhereNeedlesOfTheKeptSurfaceSpoilTheAngles) {
  const brep::Triangles surface = with_needles();
  TetOptions options;
  const Tetrahedra kept = tetrahedralise(brep::mesh_of(surface), options);
  ASSERT_LT(quality(kept).min_dihedral_deg, fit_dihedral_deg());
  ASSERT_TRUE(fault_in_shape(kept));
  EXPECT_NE(fault_in_shape(kept)->find("TetGen -pYq1.4 left dihedral angles down to "), std::string::npos);
  options.mesher = Mesher::Best;
  const Tetrahedra best = tetrahedralise(brep::mesh_of(surface), options);
  EXPECT_EQ(best.method, "Mesh_3");
  EXPECT_GT(quality(best).min_dihedral_deg, fit_dihedral_deg());
  EXPECT_FALSE(fault_in_shape(best));
  ASSERT_FALSE(best.findings.empty());
  EXPECT_NE(best.findings.front().find("smoothing was stopped as hopeless, so Mesh_3 remeshed it"),
            std::string::npos)
      << best.findings.front();
  EXPECT_NE(best.findings.back().find("Mesh_3 made a new surface"), std::string::npos)
      << best.findings.back();
}

TEST(Mesh3Tetrahedra, NoMiddleOfAThinPlateIsLost) {
  TetOptions options;
  options.mesher = Mesher::Best;
  // For each of these, Mesh_3 made only the ends, thickened to the whole volume.
  for (const glm::dvec3& size_mm :
       {glm::dvec3(156, 6, 0.6), glm::dvec3(13, 13, 0.2341), glm::dvec3(1000, 1000, 0.001)}) {
    const Tetrahedra t = tetrahedralise(brep::mesh_of(box({0, 0, 0}, size_mm)), options);
    std::vector<glm::dvec3> points_mm;
    for (int x = 0; x <= 20; ++x)
      for (int y = 0; y <= 20; ++y) points_mm.push_back(size_mm * glm::dvec3(x / 20.0, y / 20.0, 1.0));
    for (const double distance_mm : brep::SurfaceTree(surface_of(t)).distances_mm(points_mm))
      ASSERT_LT(distance_mm, 0.1 * size_mm.x) << t.method << ", " << size_mm.x;
  }
}

TEST(Mesh3Tetrahedra, BestKeepsTheSurfaceWhereItsAnglesAreGood) {
  TetOptions options;
  options.mesher = Mesher::Best;
  const Tetrahedra t = tetrahedralise(brep::mesh_of(box({-5, -5, -5}, {5, 5, 5})), options);
  EXPECT_EQ(t.method, "TetGen -pYq1.4");
  EXPECT_TRUE(t.findings.empty());
}

TEST(Mesh3Tetrahedra, TheSameSurfaceGivesTheSameBits) {
  const brep::Triangles surface = with_needles();
  const Tetrahedra one = by_mesh3(surface);
  const Tetrahedra other = by_mesh3(surface);
  EXPECT_EQ(one.nodes_mm, other.nodes_mm);
  EXPECT_EQ(one.tets, other.tets);
}

TEST(Mesh3Tetrahedra, AThinSpikeThatNoElementStandsInIsToldWithItsLength) {
  brep::Triangles surface = ball({0, 0, 0}, 20.0, 4);
  // One point far out: a spike as thick as one triangle's fan at its foot.
  const std::size_t tip = 7;
  surface.points_mm[tip] *= 4.0;
  const Tetrahedra t = by_mesh3(surface);
  const double away_mm = brep::SurfaceTree(surface_of(t)).distances_mm({surface.points_mm[tip]}).front();
  ASSERT_GT(away_mm, 0.4) << "the spike was not lost: make it thinner";
  const std::string& said = t.findings.back();
  EXPECT_NEAR(std::stod(said.substr(said.rfind("within ") + 7)), away_mm, 0.01 * away_mm) << said;
}

TEST(Mesh3Tetrahedra, TheVaultOfARealSkullIn50000TrianglesHasNoAngleUnderFiveDegrees) {
  OCTOTOMY_NEEDS_DATA("ct_unc_cthead.nrrd");
  voxel::Scene scan = voxel::read_scene(tests::reference_data("ct_unc_cthead.nrrd"));
  auto& samples = std::get<voxel::Int16Samples>(scan.samples);
  // Above 150 mm: the vault, cut flat.
  const std::ptrdiff_t slice = std::ptrdiff_t{scan.lattice.dims.x} * scan.lattice.dims.y;
  std::fill(samples.begin(), samples.begin() + 75 * slice, std::int16_t{-1000});
  const brep::Mesh bone = brep::mesh_of(isosurface(scan, 300.0, 1e6));
  const brep::Mesh largest = brep::part_of(bone, brep::components(bone).front().faces);
  const brep::Mesh vault = brep::decimate(largest, {.max_error_mm = 1.0, .faces = 50000});
  ASSERT_EQ(vault.n_faces(), 50000U);
  TetOptions options;
  options.mesher = Mesher::Best;
  options.time_limit = std::chrono::minutes(9);  // a busy machine's elements are no others
  const Tetrahedra t = tetrahedralise(vault, options);
  const TetQuality q = quality(t);
  EXPECT_GT(q.min_dihedral_deg, 5.0);
  EXPECT_GT(q.min_volume_mm3, 0.0);
  EXPECT_NEAR(q.volume_mm3, brep::volume_mm3(vault), 1e-3 * brep::volume_mm3(vault));
}

TEST(Mesh3Tetrahedra, ATimeLimitTooSmallIsNamed) {
  TetOptions options;
  options.mesher = Mesher::Mesh3;
  options.time_limit = std::chrono::milliseconds(1);
  try {
    tetrahedralise(brep::mesh_of(ball({0, 0, 0}, 30.0, 5)), options);
    FAIL() << "it should have been refused";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("Mesh_3 did not end within the time limit of 1 ms"),
              std::string::npos)
        << error.what();
  }
}

TEST(Mesh3Tetrahedra, FilmsOfRealBoneAreLeftOutAndToldAndAThickShellNever) {
  // Films as they result from welding and splitting where a model's sheets touch.
  const brep::Triangles film{{{30, 0, 0}, {30.3, 0, 0}, {30, 0.3, 0}, {30.1, 0.1, 5e-4}},
                             {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  const Tetrahedra t = by_mesh3(together(ball({0, 0, 0}, 20.0, 3), film));
  EXPECT_GT(quality(t).min_dihedral_deg, 5.0);
  const auto told = std::find_if(t.findings.begin(), t.findings.end(), [](const std::string& finding) {
    return finding.find("left out 1 closed shell") != std::string::npos;
  });
  EXPECT_NE(told, t.findings.end());
  EXPECT_EQ(std::count_if(t.boundary_nodes.begin(), t.boundary_nodes.end(),
                          [&](std::uint32_t v) { return t.nodes_mm[v].x > 25.0; }),
            0);
  // The twin that may not be left out: its volume is over the tolerance.
  const brep::Triangles thick = together(ball({0, 0, 0}, 20.0, 3), box({30, 0, 0}, {40, 10, 1}));
  const Tetrahedra both = by_mesh3(thick);
  EXPECT_NEAR(quality(both).volume_mm3 / tests::volume_mm3(thick), 1.0, own_surface_volume_tolerance());
  EXPECT_GT(std::count_if(both.boundary_nodes.begin(), both.boundary_nodes.end(),
                          [&](std::uint32_t v) { return both.nodes_mm[v].x > 25.0; }),
            100);
}

}  // namespace
}  // namespace octotomy::convert
