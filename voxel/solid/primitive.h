// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

#include "voxel/space/lattice.h"

namespace octotomy::voxel {

// Solids with closed forms, in LPS millimetres. The boundary belongs to the solid. `lps_from_axes` is a
// rotation from the solid's own axes to LPS. An axis-aligned box is Box (lattice.h).

/// The points p with normal . p <= offset_mm; the normal, a unit vector, points outward.
struct HalfSpace {
  glm::dvec3 normal{0, 0, 1};
  double offset_mm = 0.0;
};
struct Sphere {
  glm::dvec3 centre_mm{0.0};
  double radius_mm = 1.0;
};
struct Ellipsoid {
  glm::dvec3 centre_mm{0.0};
  glm::dvec3 radii_mm{1.0};
  glm::dmat3 lps_from_axes{1.0};
};
struct OrientedBox {
  glm::dvec3 centre_mm{0.0};
  glm::dvec3 half_mm{1.0};  ///< half of its edges
  glm::dmat3 lps_from_axes{1.0};
};
/// Between two discs.
struct Cylinder {
  glm::dvec3 from_mm{0.0};
  glm::dvec3 to_mm{0, 0, 1};
  double radius_mm = 1.0;
};
/// A ring: the points at most tube_radius_mm from a circle.
struct Torus {
  glm::dvec3 centre_mm{0.0};
  glm::dvec3 axis{0, 0, 1};  ///< unit
  double ring_radius_mm = 2.0;
  double tube_radius_mm = 1.0;
};

/// Each throws std::invalid_argument with the fault: a number that is not finite, a length that is not
/// positive, an axis that is no unit vector, axes that are not at right angles, a tube as wide as its ring.
void check(const HalfSpace& half_space);
void check(const Sphere& sphere);
void check(const Box& box);
void check(const Ellipsoid& ellipsoid);
void check(const OrientedBox& box);
void check(const Cylinder& cylinder);
void check(const Torus& torus);

/// Whether a matrix preserves lengths: a rotation, or a rotation combined with a reflection.
bool is_isometry(const glm::dmat3& matrix);

}  // namespace octotomy::voxel
