// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/solid.h"

namespace octotomy::brep {

/// Displacements of landmarks as a smooth field over space, LPS millimetres. At a landmark the field is that landmark's
/// displacement. It is zero farther than `reach_mm` from all landmarks. Each axis is a sum of Wendland's functions
/// (1-r)^4 (4r+1) about the landmarks, r = distance / reach_mm, which are positive definite: the sum always exists.
/// Source: Fornefett, Rohr, Stiehl, "Radial basis functions with compact support for elastic registration of medical
/// images", Image and Vision Computing 19 (2001).
class LandmarkWarp {
 public:
  /// Throws InvalidInput if the numbers of points and displacements differ or are 0, a number is not finite, `reach_mm`
  /// is not above 0, or two landmarks coincide. Cost: cubic in the landmarks.
  LandmarkWarp(std::vector<glm::dvec3> points_mm, const std::vector<glm::dvec3>& displacement_mm,
               double reach_mm);

  /// The displacement at a point, mm. Cost: linear in the landmarks.
  glm::dvec3 at(const glm::dvec3& p_mm) const;

  /// An upper bound of the field's rate of change, in mm per mm. Below 1 the field does not fold space: no
  /// two points are displaced to the same place. Computed from the rate at the points of a lattice with steps
  /// of a 40th of the reach. The bound adds the most that the rate can grow between them: the second
  /// derivative of a landmark's share is at most 20 / reach_mm^2 times its weight. Parallel. Cost: the rate
  /// at some million points.
  double steepest() const;

 private:
  double change_at(const glm::dvec3& p_mm) const;

  std::vector<glm::dvec3> points_mm_, weights_mm_;
  double reach_mm_;
};

/// The solid with each of its points displaced. Its triangles stay flat. Precondition: warp.steepest() is below 1.
/// Parallel. Cost: points times landmarks.
Solid warped(const Solid& solid, const LandmarkWarp& warp);

}  // namespace octotomy::brep
