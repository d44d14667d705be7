// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <limits>

namespace octotomy::brep {

/// The sign of a sum of products in doubles; 0 if rounding may decide. `permanent` is the sum of the terms'
/// absolute values. The error bound is eight half epsilons of `permanent`, and two for the bound's own
/// rounding (Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates",
/// 1997, has seven for a determinant of three differences). Below `least` products may be lost to underflow.
inline int sure_sign(double determinant, double permanent) {
  constexpr double half_epsilon = 0.5 * std::numeric_limits<double>::epsilon();
  constexpr double share = 10.0 * half_epsilon;
  constexpr double least = 1e-250;
  const double bound = share * permanent;
  return !(permanent > least) ? 0 : determinant > bound ? 1 : determinant < -bound ? -1 : 0;
}

/// The plane through three points, and a test of the side of other points in doubles.
class SurePlane {
 public:
  SurePlane(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) : a_(a) {
    const double ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z;
    const double vx = c.x - a.x, vy = c.y - a.y, vz = c.z - a.z;
    const double yz = uy * vz, zy = uz * vy, zx = uz * vx, xz = ux * vz, xy = ux * vy, yx = uy * vx;
    nx_ = yz - zy;
    ny_ = zx - xz;
    nz_ = xy - yx;
    px_ = std::abs(yz) + std::abs(zy);
    py_ = std::abs(zx) + std::abs(xz);
    pz_ = std::abs(xy) + std::abs(yx);
  }
  /// The side of a point; 0 if rounding may decide. In half epsilons of the products, the error is at most
  /// four for a component of the normal, six for a component's product with a difference, and eight for the
  /// sum of these products.
  int side(const glm::dvec3& p) const {
    const double x = p.x - a_.x, y = p.y - a_.y, z = p.z - a_.z;
    return sure_sign(nx_ * x + ny_ * y + nz_ * z, px_ * std::abs(x) + py_ * std::abs(y) + pz_ * std::abs(z));
  }

 private:
  const glm::dvec3& a_;
  double nx_, ny_, nz_, px_, py_, pz_;
};

}  // namespace octotomy::brep
