// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>

// The changes of lengths, areas, volumes and angles by an affine map, and the rotation in the map.
namespace octotomy::planner {

/// Whether an affine map preserves lengths, so that it is a motion or a reflection. The tolerance allows for
/// matrices that were copied with six decimals.
bool keeps_lengths(const glm::dmat4& matrix);
/// Whether an affine map is a rotation and a translation, with the same tolerance.
bool is_rigid(const glm::dmat4& matrix);

/// Changes by an affine map. They are the same at every point, because the map is affine.
struct Deformation {
  double volume_factor = 1.0;  ///< determinant of the map; negative if it mirrors
  /// Least and greatest factor of a length: the smallest and largest singular value.
  double least_length = 1.0, greatest_length = 1.0;
  /// Least and greatest factor of an area: the products of two singular values.
  double least_area = 1.0, greatest_area = 1.0;
  double most_angle_deg = 0.0;  ///< the greatest change of the angle between two directions
};

/// Computes the changes by the linear part of an affine map. Precondition: the entries are finite. Factors
/// that overflow are infinite. Source of the angle: Tissot's indicatrix, sin(w / 2) = (a - b) / (a + b).
Deformation deformation_of(const glm::dmat3& map);

/// The greatest factor of a length; exactly 1 for a map that preserves lengths.
double stretch_of(const glm::dmat4& map);

/// Text such as "no rigid motion: volumes change by the factor 1.2, lengths by 0.9 to 1.3, angles by up to
/// 12°".
std::string in_words(const Deformation& deformation);

/// The rotation nearest to the linear part of a map. For a rigid map it is that part, to the bit.
/// Precondition: the determinant is positive.
glm::dmat3 nearest_rotation(const glm::dmat4& map);

}  // namespace octotomy::planner
