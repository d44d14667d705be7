// SPDX-License-Identifier: AGPL-3.0-or-later
// Witnesses of shapes from a plan: regions, boxes, blades, and surfaces of imported solids.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "brep/mesh/distance.h"
#include "verify/witness/joined_reading.h"
#include "verify/witness/witness.h"
#include "voxel/space/error.h"

namespace octotomy::verify {
namespace {

/// Largest distance of a vertex from its plane in the plan, after several Booleans and motions, relative to
/// its coordinates.
constexpr double on_plane = 1e-8;

/// Returns the directions right and up in the picture of a view. The view is a name or two angles.
std::array<glm::dvec3, 2> picture_axes(const std::string& view) {
  const glm::dvec3 left(1, 0, 0), back(0, 1, 0), head(0, 0, 1);
  if (view == "anterior") return {left, head};
  if (view == "posterior") return {-left, head};
  if (view == "left") return {back, head};
  if (view == "right") return {-back, head};
  if (view == "superior") return {-left, -back};
  if (view == "inferior") return {left, -back};
  double azimuth = 0.0, elevation = 0.0;
  char comma = 0, rest = 0;
  if (std::sscanf(view.c_str(), "%lf%c%lf%c", &azimuth, &comma, &elevation, &rest) != 3 || comma != ',')
    throw std::invalid_argument("no view '" + view + "'");
  azimuth *= std::numbers::pi / 180.0;
  elevation *= std::numbers::pi / 180.0;
  // Right and up for an observer on the unit sphere who looks towards the centre.
  const glm::dvec3 level = std::sin(azimuth) * left - std::cos(azimuth) * back;
  const glm::dvec3 right = std::cos(azimuth) * left + std::sin(azimuth) * back;
  return {right, std::cos(elevation) * head - std::sin(elevation) * level};
}

/// One region: its polygons, with their edges sorted into rows of the picture.
class RegionWitness {
 public:
  explicit RegionWitness(const DrawnRegion& region) : axes_(picture_axes(region.view)) {
    for (const auto& polygon : region.polygons_mm)
      for (std::size_t i = 0; i < polygon.size(); ++i)
        edges_.push_back({polygon[i], polygon[(i + 1) % polygon.size()]});
    for (const auto& [a, b] : edges_) {
      low_ = std::min({low_, a.y, b.y});
      high_ = std::max({high_, a.y, b.y});
      reach_mm_ = std::max({reach_mm_, glm::length(a), glm::length(b)});
    }
    // Rows much lower than most_slack_mm would all hold the same edges.
    const double most_rows = high_ > low_ ? 4.0 * (high_ - low_) / most_slack_mm : 0.0;
    rows_.resize(std::max<std::size_t>(
        1, static_cast<std::size_t>(std::min(static_cast<double>(edges_.size()), most_rows))));
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      const auto [from, to] = std::minmax(edges_[i][0].y, edges_[i][1].y);
      for (std::size_t row = row_of(from - most_slack_mm); row <= row_of(to + most_slack_mm); ++row)
        rows_[row].push_back(i);
    }
  }

  Reading operator()(const glm::dvec3& p_mm, double slack_mm) const {
    const glm::dvec2 p(glm::dot(p_mm, axes_[0]), glm::dot(p_mm, axes_[1]));
    const double near = near_mm(glm::length(p_mm)) + slack_mm;
    if (p.y < low_ - near || p.y > high_ + near) return {certainly_out, certainly_out};
    bool inside = false;
    int sides = 0;
    for (const std::size_t i : rows_[row_of(p.y)]) {
      const auto& [a, b] = edges_[i];
      const glm::dvec2 along = b - a, to = p - a;
      const double squared = glm::dot(along, along);
      const double part = squared > 0.0 ? std::clamp(glm::dot(to, along) / squared, 0.0, 1.0) : 0.0;
      if (glm::distance(to, part * along) <= near) ++sides;
      // Tests whether the edge crosses the ray towards growing x. A vertex on the ray belongs to one of its
      // two edges.
      if ((a.y <= p.y) == (b.y <= p.y)) continue;
      const double side = along.x * to.y - along.y * to.x;
      if ((side > 0.0) == (b.y > a.y)) inside = !inside;
    }
    const AllowedSides allowed = sides > 0 ? on_surface : inside ? certainly_in : certainly_out;
    return {allowed, allowed, sides};
  }

 private:
  /// An edge is stored in all rows within this distance of it. No slack may be larger.
  static constexpr double most_slack_mm = 0.25;

  double near_mm(double p_mm) const { return on_plane * (reach_mm_ + p_mm); }
  std::size_t row_of(double y) const {
    const double share = high_ > low_ ? (y - low_) / (high_ - low_) : 0.0;
    return static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * static_cast<double>(rows_.size() - 1));
  }

  std::array<glm::dvec3, 2> axes_;
  std::vector<std::array<glm::dvec2, 2>> edges_;
  std::vector<std::vector<std::size_t>> rows_;
  double low_ = std::numeric_limits<double>::infinity(), high_ = -low_, reach_mm_ = 0.0;
};

/// A straight piece of a blade. At the planes in `ends` the blade ends; at those in `joints` the next piece
/// begins.
struct BladePiece {
  std::vector<HalfSpace> ends, joints;

  /// The largest distance, in millimetres, of a point beyond one of the planes; negative inside all of them.
  static double beyond_mm(const std::vector<HalfSpace>& planes, const glm::dvec3& p_mm) {
    double most = -std::numeric_limits<double>::infinity();
    for (const HalfSpace& plane : planes)
      most = std::max(most, glm::dot(plane.normal, p_mm) - plane.offset_mm);
    return most;
  }
};

