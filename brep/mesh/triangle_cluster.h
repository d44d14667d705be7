// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>

namespace octotomy::brep {

/// The moments and extent of triangles near each other, LPS millimetres. From these, the triangles' solid
/// angle at far points can be computed.
struct TriangleCluster {
  glm::dvec3 centre_mm{0.0};
  double radius_mm = 0.0;  ///< radius of a ball around the centre that contains all corners
  double area_mm2 = 0.0;
  glm::dvec3 normal{0.0};  ///< sum of area vectors
  glm::dmat3 moment{0.0};  ///< column j: sum of area vectors times coordinate j of (middle - centre)
};

/// The cluster of some triangles. Precondition: there is at least one.
TriangleCluster cluster_of(std::span<const std::array<glm::dvec3, 3>> triangles);
/// Of two clusters.
TriangleCluster cluster_of(const TriangleCluster& a, const TriangleCluster& b);

}  // namespace octotomy::brep
