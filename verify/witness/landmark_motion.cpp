// SPDX-License-Identifier: AGPL-3.0-or-later
// The weights are computed by elimination with a choice of pivots. Neither kernel solves the system in this way.
#include "verify/witness/landmark_motion.h"

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "verify/witness/moved_points.h"

namespace octotomy::verify {
namespace {

double weight_at_distance(double distance_mm, double reach_mm) {
  const double left = 1.0 - distance_mm / reach_mm;
  return left > 0.0 ? left * left * left * left * (5.0 - 4.0 * left) : 0.0;
}

/// Solves a system of linear equations by elimination. `right` has the right side of each row. Throws
/// std::invalid_argument if the matrix has no inverse.
std::vector<glm::dvec3> solved(std::vector<std::vector<double>> rows, std::vector<glm::dvec3> right) {
  const std::size_t count = rows.size();
  for (std::size_t pivot = 0; pivot < count; ++pivot) {
    std::size_t best = pivot;
    for (std::size_t row = pivot + 1; row < count; ++row)
      if (std::abs(rows[row][pivot]) > std::abs(rows[best][pivot])) best = row;
    if (rows[best][pivot] == 0.0) throw std::invalid_argument("two landmarks of a motion coincide");
    std::swap(rows[pivot], rows[best]);
    std::swap(right[pivot], right[best]);
    for (std::size_t row = 0; row < count; ++row) {
      if (row == pivot) continue;
      const double times = rows[row][pivot] / rows[pivot][pivot];
      for (std::size_t column = pivot; column < count; ++column)
        rows[row][column] -= times * rows[pivot][column];
      right[row] -= times * right[pivot];
    }
  }
  for (std::size_t row = 0; row < count; ++row) right[row] /= rows[row][row];
  return right;
}

}  // namespace

LandmarkMotion::LandmarkMotion(std::vector<glm::dvec3> landmarks_mm, std::vector<glm::dvec3> displacement_mm,
                               double reach_mm)
    : landmarks_mm_(std::move(landmarks_mm)), reach_mm_(reach_mm) {
  if (landmarks_mm_.empty() || displacement_mm.size() != landmarks_mm_.size())
    throw std::invalid_argument("a motion of landmarks needs one displacement for each landmark, not " +
                                std::to_string(displacement_mm.size()) + " of " +
                                std::to_string(landmarks_mm_.size()));
  std::vector<std::vector<double>> rows;
  for (const glm::dvec3& a : landmarks_mm_) {
    rows.emplace_back();
    for (const glm::dvec3& b : landmarks_mm_)
      rows.back().push_back(weight_at_distance(glm::distance(a, b), reach_mm_));
  }
  weights_mm_ = solved(std::move(rows), std::move(displacement_mm));
}

glm::dvec3 LandmarkMotion::displacement_mm(const glm::dvec3& p_mm) const {
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < landmarks_mm_.size(); ++i)
    sum += weight_at_distance(glm::distance(p_mm, landmarks_mm_[i]), reach_mm_) * weights_mm_[i];
  return sum;
}

std::optional<glm::dvec3> LandmarkMotion::origin_mm(const glm::dvec3& p_mm,
                                                    const glm::dvec3& guess_mm) const {
  return origin_under(*this, p_mm, guess_mm);
}

ReshapedSurface surface_warped(const brep::Triangles& still, const LandmarkMotion& motion) {
  // Landmarks near each other have large weights of opposite signs, whose sum loses up to four digits.
  return surface_moved(still, motion, 64e4, "64e4 eps |p|: the same displacements by other code");
}

Witness witness_of_warped(Witness still, const brep::Triangles& still_surface,
                          std::shared_ptr<const LandmarkMotion> motion) {
  if (!still) return {};
  return witness_of_moved_points(std::move(still), still_surface, std::move(motion));
}

}  // namespace octotomy::verify
