// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/align/landmark_warp.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tbb/parallel_for.h>
#include <utility>

#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

/// Wendland's function (1-r)^4 (4r+1) of a distance of r reaches.
double wendland(double r) {
  if (r >= 1.0) return 0.0;
  const double square = (1.0 - r) * (1.0 - r);
  return square * square * (4.0 * r + 1.0);
}

bool is_finite(const glm::dvec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

void check(const std::vector<glm::dvec3>& points_mm, const std::vector<glm::dvec3>& displacement_mm,
           double reach_mm) {
  if (points_mm.empty() || points_mm.size() != displacement_mm.size())
    throw InvalidInput("a warp needs landmarks and one displacement for each, not " +
                       std::to_string(points_mm.size()) + " landmarks and " +
                       std::to_string(displacement_mm.size()) + " displacements");
  if (!(reach_mm > 0.0 && std::isfinite(reach_mm)))
    throw InvalidInput("a warp's reach must be above 0 mm, not " + std::to_string(reach_mm) + " mm");
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    if (!is_finite(points_mm[i]) || !is_finite(displacement_mm[i]))
      throw InvalidInput("landmark " + std::to_string(i + 1) + " or its displacement is not finite");
    for (std::size_t j = 0; j < i; ++j)
      if (points_mm[i] == points_mm[j])
        throw InvalidInput("landmarks " + std::to_string(j + 1) + " and " + std::to_string(i + 1) +
                           " coincide: place them apart");
  }
}

}  // namespace

LandmarkWarp::LandmarkWarp(std::vector<glm::dvec3> points_mm, const std::vector<glm::dvec3>& displacement_mm,
                           double reach_mm)
    : points_mm_(std::move(points_mm)), reach_mm_(reach_mm) {
  check(points_mm_, displacement_mm, reach_mm);
  const auto count = static_cast<Eigen::Index>(points_mm_.size());
  Eigen::MatrixXd shares(count, count), wanted(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto row = static_cast<std::size_t>(i);
    for (Eigen::Index j = 0; j < count; ++j)
      shares(i, j) =
          wendland(glm::distance(points_mm_[row], points_mm_[static_cast<std::size_t>(j)]) / reach_mm_);
    for (int axis = 0; axis < 3; ++axis) wanted(i, axis) = displacement_mm[row][axis];
  }
  const Eigen::MatrixXd weights = shares.ldlt().solve(wanted);
  for (Eigen::Index i = 0; i < count; ++i)
    weights_mm_.emplace_back(weights(i, 0), weights(i, 1), weights(i, 2));
}

glm::dvec3 LandmarkWarp::at(const glm::dvec3& p_mm) const {
  glm::dvec3 by_mm(0.0);
  for (std::size_t i = 0; i < points_mm_.size(); ++i)
    by_mm += wendland(glm::distance(p_mm, points_mm_[i]) / reach_mm_) * weights_mm_[i];
  return by_mm;
}

/// The Frobenius norm of the field's derivative, an upper bound of the field's largest stretch.
double LandmarkWarp::change_at(const glm::dvec3& p_mm) const {
  glm::dmat3 change(0.0);
  for (std::size_t i = 0; i < points_mm_.size(); ++i) {
    const glm::dvec3 off = (p_mm - points_mm_[i]) / reach_mm_;
    const double r = glm::length(off);
    if (r >= 1.0) continue;
    const double rest = 1.0 - r;
    // The derivative of Wendland's function is -20 r (1-r)^3, in the direction off / r.
    change += glm::outerProduct(weights_mm_[i], -20.0 * rest * rest * rest / reach_mm_ * off);
  }
  double sum = 0.0;
  for (int column = 0; column < 3; ++column) sum += glm::dot(change[column], change[column]);
  return std::sqrt(sum);
}

double LandmarkWarp::steepest() const {
  constexpr double cells_a_reach = 40.0;
  glm::dvec3 low_mm = points_mm_.front(), high_mm = points_mm_.front();
  double weights_mm = 0.0;
  for (std::size_t i = 0; i < points_mm_.size(); ++i) {
    low_mm = glm::min(low_mm, points_mm_[i]);
    high_mm = glm::max(high_mm, points_mm_[i]);
    weights_mm += glm::length(weights_mm_[i]);
  }
  const double cell_mm = reach_mm_ / cells_a_reach;
  const glm::ivec3 cells(glm::ceil((high_mm - low_mm + 2.0 * reach_mm_) / cell_mm));
  std::vector<double> of_layer(static_cast<std::size_t>(cells.z) + 1, 0.0);
  tbb::parallel_for(std::size_t{0}, of_layer.size(), [&](std::size_t z) {
    for (int y = 0; y <= cells.y; ++y)
      for (int x = 0; x <= cells.x; ++x)
        of_layer[z] = std::max(
            of_layer[z], change_at(low_mm - reach_mm_ + cell_mm * glm::dvec3(x, y, static_cast<double>(z))));
  });
  const double to_corner_mm = 0.5 * std::sqrt(3.0) * cell_mm;
  return *std::max_element(of_layer.begin(), of_layer.end()) +
         20.0 / (reach_mm_ * reach_mm_) * to_corner_mm * weights_mm;
}

Solid warped(const Solid& solid, const LandmarkWarp& warp) {
  if (solid.empty()) return solid;
  Triangles made = solid.triangles();
  tbb::parallel_for(std::size_t{0}, made.points_mm.size(),
                    [&](std::size_t i) { made.points_mm[i] += warp.at(made.points_mm[i]); });
  return trusted_solid(std::move(made), Proof::Connection);
}

}  // namespace octotomy::brep
