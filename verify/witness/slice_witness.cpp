// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A point is `near` where its value changes sign within near_mm, in the plane or across it:
//   in the plane  A value is a distance, or a weighted mean of two, and changes by at most the distance
//                 between points.
//   across        The value is read near_mm before and behind the point as well, because it jumps halfway
//                 between slices and at both ends of the stack.
// near_mm is the width of contours, and the rounding of coordinates after several motions.
#include "verify/witness/slice_witness.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>

#include "voxel/space/error.h"

namespace octotomy::verify {
namespace {

/// Width of a contour: programs that read contours count a centre within a millionth of a millimetre as on
/// the contour.
constexpr double contour_width_mm = 2e-6;
/// Bound of the rounding of coordinates, relative to them.
constexpr double rounded_share = 1e-8;
constexpr double far_outside_mm = std::numeric_limits<double>::infinity();

/// The polygons of one slice.
class Outline {
 public:
  explicit Outline(const std::vector<std::vector<glm::dvec2>>& polygons_mm) {
    for (const auto& polygon : polygons_mm)
      for (std::size_t i = 0; i < polygon.size(); ++i)
        sides_.push_back({polygon[i], polygon[i + 1 == polygon.size() ? 0 : i + 1]});
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      if (i % run_length == 0) runs_.emplace_back();
      for (const glm::dvec2& p : {sides_[i].from, sides_[i].to}) {
        runs_.back().low = glm::min(runs_.back().low, p);
        runs_.back().high = glm::max(runs_.back().high, p);
        low_ = glm::min(low_, p);
        high_ = glm::max(high_, p);
      }
    }
  }

  bool empty() const { return sides_.empty(); }
  const glm::dvec2& low_mm() const { return low_; }
  const glm::dvec2& high_mm() const { return high_; }

  /// The distance of a point from the outline; negative inside, infinite if the slice is empty.
  double signed_distance_mm(const glm::dvec2& p) const {
    double square = far_outside_mm;
    bool is_inside = false;
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      const glm::dvec2 beside = glm::max(glm::max(runs_[run].low - p, p - runs_[run].high), glm::dvec2(0.0));
      const bool may_be_nearer = glm::dot(beside, beside) < square;
      const bool may_be_crossed = p.x <= runs_[run].high.x && beside.y <= 0.0;
      if (!may_be_nearer && !may_be_crossed) continue;
      const std::size_t end = std::min(sides_.size(), (run + 1) * run_length);
      for (std::size_t i = run * run_length; i < end; ++i) {
        const Side& side = sides_[i];
        if (may_be_nearer) square = std::min(square, square_to(side, p));
        // If an edge crosses the height of p, compares p with the position of that crossing.
        if ((side.from.y > p.y) != (side.to.y > p.y) &&
            p.x < side.from.x + (p.y - side.from.y) / (side.to.y - side.from.y) * (side.to.x - side.from.x))
          is_inside = !is_inside;
      }
    }
    const double distance_mm = std::sqrt(square);
    return is_inside ? -distance_mm : distance_mm;
  }

 private:
  struct Side {
    glm::dvec2 from, to;
  };
  /// Successive edges with their box, because most points are far from most boxes.
  struct Run {
    glm::dvec2 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
  };
  static constexpr std::size_t run_length = 16;

  static double square_to(const Side& side, const glm::dvec2& p) {
    const glm::dvec2 edge = side.to - side.from, rel = p - side.from;
    const double length2 = glm::dot(edge, edge);
    const double t = length2 > 0.0 ? std::clamp(glm::dot(rel, edge) / length2, 0.0, 1.0) : 0.0;
    const glm::dvec2 apart = rel - t * edge;
    return glm::dot(apart, apart);
  }

  std::vector<Side> sides_;
  std::vector<Run> runs_;
  glm::dvec2 low_{std::numeric_limits<double>::infinity()}, high_{-std::numeric_limits<double>::infinity()};
};

