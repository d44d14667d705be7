// SPDX-License-Identifier: AGPL-3.0-or-later
// From each point kept, the anchor, a piece grows point by point while all points that it passes lie within
// the distance. They do where 1 its direction lies in the wedge that every point's disc leaves open to lines
// from the anchor (Williams, "An efficient algorithm for the piecewise linear approximation of planar
// curves", CGIP 8, 1978), and 2 no point lies beyond its end, or each that does lies near the end, which
// boxes over the points decide. Both keep clear of the limit by more than rounding; where that decides
// nothing all points are asked, so the answer is always that of asking all.
#include "brep/contour/thin.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>

#include "brep/contour/run_tree.h"

namespace octotomy::brep {
namespace {

double distance_to_piece(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 along = b - a;
  const double length2 = glm::dot(along, along);
  const double t = length2 > 0.0 ? std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0.0;
  return glm::distance(p, a + t * along);
}

/// Bounds what rounding adds to a distance of points with coordinates up to the largest: some 80 roundings of
/// 2^-53, of which 512 are allowed for.
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

  /// The last point that a piece from the anchor may end at; `end` is one beyond the last of all.
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
  /// From the direction of the first point that is not near the anchor.
  double angle_of(const glm::dvec2& way) const {
    return std::atan2(reference_.x * way.y - reference_.y * way.x, glm::dot(reference_, way));
  }

  void pass(std::size_t k) {
    const glm::dvec2 way = point(k) - point(anchor_);
    const double away_mm = glm::length(way);
    farthest_mm_ = std::max(farthest_mm_, away_mm);
    if (away_mm <= sure_mm_) return;
    // Within a quarter turn, so that angles from the first one's direction need no turns.
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
    if (!is_wedged_) return true;  // all lie near the anchor
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
  // Of the points passed:
  double farthest_mm_ = 0.0;             ///< from the anchor
  bool is_wedged_ = false;               ///< one lies farther from the anchor than is sure
  glm::dvec2 reference_{1, 0};           ///< the first such
  double lowest_ = 0.0, highest_ = 0.0;  ///< angles from it that are open to pieces
};

}  // namespace

Contour thin(const Contour& contour, double max_distance_mm) {
  if (!(max_distance_mm >= 0.0) || !std::isfinite(max_distance_mm))
    throw std::invalid_argument("thin: the distance must be 0 or more");
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