std::vector<BladePiece> pieces_of(const DrawnBlade& blade) {
  const glm::dvec3 look = glm::normalize(blade.direction);
  std::vector<glm::dvec3> line;
  double first_mm = std::numeric_limits<double>::infinity();
  for (const glm::dvec3& p : blade.line_mm) {
    first_mm = std::min(first_mm, glm::dot(p, look));
    const glm::dvec3 flat = p - glm::dot(p, look) * look;
    if (line.empty() || glm::distance(flat, line.back()) > 0.0) line.push_back(flat);
  }
  if (line.size() < 2)
    throw voxel::InvalidInput(
        "a blade's line needs two points that are apart when seen along the blade's direction");
  std::vector<glm::dvec3> along;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) along.push_back(glm::normalize(line[i + 1] - line[i]));
  std::vector<BladePiece> pieces(along.size());
  for (std::size_t i = 0; i < along.size(); ++i) {
    const glm::dvec3 aside = glm::cross(look, along[i]);
    const double middle_mm = glm::dot(aside, line[i]), half_mm = 0.5 * blade.kerf_mm;
    pieces[i].ends = {{aside, middle_mm + half_mm},
                      {-aside, half_mm - middle_mm},
                      {look, first_mm + blade.depth_mm},
                      {-look, -first_mm}};
    const glm::dvec3 back = i == 0 ? along[i] : glm::normalize(along[i - 1] + along[i]);
    const glm::dvec3 on = i + 1 == along.size() ? along[i] : glm::normalize(along[i] + along[i + 1]);
    (i == 0 ? pieces[i].ends : pieces[i].joints).push_back({-back, -glm::dot(back, line[i])});
    (i + 1 == along.size() ? pieces[i].ends : pieces[i].joints).push_back({on, glm::dot(on, line[i + 1])});
  }
  return pieces;
}

}  // namespace

Witness witness_of_regions(const std::vector<DrawnRegion>& regions) {
  const auto readers = std::make_shared<const std::vector<RegionWitness>>(regions.begin(), regions.end());
  LineReading lines;
  for (const DrawnRegion& region : regions) {
    const auto [right, up] = picture_axes(region.view);
    LineReading one = lines_in_region(right, up, region.polygons_mm);
    lines = lines ? lines_in_both(std::move(lines), std::move(one)) : std::move(one);
  }
  return Witness([readers](const glm::dvec3& p_mm, double slack_mm) {
           Reading all{certainly_in, certainly_in, 0};
           for (const RegionWitness& reader : *readers) {
             const Reading one = reader(p_mm, slack_mm);
             all = conjunction(all, one);
           }
           return all;
         })
      .with_lines(std::move(lines));
}

Witness witness_of_box(const voxel::Box& box) {
  const auto read = [box](const glm::dvec3& p_mm, double slack_mm) {
    int sides = 0;
    bool inside = true;
    for (int axis = 0; axis < 3; ++axis)
      for (const double inner_mm : {p_mm[axis] - box.low_mm[axis], box.high_mm[axis] - p_mm[axis]}) {
        const double near_mm = on_plane * (std::abs(p_mm[axis]) + std::abs(box.low_mm[axis])) + slack_mm;
        sides += std::abs(inner_mm) <= near_mm ? 1 : 0;
        inside = inside && inner_mm >= -near_mm;
      }
    const AllowedSides allowed = !inside ? certainly_out : sides > 0 ? on_surface : certainly_in;
    return Reading{allowed, allowed, inside ? sides : 0};
  };
  return Witness(read).with_lines(lines_in_box(box));
}

Witness witness_of_blade(const DrawnBlade& blade) {
  const std::vector<BladePiece> pieces = pieces_of(blade);
  LineReading lines;
  for (const BladePiece& piece : pieces) {
    std::vector<HalfSpace> sides = piece.ends;
    sides.insert(sides.end(), piece.joints.begin(), piece.joints.end());
    LineReading one = lines_in_half_spaces(std::move(sides));
    lines = lines ? lines_in_either(std::move(lines), std::move(one)) : std::move(one);
  }
  const auto read = [pieces](const glm::dvec3& p_mm, double slack_mm) {
    const double near_mm = on_plane * (1.0 + glm::length(p_mm)) + slack_mm;
    int sides = 0;
    for (const BladePiece& piece : pieces) {
      if (BladePiece::beyond_mm(piece.joints, p_mm) > near_mm) continue;
      const double beyond_mm = BladePiece::beyond_mm(piece.ends, p_mm);
      if (beyond_mm < -near_mm) return Reading{certainly_in, certainly_in, 0};
      if (beyond_mm > near_mm) continue;
      for (const HalfSpace& plane : piece.ends)
        sides += std::abs(glm::dot(plane.normal, p_mm) - plane.offset_mm) <= near_mm ? 1 : 0;
    }
    return sides > 0 ? Reading{on_surface, on_surface, sides} : Reading{certainly_out, certainly_out, 0};
  };
  return Witness(read).with_lines(std::move(lines));
}

Witness witness_of_surface(brep::Solid solid) {
  return [solid = std::move(solid)](const glm::dvec3& p_mm, double slack_mm) {
    const double near_mm = on_plane * (1.0 + glm::length(p_mm)) + slack_mm;
    const bool near = !solid.empty() && solid.tree().distances_mm({p_mm}).front() <= near_mm;
    return Reading{near ? on_surface : either_side, near ? on_surface : either_side, near ? 2 : 0};
  };
}

}  // namespace octotomy::verify