class SliceWitness {
 public:
  explicit SliceWitness(const DrawnStack& stack)
      : look_(stack.look),
        up_(stack.up),
        right_(stack.right),
        is_interpolated_(stack.is_interpolated),
        mesh_within_mm_(stack.mesh_within_mm) {
    if (stack.slices.size() < 2) throw voxel::InvalidInput("a stack of contours needs at least two slices");
    for (const DrawnStack::Slice& slice : stack.slices) {
      if (!at_mm_.empty() && !(slice.position_mm > at_mm_.back()))
        throw voxel::InvalidInput("the slices of a stack of contours must be in ascending order of position");
      at_mm_.push_back(slice.position_mm);
      outlines_.emplace_back(slice.polygons_mm);
      if (outlines_.back().empty()) continue;
      low_ = glm::min(low_, outlines_.back().low_mm());
      high_ = glm::max(high_, outlines_.back().high_mm());
    }
    const std::size_t last = at_mm_.size() - 1;
    begin_mm_ = at_mm_[0] - 0.5 * (at_mm_[1] - at_mm_[0]);
    end_mm_ = at_mm_[last] + 0.5 * (at_mm_[last] - at_mm_[last - 1]);
  }

  Reading operator()(const glm::dvec3& p_mm, double slack_mm) const {
    const double near_mm = contour_width_mm + rounded_share * glm::length(p_mm) + slack_mm;
    const glm::dvec2 p(glm::dot(p_mm, right_), glm::dot(p_mm, up_));
    const double at_mm = glm::dot(p_mm, look_);
    const double most_mm = near_mm + mesh_within_mm_;
    // Between two slices the interpolated outline lies within the box around both outlines.
    if (glm::any(glm::lessThan(p, low_ - most_mm)) || glm::any(glm::greaterThan(p, high_ + most_mm)) ||
        at_mm < begin_mm_ - most_mm || at_mm > end_mm_ + most_mm)
      return {certainly_out, certainly_out, 0};
    const AllowedSides voxel = sides(p, at_mm, near_mm);
    const AllowedSides mesh = mesh_within_mm_ > 0.0 && !voxel.near ? sides(p, at_mm, most_mm) : voxel;
    // A mesh of such a surface may have a vertex anywhere on it.
    return {voxel, mesh, mesh.near ? 2 : 0};
  }

 private:
  AllowedSides sides(const glm::dvec2& p, double at_mm, double near_mm) const {
    bool is_in = false, is_out = false;
    // Half of near_mm is also tried, because a slice may lie between the other places.
    for (const double share : {0.0, -1.0, 1.0, -0.5, 0.5}) {
      const double value_mm = value(p, at_mm + share * near_mm);
      (value_mm <= 0.0 ? is_in : is_out) = true;
      if (std::abs(value_mm) <= near_mm || (is_in && is_out)) return on_surface;
    }
    return is_in ? certainly_in : certainly_out;
  }
  double value(const glm::dvec2& p, double at_mm) const {
    if (at_mm < begin_mm_ || at_mm > end_mm_) return far_outside_mm;
    if (at_mm <= at_mm_.front()) return outlines_.front().signed_distance_mm(p);
    if (at_mm >= at_mm_.back()) return outlines_.back().signed_distance_mm(p);
    std::size_t next = 1;
    while (at_mm_[next] < at_mm) ++next;
    const Outline &a = outlines_[next - 1], &b = outlines_[next];
    const double share = (at_mm - at_mm_[next - 1]) / (at_mm_[next] - at_mm_[next - 1]);
    if (is_interpolated_ && !a.empty() && !b.empty())
      return (1.0 - share) * a.signed_distance_mm(p) + share * b.signed_distance_mm(p);
    return (share <= 0.5 ? a : b).signed_distance_mm(p);
  }

  glm::dvec3 look_, up_, right_;
  bool is_interpolated_;
  double mesh_within_mm_;
  std::vector<double> at_mm_;
  std::vector<Outline> outlines_;
  glm::dvec2 low_{std::numeric_limits<double>::infinity()}, high_{-std::numeric_limits<double>::infinity()};
  double begin_mm_ = 0.0, end_mm_ = 0.0;
};

}  // namespace

Witness witness_of_slices(const DrawnStack& stack) {
  const auto read = std::make_shared<const SliceWitness>(stack);
  return [read](const glm::dvec3& p_mm, double slack_mm) { return (*read)(p_mm, slack_mm); };
}

}  // namespace octotomy::verify
