// SPDX-License-Identifier: AGPL-3.0-or-later
// Follows contours in passes: 1 join the crossed edges of each cell of four samples by directed segments,
// with the object on the left; 2 walk open chains from edges to which no segment leads; 3 walk the remaining
// segments, which are loops. An edge is crossed at most once and has at most one segment on either side, so
// chains cannot fork.
#include "brep/contour/contour.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "brep/contour/run_tree.h"
#include "brep/mesh/error.h"
#include "brep/mesh/morton_tree.h"

namespace octotomy::brep {
namespace {

constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

/// The least distance of a crossing from a sample, as a share of the edge. Without it, a sample exactly at
/// the threshold would move the crossings of all its edges to one point, at which contours would touch. A
/// thousandth of a sample is far below what a scan resolves, and far above the rounding of coordinates (2^-52
/// times the number of samples along a side).
constexpr double least_fraction() {
  return 1.0 / 1024.0;
}

double cross(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

void check(const Slice& slice, const FollowOptions& options) {
  const auto refuse = [](const std::string& why) { throw InvalidInput("follow: " + why); };
  if (slice.samples.size() != std::size_t{slice.width} * slice.height)
    refuse(std::to_string(slice.width) + " x " + std::to_string(slice.height) + " samples were promised, " +
           std::to_string(slice.samples.size()) + " are there");
  for (const double step : {slice.spacing_mm.x, slice.spacing_mm.y})
    if (!(step > 0.0) || !std::isfinite(step)) refuse("the spacing must be positive");
  if (!std::isfinite(options.threshold)) refuse("the threshold is not finite");
  for (std::size_t s = 0; s < slice.samples.size(); ++s)
    if (!std::isfinite(slice.samples[s]))
      refuse("sample (" + std::to_string(s % slice.width) + ", " + std::to_string(s / slice.width) +
             ") is not finite: fill such samples first");
}

/// The lattice's edges, with one more ring of nodes around it. Node (i, j) is sample (i - 1, j - 1). Edge 2 *
/// node begins at that node and runs along x; edge 2 * node + 1 runs along y.
class Follower {
 public:
  Follower(const Slice& slice, const FollowOptions& options)
      : slice_(slice),
        options_(options),
        columns_(std::size_t{slice.width} + 2),
        next_(2 * columns_ * (std::size_t{slice.height} + 2), none),
        led_to_(next_.size(), 0) {}

  std::vector<Contour> run() {
    const std::size_t first = options_.border == Border::close ? 0 : 1;
    for (std::size_t j = first; j + first <= slice_.height; ++j)
      for (std::size_t i = first; i + first <= slice_.width; ++i) join_cell(i, j);
    std::vector<Contour> contours;
    for (std::size_t e = 0; e < next_.size(); ++e)
      if (next_[e] != none && !led_to_[e]) contours.push_back(walk(e));
    for (std::size_t e = 0; e < next_.size(); ++e)
      if (next_[e] != none) contours.push_back(walk(e));
    return contours;
  }

 private:
  bool sampled(std::size_t i, std::size_t j) const {
    return i >= 1 && j >= 1 && i <= slice_.width && j <= slice_.height;
  }

  /// The sample minus the threshold; negative outside the samples.
  double above(std::size_t i, std::size_t j) const {
    if (!sampled(i, j)) return -1.0;
    return slice_.samples[(j - 1) * slice_.width + (i - 1)] - options_.threshold;
  }

  void link(std::size_t from, std::size_t to) {
    assert(from < next_.size() && to < next_.size() && next_[from] == none);
    next_[from] = to;
    led_to_[to] = 1;
  }

  void join_cell(std::size_t i, std::size_t j) {
    const std::array<double, 4> d = {above(i, j), above(i + 1, j), above(i + 1, j + 1), above(i, j + 1)};
    const std::size_t node = j * columns_ + i;
    const std::array<std::size_t, 4> edge = {2 * node, 2 * (node + 1) + 1, 2 * (node + columns_),
                                             2 * node + 1};
    std::array<std::size_t, 2> leaving{};
    std::size_t crossings = 0, entering = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const bool inside = d[k] >= 0.0, beyond = d[(k + 1) % 4] >= 0.0;
      if (inside && !beyond) leaving[crossings++] = k;
      if (!inside && beyond) entering = k;
    }
    assert(crossings <= 2);
    if (crossings == 1) link(edge[leaving[0]], edge[entering]);
    if (crossings != 2) return;
    // The saddle point of the bilinear interpolant is inside if the inner corners outweigh the outer ones. No
    // cell at the border is a saddle, because its corners without samples are adjacent.
    const double even = d[0] * d[2], odd = d[1] * d[3];
    const bool joined = d[0] >= 0.0 ? even >= odd : odd >= even;
    for (const std::size_t k : leaving) link(edge[k], edge[(k + (joined ? 1 : 3)) % 4]);
  }

  glm::dvec2 crossing_mm(std::size_t e) const {
    const std::size_t node = e / 2, i = node % columns_, j = node / columns_;
    const std::size_t i2 = i + (e % 2 == 0 ? 1 : 0), j2 = j + (e % 2);
    double fraction = 0.5;
    if (sampled(i, j) && sampled(i2, j2)) {
      const double a = above(i, j), b = above(i2, j2);
      assert((a >= 0.0) != (b >= 0.0));
      fraction = std::clamp(a / (a - b), least_fraction(), 1.0 - least_fraction());
    }
    glm::dvec2 p(static_cast<double>(i) - 1.0, static_cast<double>(j) - 1.0);
    (e % 2 == 0 ? p.x : p.y) += fraction;
    return p * slice_.spacing_mm;
  }

  Contour walk(std::size_t start) {
    Contour contour;
    std::size_t e = start;
    assert(next_[start] != none);
    do {
      contour.points_mm.push_back(crossing_mm(e));
      e = std::exchange(next_[e], none);
    } while (e != start && next_[e] != none);
    contour.closed = e == start;
    if (!contour.closed) contour.points_mm.push_back(crossing_mm(e));
    return contour;
  }

  const Slice& slice_;
  const FollowOptions& options_;
  std::size_t columns_;
  std::vector<std::size_t> next_;
  std::vector<std::uint8_t> led_to_;
};

/// Computes whether a contour encloses points, by the parity of crossings of a ray towards +x; a vertex at
/// the ray's height counts as above it. A run of pieces beyond the point is crossed an odd number of times if
/// its ends are on different sides of the ray.
class Enclosure {
 public:
  explicit Enclosure(const Contour& contour) : points_(contour.points_mm), pieces_(contour) {}

