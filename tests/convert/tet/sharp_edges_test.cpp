// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/sharp_edges.h"

#include <gtest/gtest.h>

#include "brep/mesh/mesh.h"
#include "convert/tet/element_faces.h"
#include "convert/tet/hinges.h"
#include "convert/tet/tetrahedralise.h"
#include "tests/convert/surfaces.h"

namespace octotomy::convert {
namespace {

/// Points along a box's twelve sides.
std::vector<glm::dvec3> side_points(const glm::dvec3& low, const glm::dvec3& high) {
  std::vector<glm::dvec3> points;
  for (int axis = 0; axis < 3; ++axis)
    for (int k = 0; k < 4; ++k)
      for (int i = 0; i <= 50; ++i) {
        glm::dvec3 share(0.0);
        share[axis] = i / 50.0;
        share[(axis + 1) % 3] = k % 2;
        share[(axis + 2) % 3] = k / 2;
        points.push_back(low + share * (high - low));
      }
  return points;
}

TEST(SharpEdges, OfABoxAreKeptByMeshersThatMakeASurfaceOfTheirOwn) {
  const glm::dvec3 low(0.3, 0.1, -0.2), high(10.1, 10.4, 30.3);
  for (const Mesher mesher : {Mesher::Mesh3, Mesher::Stuffing}) {
    TetOptions options;
    options.mesher = mesher;
    options.max_volume_mm3 = 4.0;
    const Tetrahedra t = tetrahedralise(brep::mesh_of(tests::box(low, high)), options);
    const std::vector<double> away_mm = brep::SurfaceTree(surface_of(t)).distances_mm(side_points(low, high));
    const auto near = std::count_if(away_mm.begin(), away_mm.end(), [](double mm) { return mm < 1e-6; });
    // If no element would stay good, the edge stays cut off.
    EXPECT_GT(near, 90 * static_cast<std::ptrdiff_t>(away_mm.size()) / 100) << t.method;
    EXPECT_GE(quality(t).min_dihedral_deg, fit_dihedral_deg()) << t.method;
    // Nodes outside the faces make up for the volume of notches: few notches are left.
    const std::vector<double> off_mm = brep::SurfaceTree(tests::box(low, high)).distances_mm(t.nodes_mm);
    const auto off = std::count_if(t.boundary_nodes.begin(), t.boundary_nodes.end(),
                                   [&](std::uint32_t v) { return off_mm[v] > 1e-6; });
    EXPECT_LT(off, 5 * static_cast<std::ptrdiff_t>(t.boundary_nodes.size()) / 100) << t.method;
    EXPECT_EQ(hinge_in(t), std::nullopt) << t.method;
    EXPECT_EQ(t.boundary_nodes, boundary_nodes(t.tets)) << t.method;
    EXPECT_NEAR(quality(t).volume_mm3, 9.8 * 10.3 * 30.5, 2e-3 * 9.8 * 10.3 * 30.5) << t.method;
  }
}

TEST(SharpEdges, ASmoothSurfaceIsLeftAloneToTheBit) {
  const brep::Triangles ball = tests::ball({0, 0, 0}, 10.0, 4);
  TetOptions options;
  options.mesher = Mesher::Stuffing;
  Tetrahedra t = tetrahedralise(brep::mesh_of(ball), options);
  const std::vector<glm::dvec3> before = t.nodes_mm;
  EXPECT_TRUE(put_on_sharp_edges(t, {ball, brep::SurfaceTree(ball)}, 5.0).empty());
  EXPECT_EQ(t.nodes_mm, before);
}

}  // namespace
}  // namespace octotomy::convert
