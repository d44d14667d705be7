// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>

// The trilinear interpolant of a cell along a straight line. It is a cubic function of the share, 0 to 1, of
// the line's way through the cell.
namespace octotomy::verify {

/// Coefficients, the constant first.
using Cubic = std::array<double, 4>;

/// The values at a cell's corners, x fastest.
using CellCorners = std::array<double, 8>;

/// The interpolant between two points of the cell. Points are in shares 0..1 of the cell's edges.
Cubic cubic_along(const CellCorners& corners, const glm::dvec3& from, const glm::dvec3& to);

/// A part of 0..1.
struct Share {
  double low = 0.0, high = 1.0;
};

/// Parts of 0..1 in ascending order. Successive parts may touch.
struct Shares {
  std::array<Share, 3> parts{};
  std::size_t count = 0;

  const Share* begin() const { return parts.data(); }
  const Share* end() const { return parts.data() + count; }
};

/// Returns the parts of 0..1 in which the cubic is at least `low` and at most `high`; both may be infinite.
/// The cubic is monotonic between its extrema, so there is at most one part between two extrema, and no part
/// is missed. Ends are exact up to rounding. Precondition: the coefficients are finite.
Shares shares_within(const Cubic& cubic, double low, double high);

}  // namespace octotomy::verify
