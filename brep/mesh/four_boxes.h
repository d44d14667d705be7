// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>

// Nodes of a tree of boxes. One vector operation tests the four boxes of a node against a point, a segment or a ray
// (Wald, Benthin, Boulos, "Getting rid of packets", RT 2008). Boxes are floats, rounded outward.
namespace octotomy::brep {

/// A box; empty at first.
struct TreeBox {
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high{-std::numeric_limits<double>::infinity()};
  void add(const TreeBox& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
  }
  double squared_distance(const glm::dvec3& p) const {
    const glm::dvec3 d = glm::max(glm::max(low - p, p - high), glm::dvec3(0.0));
    return glm::dot(d, d);
  }
};

/// The nearest floats that are not above, or not below, a double.
inline float rounded_down(double number) {
  const auto nearest = static_cast<float>(number);
  return static_cast<double>(nearest) <= number
             ? nearest
             : std::nextafter(nearest, -std::numeric_limits<float>::infinity());
}
inline float rounded_up(double number) {
  return -rounded_down(-number);
}
inline glm::vec3 rounded_down(const glm::dvec3& p) {
  return {rounded_down(p.x), rounded_down(p.y), rounded_down(p.z)};
}
inline glm::vec3 rounded_up(const glm::dvec3& p) {
  return {rounded_up(p.x), rounded_up(p.y), rounded_up(p.z)};
}

/// Four floats of one vector register.
using Lanes = float __attribute__((vector_size(16)));
using ThreeLanes = std::array<Lanes, 3>;

inline Lanes lanes_of(float number) {
  return Lanes{number, number, number, number};
}
inline ThreeLanes lanes_of(const glm::vec3& p) {
  return {lanes_of(p.x), lanes_of(p.y), lanes_of(p.z)};
}
inline Lanes larger(Lanes a, Lanes b) {
  return a > b ? a : b;
}
inline Lanes absolute(Lanes a) {
  return larger(a, -a);
}

/// The part of a segment inside a box around the origin, as its middle and half its extent. `slack` exceeds
/// the sum of all roundings: in floats, of the part's ends and of a box's middle and size, at most five times
/// 2^-24 of the largest lengths; in doubles, of the point at which a far end is clipped.
struct FlatSegment {
  ThreeLanes middle, way, reach;
  Lanes slack;
  bool is_empty;

  FlatSegment(glm::dvec3 from, glm::dvec3 to, const glm::dvec3& most) {
    const glm::dvec3 far = glm::max(glm::abs(from), glm::abs(to));
    const double slack_mm = 0x1p-20 * (most.x + most.y + most.z) + 0x1p-48 * std::max({far.x, far.y, far.z});
    is_empty = !cut_off(from, to, most + slack_mm);
    middle = lanes_of(glm::vec3(0.5 * (from + to)));
    way = lanes_of(glm::vec3(0.5 * (to - from)));
    for (std::size_t axis = 0; axis < 3; ++axis) reach[axis] = absolute(way[axis]);
    slack = lanes_of(static_cast<float>(2.0 * slack_mm));
  }

 private:
  /// Clips the segment to the box; returns whether a part remains.
  static bool cut_off(glm::dvec3& from, glm::dvec3& to, const glm::dvec3& most) {
    const glm::dvec3 start = from, whole = to - from;
    double first = 0.0, last = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
      if (whole[axis] == 0.0) {
        if (std::abs(start[axis]) > most[axis]) return false;
        continue;
      }
      const double a = (-most[axis] - start[axis]) / whole[axis],
                   b = (most[axis] - start[axis]) / whole[axis];
      first = std::max(first, std::min(a, b));
      last = std::min(last, std::max(a, b));
    }
    if (first > last) return false;
    if (last < 1.0) to = start + last * whole;
    if (first > 0.0) from = start + first * whole;
    return true;
  }
};

/// Child numbers from this one on denote leaves.
inline constexpr std::uint32_t first_leaf = std::uint32_t{1} << 31;

/// A node of the tree: boxes, relative to the middle of all and rounded outward, and their children.
struct FourBoxes {
  ThreeLanes low{}, high{};
  std::array<std::uint32_t, 4> child{};
  int count = 0;

  void add(const TreeBox& box, std::uint32_t number) {
    assert(count < 4);
    const glm::vec3 from = rounded_down(box.low), to = rounded_up(box.high);
    for (int axis = 0; axis < 3; ++axis) {
      low[static_cast<std::size_t>(axis)][count] = from[axis];
      high[static_cast<std::size_t>(axis)][count] = to[axis];
    }
    child[static_cast<std::size_t>(count++)] = number;
  }

  Lanes squared_distances(const ThreeLanes& p) const {
    const auto apart = [&](std::size_t axis) {
      return larger(larger(low[axis] - p[axis], p[axis] - high[axis]), Lanes{});
    };
    const Lanes x = apart(0), y = apart(1), z = apart(2);
    return x * x + y * y + z * z;
  }

  /// Not 0 if a segment may meet the box: neither an axis of the box nor a cross product of an axis and the
  /// segment separates box and segment (Akenine-Moller et al., Real-Time Rendering, 2018, 22.9). An axis
  /// separates both if their middles are farther apart along it than the sum of half their extents. For a
  /// cross product, an error of `slack` in one factor is multiplied by the size of the other.
  auto met(const FlatSegment& segment) const {
    ThreeLanes apart, size;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      apart[axis] = 0.5f * (low[axis] + high[axis]) - segment.middle[axis];
      size[axis] = 0.5f * (high[axis] - low[axis]) + segment.slack;
    }
    auto met = absolute(apart[0]) <= size[0] + segment.reach[0];
    for (std::size_t axis = 1; axis < 3; ++axis)
      met &= absolute(apart[axis]) <= size[axis] + segment.reach[axis];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
      met &= absolute(segment.way[u] * apart[v] - segment.way[v] * apart[u]) <=
             size[u] * segment.reach[v] + size[v] * segment.reach[u] +
                 segment.slack * (absolute(apart[u]) + absolute(apart[v]));
    }
    return met;
  }

  /// Not 0 if a ray towards +x may pass through the box. The ray's start lies in low_mm .. high_mm.
  auto passed(const glm::vec3& low_mm, const glm::vec3& high_mm) const {
    const ThreeLanes from = lanes_of(low_mm), to = lanes_of(high_mm);
    return (high[0] >= from[0]) & (low[1] <= to[1]) & (high[1] >= from[1]) & (low[2] <= to[2]) &
           (high[2] >= from[2]);
  }
};

}  // namespace octotomy::brep
