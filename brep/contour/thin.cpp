// SPDX-License-Identifier: AGPL-3.0-or-later
// From each kept point, the anchor, a piece grows point by point while all points that it passes lie within
// the distance. This holds if 1 its direction lies in the wedge of directions from the anchor that hit every
// point's disc (Williams, "An efficient algorithm for the piecewise linear approximation of planar curves",
// CGIP 8, 1978), and 2 every point beyond its end lies near the end, which boxes over the points decide. Both
// tests keep a margin above rounding. If neither decides, all points are tested, so the result is always the
// same as by testing all points.
#include "brep/contour/thin.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>

#include "brep/contour/run_tree.h"
#include "brep/mesh/error.h"
#include "brep/mesh/segment.h"

namespace octotomy::brep {
namespace {

double distance_to_piece(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
  return glm::distance(p, a + share_along(p, a, b) * (b - a));
}

/// Bound on the rounding error of a distance between points with coordinates up to the largest: about 80
/// roundings of 2^-53; allows 512.
double rounding_mm(const std::vector<glm::dvec2>& points) {
  double largest = 0.0;
  for (const glm::dvec2& p : points) largest = std::max({largest, std::abs(p.x), std::abs(p.y)});
  return 0x1p-44 * largest;
}

class Thinner {
 public:
  Thinner(const Contour& contour, double limit_mm)
      : points_(contour.points_mm),
        tree_(contour),
        limit_mm_(limit_mm),
        sure_mm_(limit_mm - rounding_mm(contour.points_mm)) {}

  /// The last point at which a piece from the anchor may end; `end` is one beyond the last of all points.
  std::size_t reach_from(std::size_t anchor, std::size_t end) {
    anchor_ = anchor;
    is_wedged_ = false;
    farthest_mm_ = 0.0;
    std::size_t reached = anchor + 1;
    for (; reached < end; ++reached) {
      pass(reached);
      if (!fits(reached + 1)) break;
    }
    return reached;
  }

 private:
  const glm::dvec2& point(std::size_t k) const { return points_[k % points_.size()]; }
  /// The angle of a direction, counted from `reference_`, the direction of the first point that is not near
  /// the anchor.
  double angle_of(const glm::dvec2& way) const {
    return std::atan2(reference_.x * way.y - reference_.y * way.x, glm::dot(reference_, way));
  }

  void pass(std::size_t k) {
    const glm::dvec2 way = point(k) - point(anchor_);
    const double away_mm = glm::length(way);
    farthest_mm_ = std::max(farthest_mm_, away_mm);
    if (away_mm <= sure_mm_) return;
    // The wedge reaches at most a quarter turn to either side, so that angles from the first direction do not
    // wrap around.
    const double open = sure_mm_ > 0.0 ? std::asin(sure_mm_ / away_mm) : -1.0;
    if (!is_wedged_) {
      is_wedged_ = true;
      reference_ = way;
      lowest_ = -open;
      highest_ = open;
      return;
    }
    const double angle = angle_of(way);
    lowest_ = std::max(lowest_, angle - open);
    highest_ = std::min(highest_, angle + open);
  }

  bool is_within(std::size_t k, std::size_t candidate) const {
    return !(distance_to_piece(point(k), point(anchor_), point(candidate)) > limit_mm_);
  }

  bool fits(std::size_t candidate) const {
    assert(candidate > anchor_ + 1);
    if (!is_wedged_) return true;  // all points lie near the anchor
    const glm::dvec2 end_mm = point(candidate), way = end_mm - point(anchor_);
    const double angle = angle_of(way);
    if (lowest_ <= angle && angle <= highest_) {
      const double length_mm = glm::length(way);
      if (farthest_mm_ <= length_mm) return true;
      return !tree_.first(
          anchor_ + 1, candidate,
          [&](const PlaneBox& box) {
            return box.farthest(point(anchor_)) > length_mm && box.farthest(end_mm) > sure_mm_;
          },
          [&](std::size_t k) { return !is_within(k, candidate); });
    }
    for (std::size_t k = anchor_ + 1; k < candidate; ++k)
      if (!is_within(k, candidate)) return false;
    return true;
  }

  const std::vector<glm::dvec2>& points_;
  RunTree tree_;
  double limit_mm_, sure_mm_;
  std::size_t anchor_ = 0;
  // For the points passed so far:
  double farthest_mm_ = 0.0;             ///< from the anchor
  bool is_wedged_ = false;               ///< one point is farther from the anchor than sure_mm_
  glm::dvec2 reference_{1, 0};           ///< direction of the first point farther than sure_mm_
  double lowest_ = 0.0, highest_ = 0.0;  ///< range of angles from reference_ in which a piece may run
};

}  // namespace

Contour thin(const Contour& contour, double max_distance_mm) {
  if (!(max_distance_mm >= 0.0) || !std::isfinite(max_distance_mm))
    throw InvalidInput("thin: the distance must be 0 or more");
  const auto& p = contour.points_mm;
  const std::size_t least = contour.closed ? 3 : 2;
  if (p.size() <= least) return contour;
  const std::size_t end = contour.closed ? p.size() : p.size() - 1;
  Thinner thinner(contour, max_distance_mm);
  Contour kept;
  kept.closed = contour.closed;
  for (std::size_t anchor = 0; anchor < end; anchor = thinner.reach_from(anchor, end))
    kept.points_mm.push_back(p[anchor]);
  if (!contour.closed) kept.points_mm.push_back(p.back());
  return kept.points_mm.size() < least ? contour : kept;
}

}  // namespace octotomy::brep
