// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/deformation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "planner/operation/table/number_format.h"

namespace octotomy::planner {
namespace {

/// Singular values, the largest first, by Jacobi rotations of the columns (Hestenes 1958): each rotation makes
/// two columns orthogonal, and at the end the columns' lengths are the values. Small values keep their relative
/// accuracy, which they would lose in the squares of the Gram matrix.
std::array<double, 3> singular_values(glm::dmat3 map) {
  // Three columns are orthogonal to rounding after four sweeps; the rest is a margin.
  constexpr int most_sweeps = 30;
  constexpr double rounding = 1e-15;
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    bool is_done = true;
    for (const auto& [p, q] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)}) {
      const double pp = glm::dot(map[p], map[p]), qq = glm::dot(map[q], map[q]),
                   pq = glm::dot(map[p], map[q]);
      if (!(std::abs(pq) > rounding * std::sqrt(pp) * std::sqrt(qq))) continue;
      is_done = false;
      const double angle = 0.5 * std::atan2(2.0 * pq, pp - qq);
      const glm::dvec3 first = std::cos(angle) * map[p] + std::sin(angle) * map[q];
      map[q] = std::cos(angle) * map[q] - std::sin(angle) * map[p];
      map[p] = first;
    }
    if (is_done) break;
  }
  std::array<double, 3> values{glm::length(map[0]), glm::length(map[1]), glm::length(map[2])};
  std::sort(values.rbegin(), values.rend());
  return values;
}

}  // namespace

bool keeps_lengths(const glm::dmat4& matrix) {
  constexpr double rigid_to = 1e-5;  // the numbers are copied with six decimals
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
  const auto [a, b, c] = singular_values(map);
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
  // The mean of a matrix and its inverse transpose moves each singular value s to (s + 1 / s) / 2, which converges
  // to 1 quadratically. From 0.01 or 100 eleven steps suffice.
  constexpr int most_steps = 40;
  glm::dmat3 turn(map);
  for (int step = 0; step < most_steps; ++step) {
    const glm::dmat3 next = 0.5 * (turn + glm::inverse(glm::transpose(turn)));
    double change = 0.0;
    for (int column = 0; column < 3; ++column)
      change = std::max(change, glm::distance(next[column], turn[column]));
    turn = next;
    if (!(change > 1e-15)) break;
  }
  return turn;
}

}  // namespace octotomy::planner
