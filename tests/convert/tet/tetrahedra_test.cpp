// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/tetrahedra.h"

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

TEST(TetQuality, ElementsAreCountedByTheirSmallestAngle) {
  // The regular tetrahedron, 70.5 degrees; a cube's corner, 54.7; and flat ones upon an equilateral base,
  // whose angles there are arctan(h / (side / (2 sqrt 3))).
  Tetrahedra t;
  const auto add = [&](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
    const auto n = static_cast<std::uint32_t>(t.nodes_mm.size());
    t.nodes_mm.insert(t.nodes_mm.end(), {a, b, c, d});
    t.tets.push_back({n, n + 1, n + 2, n + 3});
  };
  add({1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1});
  add({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  for (const double angle_deg : {4.9, 5.1, 9.9, 15.0, 25.0, 40.0}) {
    const double inner = 0.5 / std::sqrt(3.0);
    add({-0.5, -inner, 0}, {0.5, -inner, 0}, {0, 2.0 * inner, 0},
        {0, 0, inner * std::tan(glm::radians(angle_deg))});
  }
  EXPECT_EQ(quality(t).by_dihedral, (std::array<std::size_t, 6>{1, 2, 1, 1, 1, 2}));
}

TEST(BoundaryNodes, AreTheNodesOfFacesThatOnlyOneTetrahedronHas) {
  // A point inside a tetrahedron splits it in four; only the point is not on the surface.
  EXPECT_EQ(boundary_nodes({{4, 1, 2, 3}, {0, 4, 2, 3}, {0, 1, 4, 3}, {0, 1, 2, 4}}),
            (std::vector<std::uint32_t>{0, 1, 2, 3}));
}

}  // namespace
}  // namespace octotomy::convert
