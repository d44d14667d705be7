// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/deformation.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>

#include "planner/operation/table/number_format.h"

namespace octotomy::planner {
namespace {

using Svd = Eigen::JacobiSVD<Eigen::Matrix3d>;

/// The singular values are in descending order.
Svd svd_of(const glm::dmat3& map) {
  return Svd(Eigen::Map<const Eigen::Matrix3d>(glm::value_ptr(map)),
             Eigen::ComputeFullU | Eigen::ComputeFullV);
}

}  // namespace

bool keeps_lengths(const glm::dmat4& matrix) {
  constexpr double rigid_to = 1e-5;  // tolerance of a matrix that was copied with six decimals
  const glm::dmat3 turn(matrix);
  const glm::dmat3 off = glm::transpose(turn) * turn - glm::dmat3(1.0);
  double worst = 0.0;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) worst = std::max(worst, std::abs(off[column][row]));
  const glm::dvec4 last = glm::transpose(matrix)[3];
  return worst <= rigid_to && last == glm::dvec4(0, 0, 0, 1);
}

bool is_rigid(const glm::dmat4& matrix) {
  return keeps_lengths(matrix) && glm::determinant(glm::dmat3(matrix)) > 0.0;
}

Deformation deformation_of(const glm::dmat3& map) {
  const Eigen::Vector3d values = svd_of(map).singularValues();
  const double a = values[0], b = values[1], c = values[2];
  Deformation made;
  made.volume_factor = glm::determinant(map);
  made.least_length = c;
  made.greatest_length = a;
  made.least_area = b * c;
  made.greatest_area = a * b;
  if (a > 0.0) made.most_angle_deg = glm::degrees(2.0 * std::asin((a - c) / (a + c)));
  return made;
}

double stretch_of(const glm::dmat4& map) {
  return keeps_lengths(map) ? 1.0 : deformation_of(glm::dmat3(map)).greatest_length;
}

std::string in_words(const Deformation& deformation) {
  return "no rigid motion: volumes change by the factor " + three_figures(deformation.volume_factor) +
         ", lengths by " + three_figures(deformation.least_length) + " to " +
         three_figures(deformation.greatest_length) + ", angles by up to " +
         three_figures(deformation.most_angle_deg) + "\u00b0";
}

glm::dmat3 nearest_rotation(const glm::dmat4& map) {
  if (is_rigid(map)) return glm::dmat3(map);
  const Svd svd = svd_of(glm::dmat3(map));
  const Eigen::Matrix3d turn = svd.matrixU() * svd.matrixV().transpose();
  return glm::make_mat3(turn.data());
}

}  // namespace octotomy::planner
