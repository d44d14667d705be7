// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/witness/cell_cubic.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace octotomy::verify {
namespace {

double value(const Cubic& cubic, double at) {
  return ((cubic[3] * at + cubic[2]) * at + cubic[1]) * at + cubic[0];
}

double slope(const Cubic& cubic, double at) {
  return (3.0 * cubic[3] * at + 2.0 * cubic[2]) * at + cubic[1];
}

/// Returns the position at which the cubic has the value `level`: Newton's method in a stretch that shrinks
/// around the crossing. A step that would leave the stretch goes to its middle instead. Precondition: the
/// values at the ends of the stretch lie on different sides of `level`.
double crossing(const Cubic& cubic, double level, Share stretch) {
  constexpr int most_steps = 200;
  constexpr double close = 1e-15;
  double low_value = value(cubic, stretch.low) - level;
  const double high_value = value(cubic, stretch.high) - level;
  double at = stretch.low + (stretch.high - stretch.low) * (low_value / (low_value - high_value));
  for (int step = 0; step < most_steps && stretch.high - stretch.low > close; ++step) {
    if (!(at > stretch.low && at < stretch.high)) at = 0.5 * (stretch.low + stretch.high);
    const double here = value(cubic, at) - level;
    if (here == 0.0) return at;
    if ((here < 0.0) == (low_value < 0.0)) {
      stretch.low = at;
      low_value = here;
    } else {
      stretch.high = at;
    }
    const double next = at - here / slope(cubic, at);
    if (std::abs(next - at) <= close) return at;
    at = next;
  }
  return 0.5 * (stretch.low + stretch.high);
}

}  // namespace

Cubic cubic_along(const CellCorners& corners, const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 way = to - from;
  // Interpolation along x yields four lines, along y two parabolas, along z the cubic.
  std::array<std::array<double, 2>, 4> rows;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double change = corners[2 * i + 1] - corners[2 * i];
    rows[i] = {corners[2 * i] + from.x * change, way.x * change};
  }
  std::array<std::array<double, 3>, 2> slices;
  for (std::size_t i = 0; i < slices.size(); ++i) {
    const auto& [a0, a1] = rows[2 * i];
    const double d0 = rows[2 * i + 1][0] - a0, d1 = rows[2 * i + 1][1] - a1;
    slices[i] = {a0 + from.y * d0, a1 + from.y * d1 + way.y * d0, way.y * d1};
  }
  const auto& [a0, a1, a2] = slices[0];
  const double d0 = slices[1][0] - a0, d1 = slices[1][1] - a1, d2 = slices[1][2] - a2;
  return {a0 + from.z * d0, a1 + from.z * d1 + way.z * d0, a2 + from.z * d2 + way.z * d1, way.z * d2};
}

Shares shares_within(const Cubic& cubic, double low, double high) {
  // The slope of the cubic is cubic[1] + 2 h s + a s^2. The formula of its roots loses no digits by
  // cancellation.
  std::array<double, 4> ends{0.0};
  std::size_t last = 0;
  const double h = cubic[2], a = 3.0 * cubic[3];
  const double discriminant = h * h - a * cubic[1];
  if (discriminant > 0.0) {
    const double q = -(h + std::copysign(std::sqrt(discriminant), h));
    double first = q / a, second = cubic[1] / q;
    if (second < first) std::swap(first, second);
    for (const double extremum : {first, second})
      if (extremum > ends[last] && extremum < 1.0) ends[++last] = extremum;
  }
  ends[++last] = 1.0;

  Shares made;
  double from = value(cubic, 0.0);
  for (std::size_t i = 0; i < last; ++i) {
    const Share stretch{ends[i], ends[i + 1]};
    const double to = value(cubic, stretch.high);
    if (std::max(from, to) >= low && std::min(from, to) <= high) {
      Share part = stretch;
      if (from < low) part.low = crossing(cubic, low, stretch);
      if (from > high) part.low = crossing(cubic, high, stretch);
      if (to < low) part.high = crossing(cubic, low, stretch);
      if (to > high) part.high = crossing(cubic, high, stretch);
      made.parts[made.count++] = part;
    }
    from = to;
  }
  return made;
}

}  // namespace octotomy::verify
