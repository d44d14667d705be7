// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/primitive.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

void need(bool holds, const std::string& message) {
  if (!holds) throw InvalidInput(message);
}

bool finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// The tolerance for orthonormal columns. The columns of a product of a few rotations deviate by a few units
// in the last place; numbers read from text with nine digits are accurate to 1e-9. A scale or shear that
// moves points 300 mm away by a micrometre is 3e-6. The square root of epsilon, 1.5e-8, lies between these
// values.
double unit_slack() {
  return std::sqrt(std::numeric_limits<double>::epsilon());
}

bool unit(const glm::dvec3& v) {
  return finite(v) && std::abs(glm::length(v) - 1.0) <= unit_slack();
}

void positive(const std::string& what, double length_mm) {
  need(std::isfinite(length_mm) && length_mm > 0.0,
       what + " must be a positive number of millimetres, not " + std::to_string(length_mm));
}

}  // namespace

void check(const Sphere& sphere) {
  need(finite(sphere.centre_mm), "a sphere's centre has a coordinate that is not a finite number");
  positive("a sphere's radius", sphere.radius_mm);
}

void check(const Ellipsoid& ellipsoid) {
  need(finite(ellipsoid.centre_mm), "an ellipsoid's centre has a coordinate that is not a finite number");
  for (int axis = 0; axis < 3; ++axis) positive("an ellipsoid's radius", ellipsoid.radii_mm[axis]);
  need(is_isometry(ellipsoid.lps_from_axes), "an ellipsoid's axes must be unit vectors at right angles");
}

void check(const Box& box) {
  need(finite(box.low_mm) && finite(box.high_mm), "a box has a coordinate that is not a finite number");
  for (int axis = 0; axis < 3; ++axis) positive("a box's edge", box.high_mm[axis] - box.low_mm[axis]);
}

void check(const OrientedBox& box) {
  need(finite(box.centre_mm), "a box's centre has a coordinate that is not a finite number");
  for (int axis = 0; axis < 3; ++axis) positive("half a box's edge", box.half_mm[axis]);
  need(is_isometry(box.lps_from_axes), "a box's axes must be unit vectors at right angles");
}

void check(const HalfSpace& half_space) {
  need(unit(half_space.normal), "a half-space's normal must be a unit vector");
  need(std::isfinite(half_space.offset_mm), "a half-space's offset is not a finite number");
}

void check(const Cylinder& cylinder) {
  need(finite(cylinder.from_mm) && finite(cylinder.to_mm),
       "a cylinder's end has a coordinate that is not a finite number");
  positive("a cylinder's length", glm::distance(cylinder.from_mm, cylinder.to_mm));
  positive("a cylinder's radius", cylinder.radius_mm);
}

void check(const Torus& torus) {
  need(finite(torus.centre_mm), "a torus's centre has a coordinate that is not a finite number");
  need(unit(torus.axis), "a torus's axis must be a unit vector");
  positive("a torus's tube radius", torus.tube_radius_mm);
  positive("a torus's ring radius less its tube radius", torus.ring_radius_mm - torus.tube_radius_mm);
}

bool is_isometry(const glm::dmat3& matrix) {
  const glm::dmat3 gram = glm::transpose(matrix) * matrix;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      if (!(std::abs(gram[column][row] - (column == row ? 1.0 : 0.0)) <= unit_slack())) return false;
  return true;
}

}  // namespace octotomy::voxel
