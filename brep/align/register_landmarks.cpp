// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 pair landmarks by name; 2 centre both sets; 3 find the best rotation: the eigenvector of largest
// eigenvalue of Horn's symmetric 4 x 4 matrix, by Jacobi's rotations, or the rotation that makes the frames
// of three points coincide; 4 compute scale and translation. If the two largest eigenvalues are equal, the
// rotation is undetermined.
#include "brep/align/register_landmarks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

using Symmetric = std::array<std::array<double, 4>, 4>;

struct Pair {
  glm::dvec3 from{0.0}, to{0.0};
  double weight = 1.0;
};

/// A set counts as lying on one line if its points are near the line from its centre to its outermost point:
/// within this share of the outermost point's distance from the centre. Landmarks on a head of about 200 mm
/// are placed to a tenth of a millimetre at best, so a smaller spread is only noise.
constexpr double line_share() {
  return 0.1 / 200.0;
}

std::map<std::string, Landmark> by_name(const std::vector<Landmark>& set, const std::string& which) {
  std::map<std::string, Landmark> named;
  for (const Landmark& mark : set) {
    const bool finite =
        std::isfinite(mark.p_mm.x) && std::isfinite(mark.p_mm.y) && std::isfinite(mark.p_mm.z);
    if (!finite || !(mark.weight > 0.0) || !std::isfinite(mark.weight))
      throw InvalidInput("register: landmark '" + mark.name + "' of the " + which +
                         " set has a point that is not finite or a weight that is not positive");
    if (!named.emplace(mark.name, mark).second)
      throw InvalidInput("register: landmark '" + mark.name + "' occurs twice in the " + which +
                         " set: rename or delete one");
  }
  return named;
}

/// Leaves the eigenvalues on the diagonal of `a` and the eigenvectors in the columns of `v`. Cyclic Jacobi
/// converges quadratically: for 4 x 4 six sweeps reach rounding, forty are never reached.
void diagonalise(Symmetric& a, Symmetric& v) {
  v = {};
  for (std::size_t k = 0; k < 4; ++k) v[k][k] = 1.0;
  for (int sweep = 0; sweep < 40; ++sweep) {
    double off = 0.0, whole = 0.0;
    for (std::size_t r = 0; r < 4; ++r)
      for (std::size_t c = 0; c < 4; ++c) (r == c ? whole : off) += a[r][c] * a[r][c];
    const double unit = std::numeric_limits<double>::epsilon();
    if (off <= unit * unit * (whole + off)) return;
    for (std::size_t p = 0; p < 3; ++p)
      for (std::size_t q = p + 1; q < 4; ++q) {
        if (a[p][q] == 0.0) continue;
        const double angle = 0.5 * std::atan2(2.0 * a[p][q], a[q][q] - a[p][p]);
        const double c = std::cos(angle), s = std::sin(angle);
        const auto turn = [&](double& x, double& y) {
          const double old = x;
          x = c * old - s * y;
          y = s * old + c * y;
        };
        for (std::size_t k = 0; k < 4; ++k) turn(a[k][p], a[k][q]);
        for (std::size_t k = 0; k < 4; ++k) turn(a[p][k], a[q][k]);
        for (std::size_t k = 0; k < 4; ++k) turn(v[k][p], v[k][q]);
      }
  }
}

/// Whether the points `which`, relative to their centre, lie on a line through the centre. They may be off it
/// by line_share() of the farthest point's distance from the centre.
bool on_a_line(const std::vector<Pair>& pairs, glm::dvec3 Pair::*which) {
  glm::dvec3 far(0.0);
  for (const Pair& pair : pairs)
    if (glm::length(pair.*which) > glm::length(far)) far = pair.*which;
  const double reach = glm::length(far);
  if (reach == 0.0) return true;
  const auto across = [&](const Pair& pair) { return glm::length(glm::cross(pair.*which, far / reach)); };
  return std::all_of(pairs.begin(), pairs.end(),
                     [&](const Pair& pair) { return across(pair) <= line_share() * reach; });
}

/// An orthonormal frame at the first point: its first column points to the second point, and the third point
/// lies in the plane of the first two columns.
glm::dmat3 frame_of(const std::vector<Pair>& pairs, glm::dvec3 Pair::*which) {
  const glm::dvec3 x = glm::normalize(pairs[1].*which);
  const glm::dvec3 z = glm::normalize(glm::cross(pairs[1].*which, pairs[2].*which));
  return {x, glm::cross(z, x), z};
}

