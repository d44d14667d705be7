// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tetrahedra.h"

#include <cmath>
#include <gtest/gtest.h>

namespace octotomy::convert {
namespace {

Tetrahedra single(const std::array<glm::dvec3, 4>& p) {
  Tetrahedra t;
  t.nodes_mm.assign(p.begin(), p.end());
  t.tets = {{0, 1, 2, 3}};
  return t;
}

TEST(TetQuality, OfTheRegularTetrahedronIsTheClosedForm) {
  const TetQuality q = quality(single({{{1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}}}));
  const double dihedral = glm::degrees(std::acos(1.0 / 3.0));
  EXPECT_NEAR(q.min_dihedral_deg, dihedral, 1e-12);
  EXPECT_NEAR(q.min_dihedral_deg, 70.5288, 1e-4);
  EXPECT_NEAR(q.max_dihedral_deg, dihedral, 1e-12);
  EXPECT_NEAR(q.max_radius_edge, std::sqrt(6.0) / 4.0, 1e-14);
  EXPECT_NEAR(q.volume_mm3, 8.0 / 3.0, 1e-14);
}

TEST(TetQuality, OfACubesCornerIsTheClosedForm) {
  const TetQuality q = quality(single({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}));
  EXPECT_NEAR(q.volume_mm3, 1.0 / 6.0, 1e-15);
  EXPECT_NEAR(q.max_dihedral_deg, 90.0, 1e-12);
  EXPECT_NEAR(q.min_dihedral_deg, glm::degrees(std::acos(1.0 / std::sqrt(3.0))), 1e-12);
  EXPECT_NEAR(q.max_radius_edge, std::sqrt(3.0) / 2.0, 1e-14);
}

TEST(TetQuality, ATurnedTetrahedronHasNegativeVolumeSoTheOrderOfCornersIsTested) {
  EXPECT_LT(quality(single({{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}}})).min_volume_mm3, 0.0);
}

TEST(BoundaryNodes, AreTheNodesOfFacesThatOnlyOneTetrahedronHas) {
  // A point inside a tetrahedron splits it in four; only the point is not on the surface.
  EXPECT_EQ(boundary_nodes({{4, 1, 2, 3}, {0, 4, 2, 3}, {0, 1, 4, 3}, {0, 1, 2, 4}}),
            (std::vector<std::uint32_t>{0, 1, 2, 3}));
}

}  // namespace
}  // namespace octotomy::convert