  bool holds(const glm::dvec2& p) const {
    const std::size_t count = points_.size();
    const auto is_above = [&](std::size_t k) { return points_[k % count].y > p.y; };
    bool inside = false;
    pieces_.walk([&](const PlaneBox& box, std::size_t begin, std::size_t end) {
      if (!(box.low.y <= p.y && p.y < box.high.y)) return false;
      const double clear = rounding_of_sides(box, p);
      if (p.x > box.high.x + clear) return false;
      if (p.x < box.low.x - clear) {
        inside ^= is_above(begin) != is_above(end);
        return false;
      }
      if (end - begin == 1 && is_above(begin) != is_above(end)) {
        const glm::dvec2 &a = points_[begin], &b = points_[end % count];
        inside ^= (cross(b - a, p - a) > 0.0) == (b.y > a.y);
      }
      return true;
    });
    return inside;
  }

 private:
  /// Within this distance of a piece's box, rounding may decide on which side of the piece the point lies.
  /// cross() rounds a few products of the box's sides and the distances to the point; 2^-40 of their size is
  /// far above that rounding.
  static double rounding_of_sides(const PlaneBox& box, const glm::dvec2& p) {
    return 0x1p-40 * (std::abs(p.x) + std::abs(box.low.x) + std::abs(box.high.x));
  }

