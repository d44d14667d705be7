// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>

// The changes that an affine motion makes to lengths, areas, volumes and angles, and the rotation in it.
namespace octotomy::planner {

/// Whether an affine map is a motion or a reflection, to the six decimals with which matrices are copied.
bool keeps_lengths(const glm::dmat4& matrix);
/// Whether it is a rotation and a translation.
bool is_rigid(const glm::dmat4& matrix);

/// Factors and angles hold for all directions at once, because an affine map is the same at every place.
struct Deformation {
  double volume_factor = 1.0;  ///< the determinant; negative: the map mirrors
  /// Least and greatest factor of a length: the smallest and largest singular value.
  double least_length = 1.0, greatest_length = 1.0;
  /// Least and greatest factor of an area: the products of two singular values.
  double least_area = 1.0, greatest_area = 1.0;
  double most_angle_deg = 0.0;  ///< the greatest change of an angle between two directions
};

/// The deformation by the linear part of an affine map. Precondition: the entries are finite. Factors that
/// overflow are infinite. Source of the angle: Tissot's indicatrix, sin(w / 2) = (a - b) / (a + b).
Deformation deformation_of(const glm::dmat3& map);

/// The greatest factor of a length; exactly 1 for a map that keeps lengths.
double stretch_of(const glm::dmat4& map);

/// "no rigid motion: volumes change by the factor 1.2, lengths by 0.9 to 1.3, angles by up to 12°".
std::string in_words(const Deformation& deformation);

/// The rotation that is nearest to a map's linear part: that part itself, to the bit, if the map is rigid.
/// Precondition: the determinant is positive.
glm::dmat3 nearest_rotation(const glm::dmat4& map);

}  // namespace octotomy::planner