/// The points that the motion makes coincide: the weighted centres of both sets, or the first pair.
Pair anchor_of(const std::vector<Pair>& pairs, MotionModel motion) {
  if (motion == MotionModel::three_points) return pairs.front();
  Pair anchor{glm::dvec3(0.0), glm::dvec3(0.0), 0.0};
  for (const Pair& pair : pairs) {
    anchor.weight += pair.weight;
    anchor.from += pair.weight * pair.from;
    anchor.to += pair.weight * pair.to;
  }
  anchor.from /= anchor.weight;
  anchor.to /= anchor.weight;
  return anchor;
}

glm::dmat3 best_turn(const std::vector<Pair>& pairs) {
  glm::dmat3 s(0.0);  // s[column][row]: sum of weight * from[row] * to[column]
  for (const Pair& pair : pairs) s += glm::outerProduct(pair.weight * pair.from, pair.to);
  const auto m = [&](int row, int column) { return s[column][row]; };
  Symmetric n = {{{m(0, 0) + m(1, 1) + m(2, 2), m(1, 2) - m(2, 1), m(2, 0) - m(0, 2), m(0, 1) - m(1, 0)},
                  {0.0, m(0, 0) - m(1, 1) - m(2, 2), m(0, 1) + m(1, 0), m(2, 0) + m(0, 2)},
                  {0.0, 0.0, -m(0, 0) + m(1, 1) - m(2, 2), m(1, 2) + m(2, 1)},
                  {0.0, 0.0, 0.0, -m(0, 0) - m(1, 1) + m(2, 2)}}};
  for (std::size_t r = 1; r < 4; ++r)
    for (std::size_t c = 0; c < r; ++c) n[r][c] = n[c][r];
  Symmetric vectors;
  diagonalise(n, vectors);
  std::size_t best = 0;
  for (std::size_t k = 1; k < 4; ++k)
    if (n[k][k] > n[best][best]) best = k;
  return glm::mat3_cast(
      glm::normalize(glm::dquat(vectors[0][best], vectors[1][best], vectors[2][best], vectors[3][best])));
}

}  // namespace

LandmarkFit register_landmarks(const std::vector<Landmark>& moving, const std::vector<Landmark>& fixed,
                               MotionModel motion) {
  const auto from = by_name(moving, "moving"), to = by_name(fixed, "fixed");
  LandmarkFit fit;
  std::vector<Pair> pairs;
  for (const Landmark& mark : moving) {
    const auto other = to.find(mark.name);
    if (other == to.end()) {
      fit.left_out.push_back(mark.name);
      continue;
    }
    fit.paired.push_back(mark.name);
    pairs.push_back({mark.p_mm, other->second.p_mm, mark.weight * other->second.weight});
  }
  for (const Landmark& mark : fixed)
    if (!from.contains(mark.name)) fit.left_out.push_back(mark.name);
  if (pairs.size() < 3)
    throw InvalidInput("register: " + std::to_string(pairs.size()) +
                       " landmarks have names found in both sets, three are needed: check spelling");

  const Pair anchor = anchor_of(pairs, motion);
  for (Pair& pair : pairs) {
    pair.from -= anchor.from;
    pair.to -= anchor.to;
  }
  const std::vector<Pair> deciding(pairs.begin(),
                                   motion == MotionModel::three_points ? pairs.begin() + 3 : pairs.end());
  if (on_a_line(deciding, &Pair::from) || on_a_line(deciding, &Pair::to))
    throw InvalidInput(
        "register: the landmarks found in both sets lie on one line, so the rotation about that line is "
        "undetermined: add a landmark off the line");

  const glm::dmat3 turn = motion == MotionModel::three_points
                              ? frame_of(pairs, &Pair::to) * glm::transpose(frame_of(pairs, &Pair::from))
                              : best_turn(pairs);
  double along = 0.0, spread = 0.0;
  for (const Pair& pair : pairs) {
    along += pair.weight * glm::dot(pair.to, turn * pair.from);
    spread += pair.weight * glm::dot(pair.from, pair.from);
  }
  if (motion == MotionModel::similarity) fit.scale = along / spread;
  if (!(fit.scale > 0.0))
    throw InvalidInput(
        "register: no positive scale fits these landmarks: check whether names are interchanged");
  const glm::dmat3 linear = fit.scale * turn;
  fit.fixed_from_moving = glm::dmat4(linear);
  fit.fixed_from_moving[3] = glm::dvec4(anchor.to - linear * anchor.from, 1.0);

  double squares = 0.0, weight = 0.0;
  for (const Pair& pair : pairs) {
    weight += pair.weight;
    const double residual = glm::distance(linear * pair.from, pair.to);
    fit.residuals_mm.push_back(residual);
    squares += pair.weight * residual * residual;
  }
  fit.rms_mm = std::sqrt(squares / weight);
  return fit;
}

}  // namespace octotomy::brep