  const std::vector<glm::dvec2>& points_;
  RunTree pieces_;
};

/// A point that a closed contour encloses, even if other contours touch it. It lies half way between the two
/// lowest different heights of the contour's points, in the middle of a horizontal line inside the contour.
/// If rounding leaves no such line, returns the contour's first point.
glm::dvec2 point_within(const Contour& contour) {
  const auto& points = contour.points_mm;
  double lowest = std::numeric_limits<double>::infinity(), next = lowest;
  for (const glm::dvec2& p : points) lowest = std::min(lowest, p.y);
  for (const glm::dvec2& p : points)
    if (p.y > lowest) next = std::min(next, p.y);
  const double y = 0.5 * lowest + 0.5 * next;
  std::vector<double> crossings;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::dvec2 &a = points[i], &b = points[(i + 1) % points.size()];
    if ((a.y <= y) != (b.y <= y)) crossings.push_back(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
  }
  std::sort(crossings.begin(), crossings.end());
  return crossings.size() < 2 ? points.front() : glm::dvec2(0.5 * crossings[0] + 0.5 * crossings[1], y);
}

}  // namespace

std::vector<Contour> follow(const Slice& slice, const FollowOptions& options) {
  check(slice, options);
  return Follower(slice, options).run();
}

void need_closed(const Contour& contour, const char* asking) {
  if (!contour.closed) throw InvalidInput(std::string(asking) + ": the contour is open: close it first");
}

double signed_area_mm2(const Contour& contour) {
  need_closed(contour, "area");
  double twice = 0.0;
  const auto& p = contour.points_mm;
  for (std::size_t k = 2; k < p.size(); ++k) twice += cross(p[k - 1] - p[0], p[k] - p[0]);
  return 0.5 * twice;
}

double perimeter_mm(const Contour& contour) {
  const auto& p = contour.points_mm;
  double length = 0.0;
  for (std::size_t k = 1; k < p.size(); ++k) length += glm::distance(p[k - 1], p[k]);
  if (contour.closed && !p.empty()) length += glm::distance(p.back(), p.front());
  return length;
}

std::vector<std::optional<std::size_t>> nest(const std::vector<Contour>& contours) {
  std::vector<double> areas;
  std::vector<PlaneBox> boxes;
  std::vector<Enclosure> enclosures;
  std::vector<glm::dvec3> middles;
  for (const Contour& contour : contours) {
    areas.push_back(std::abs(signed_area_mm2(contour)));
    PlaneBox box;
    for (const glm::dvec2& p : contour.points_mm) box.add(p);
    boxes.push_back(box);
    enclosures.emplace_back(contour);
    middles.emplace_back(contour.points_mm.empty() ? glm::dvec2(0.0) : 0.5 * box.low + 0.5 * box.high, 0.0);
  }
  // Sorts along a space-filling curve, so that neighbours in the sequence are near each other.
  const std::vector<std::uint32_t> order = morton_order(middles).numbers;
  std::vector<PlaneBox> ordered;
  ordered.reserve(order.size());
  for (const std::uint32_t c : order) ordered.push_back(boxes[c]);
  const RunTree tree(ordered);

  std::vector<std::optional<std::size_t>> around(contours.size());
  for (std::size_t c = 0; c < contours.size(); ++c) {
    if (contours[c].points_mm.empty()) continue;
    const glm::dvec2 p = point_within(contours[c]);
    std::optional<std::size_t>& least = around[c];
    tree.walk([&](const PlaneBox& box, std::size_t begin, std::size_t end) {
      if (!box.holds(p)) return false;
      const std::size_t o = order[begin];
      if (end - begin > 1 || o == c || !(areas[o] > areas[c])) return true;
      // Among contours of equal area, the first is chosen.
      if (least && (areas[o] > areas[*least] || (areas[o] == areas[*least] && o > *least))) return true;
      if (enclosures[o].holds(p)) least = o;
      return true;
    });
  }
  return around;
}

std::vector<std::size_t> depths(const std::vector<std::optional<std::size_t>>& around) {
  constexpr std::size_t unknown = none;
  std::vector<std::size_t> depths(around.size(), unknown), way;
  for (std::size_t c = 0; c < around.size(); ++c) {
    std::optional<std::size_t> at = c;
    for (; at && depths[*at] == unknown; at = around[*at]) {
      assert(way.size() < around.size());
      way.push_back(*at);
    }
    std::size_t depth = at ? depths[*at] + 1 : 0;
    for (; !way.empty(); way.pop_back()) depths[way.back()] = depth++;
  }
  return depths;
}

}  // namespace octotomy::brep
