// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/witness/triangle_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace octotomy::verify {
namespace {

struct Corners {
  glm::dvec3 a, b, c;
};
Corners corners_of(const brep::Triangles& triangles, std::size_t face) {
  const auto& [a, b, c] = triangles.faces[face];
  return {triangles.points_mm[a], triangles.points_mm[b], triangles.points_mm[c]};
}

/// Weights of a segment's ends at the point of the segment that is nearest to p.
glm::dvec2 on_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 along = b - a;
  const double square = glm::dot(along, along);
  const double share = square > 0.0 ? std::clamp(glm::dot(p - a, along) / square, 0.0, 1.0) : 0.0;
  return {1.0 - share, share};
}

/// Weights of a triangle's corners at the point of the triangle that is nearest to p: the foot of the
/// perpendicular if it lies inside, otherwise the nearest point of the three sides.
glm::dvec3 weights_at(const glm::dvec3& p, const Corners& t) {
  const glm::dvec3 normal = glm::cross(t.b - t.a, t.c - t.a);
  const double square = glm::dot(normal, normal);
  if (square > 0.0) {
    const glm::dvec3 weights{glm::dot(glm::cross(t.b - p, t.c - p), normal) / square,
                             glm::dot(glm::cross(t.c - p, t.a - p), normal) / square,
                             glm::dot(glm::cross(t.a - p, t.b - p), normal) / square};
    if (weights.x >= 0.0 && weights.y >= 0.0 && weights.z >= 0.0) return weights;
  }
  const glm::dvec2 ab = on_segment(p, t.a, t.b), bc = on_segment(p, t.b, t.c), ca = on_segment(p, t.c, t.a);
  const std::array<glm::dvec3, 3> sides{glm::dvec3(ab.x, ab.y, 0.0), glm::dvec3(0.0, bc.x, bc.y),
                                        glm::dvec3(ca.y, 0.0, ca.x)};
  const auto square_mm2 = [&](const glm::dvec3& weights) {
    const glm::dvec3 apart = weights.x * t.a + weights.y * t.b + weights.z * t.c - p;
    return glm::dot(apart, apart);
  };
  return *std::min_element(sides.begin(), sides.end(), [&](const glm::dvec3& u, const glm::dvec3& v) {
    return square_mm2(u) < square_mm2(v);
  });
}

double distance_at(const glm::dvec3& weights, const glm::dvec3& p, const Corners& t) {
  return glm::distance(weights.x * t.a + weights.y * t.b + weights.z * t.c, p);
}

/// Whether a ray from p along z crosses a side, in the plane of y and z. The ends of the side are put in one
/// order first, so that both triangles at the side get the same answer.
bool crosses(const glm::dvec3& p, glm::dvec3 a, glm::dvec3 b) {
  if ((a.y > p.y) == (b.y > p.y)) return false;
  if (a.y > b.y) std::swap(a, b);
  return p.z < a.z + (p.y - a.y) / (b.y - a.y) * (b.z - a.z);
}

/// Returns a distance. If a box of triangles is at this distance or farther, none of its triangles has a
/// computed distance within `mm`. Coordinates, and numbers computed from them, are accurate to about 2^-50 of
/// the largest; boxes lie within a cell's length of the point's distance to them.
double surely_beyond_mm(double mm, const glm::dvec3& p_mm) {
  return mm + 0x1p-40 * (mm + 1.0 + std::abs(p_mm.x) + std::abs(p_mm.y) + std::abs(p_mm.z));
}

double distance_to_box_mm(const glm::dvec3& p, const Corners& t) {
  const glm::dvec3 low = glm::min(glm::min(t.a, t.b), t.c), high = glm::max(glm::max(t.a, t.b), t.c);
  return glm::length(glm::max(glm::max(low - p, p - high), glm::dvec3(0.0)));
}

std::vector<BoxGrid::Box> boxes_of(const brep::Triangles& triangles) {
  std::vector<BoxGrid::Box> boxes(triangles.faces.size());
  for (std::size_t face = 0; face < boxes.size(); ++face) {
    const Corners t = corners_of(triangles, face);
    boxes[face] = {glm::min(glm::min(t.a, t.b), t.c), glm::max(glm::max(t.a, t.b), t.c)};
  }
  return boxes;
}

/// Projects boxes along x: the results have no extent along x.
std::vector<BoxGrid::Box> projected(std::vector<BoxGrid::Box> boxes) {
  for (BoxGrid::Box& box : boxes) box.low_mm.x = box.high_mm.x = 0.0;
  return boxes;
}

double mean_extent_mm(const std::vector<BoxGrid::Box>& boxes) {
  double sum_mm = 0.0;
  for (const BoxGrid::Box& box : boxes) sum_mm += glm::length(box.high_mm - box.low_mm);
  return boxes.empty() ? 1.0 : sum_mm / static_cast<double>(boxes.size());
}

}  // namespace

// BoxGrid ------------------------------------------------------------------------------------------------

BoxGrid::BoxGrid(const std::vector<Box>& boxes, double cell_mm) {
  if (boxes.empty()) return;
  glm::dvec3 high_mm = boxes.front().high_mm;
  low_mm_ = boxes.front().low_mm;
  for (const Box& box : boxes) {
    low_mm_ = glm::min(low_mm_, box.low_mm);
    high_mm = glm::max(high_mm, box.high_mm);
  }
  const double longest_mm = std::max({high_mm.x - low_mm_.x, high_mm.y - low_mm_.y, high_mm.z - low_mm_.z});
  constexpr double most_a_side = 1024.0;
  cell_mm_ = std::max(cell_mm, longest_mm / most_a_side);
  if (!(cell_mm_ > 0.0)) cell_mm_ = 1.0;
  // Doubles the cells' edge until there are few cells for each box, and each box lies in few cells.
  const double most_cells = 16.0 * static_cast<double>(boxes.size()) + 4096.0;
  for (;; cell_mm_ *= 2.0) {
    const glm::dvec3 all = glm::floor((high_mm - low_mm_) / cell_mm_) + 1.0;
    double filled = 0.0;
    for (const Box& box : boxes) {
      const glm::dvec3 own = glm::floor((box.high_mm - low_mm_) / cell_mm_) -
                             glm::floor((box.low_mm - low_mm_) / cell_mm_) + 1.0;
      filled += own.x * own.y * own.z;
    }
    dims_ = glm::ivec3(all);
    if (all.x * all.y * all.z <= most_cells && filled <= most_cells) break;
  }
  const auto for_cells = [&](const Box& box, const auto& visit) {
    const glm::ivec3 from = cell_of(box.low_mm), to = cell_of(box.high_mm);
    for (int z = from.z; z <= to.z; ++z)
      for (int y = from.y; y <= to.y; ++y)
        for (int x = from.x; x <= to.x; ++x) visit(index({x, y, z}));
  };
  first_.assign(index({0, 0, dims_.z}) + 1, 0);
  for (const Box& box : boxes) for_cells(box, [&](std::size_t cell) { ++first_[cell + 1]; });
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  items_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t i = 0; i < boxes.size(); ++i)
    for_cells(boxes[i], [&](std::size_t cell) { items_[next[cell]++] = i; });
}

glm::ivec3 BoxGrid::cell_of(const glm::dvec3& p_mm) const {
  constexpr double far = 1e6;  // in cells; points may lie anywhere
  return glm::ivec3(glm::clamp(glm::floor((p_mm - low_mm_) / cell_mm_), glm::dvec3(-far), glm::dvec3(far)));
}

bool BoxGrid::has(const glm::ivec3& cell) const {
  return glm::all(glm::greaterThanEqual(cell, glm::ivec3(0))) && glm::all(glm::lessThan(cell, dims_));
}

double BoxGrid::distance_mm(const glm::ivec3& cell, const glm::dvec3& p_mm) const {
  const glm::dvec3 from_mm = low_mm_ + glm::dvec3(cell) * cell_mm_;
  return glm::length(glm::max(glm::max(from_mm - p_mm, p_mm - (from_mm + cell_mm_)), glm::dvec3(0.0)));
}

std::size_t BoxGrid::index(const glm::ivec3& cell) const {
  return static_cast<std::size_t>(cell.x) +
         static_cast<std::size_t>(dims_.x) *
             (static_cast<std::size_t>(cell.y) +
              static_cast<std::size_t>(dims_.y) * static_cast<std::size_t>(cell.z));
}

// TriangleGrid -------------------------------------------------------------------------------------------

TriangleGrid::TriangleGrid(brep::Triangles triangles) : triangles_(std::move(triangles)) {
  const std::vector<BoxGrid::Box> boxes = boxes_of(triangles_);
  cells_ = BoxGrid(boxes, mean_extent_mm(boxes));
  rows_ = BoxGrid(projected(boxes), mean_extent_mm(boxes));
}

// Reads cells in shells around the point's cell. A triangle outside the first n shells is at least n cells
// away. Cells and boxes of triangles farther than the least distance so far are skipped.
std::optional<TriangleGrid::Foot> TriangleGrid::nearest(const glm::dvec3& p_mm, double most_mm,
                                                        double enough_mm) const {
  if (cells_.empty() || !(most_mm >= 0.0)) return std::nullopt;
  const glm::ivec3 at = cells_.cell_of(p_mm), dims = cells_.dims();
  // The numbers of the first and the last shell that meet the grid.
  const glm::ivec3 before = glm::max(-at, at - (dims - 1)), beyond = glm::max(at, dims - 1 - at);
  const int first = std::max({before.x, before.y, before.z, 0});
  const int last = std::max({beyond.x, beyond.y, beyond.z});
  Foot best{std::numeric_limits<double>::infinity()};
  double beyond_mm = surely_beyond_mm(most_mm, p_mm);
  const auto reads_enough = [&](const glm::ivec3& cell) {
    if (cells_.distance_mm(cell, p_mm) > beyond_mm) return false;
    return cells_.any_in(cell, [&](std::uint32_t face) {
      const Corners t = corners_of(triangles_, face);
      if (distance_to_box_mm(p_mm, t) > beyond_mm) return false;
      const glm::dvec3 weights = weights_at(p_mm, t);
      const double distance_mm = distance_at(weights, p_mm, t);
      if (distance_mm < best.distance_mm || (distance_mm == best.distance_mm && face < best.face)) {
        best = {distance_mm, face, weights};
        beyond_mm = surely_beyond_mm(std::min(most_mm, distance_mm), p_mm);
      }
      return distance_mm < enough_mm;
    });
  };
  const auto reads_enough_of = [&](int shell) {
    const glm::ivec3 from = glm::max(at - shell, glm::ivec3(0)), to = glm::min(at + shell, dims - 1);
    for (int z = from.z; z <= to.z; ++z)
      for (int y = from.y; y <= to.y; ++y) {
        const bool is_whole_row = std::abs(z - at.z) == shell || std::abs(y - at.y) == shell;
        const int step = is_whole_row || shell == 0 ? 1 : 2 * shell;
        for (int x = is_whole_row ? from.x : at.x - shell; x <= (is_whole_row ? to.x : at.x + shell);
             x += step)
          if (cells_.has({x, y, z}) && reads_enough({x, y, z})) return true;
      }
    return false;
  };
  for (int shell = first; shell <= last; ++shell) {
    const double passed_mm = (shell - 1) * cells_.cell_mm();
    if (passed_mm > most_mm || passed_mm > best.distance_mm || reads_enough_of(shell)) break;
  }
  if (!(best.distance_mm <= most_mm)) return std::nullopt;
  return best;
}

bool TriangleGrid::has_within(const glm::dvec3& p_mm, double reach_mm) const {
  if (cells_.empty() || !(reach_mm >= 0.0)) return false;
  const glm::ivec3 from = glm::max(cells_.cell_of(p_mm - reach_mm), glm::ivec3(0)),
                   to = glm::min(cells_.cell_of(p_mm + reach_mm), cells_.dims() - 1);
  const double beyond_mm = surely_beyond_mm(reach_mm, p_mm);
  for (int z = from.z; z <= to.z; ++z)
    for (int y = from.y; y <= to.y; ++y)
      for (int x = from.x; x <= to.x; ++x)
        if (cells_.any_in({x, y, z}, [&](std::uint32_t face) {
              const Corners t = corners_of(triangles_, face);
              return distance_to_box_mm(p_mm, t) <= beyond_mm &&
                     distance_at(weights_at(p_mm, t), p_mm, t) <= reach_mm;
            }))
          return true;
  return false;
}

bool TriangleGrid::has_inside(const glm::dvec3& p_mm) const {
  if (rows_.empty()) return false;
  const glm::ivec3 row = rows_.cell_of({0.0, p_mm.y, p_mm.z});
  if (!rows_.has(row)) return false;
  bool is_inside = false;
  rows_.any_in(row, [&](std::uint32_t face) {
    const Corners t = corners_of(triangles_, face);
    if ((crosses(p_mm, t.a, t.b) != crosses(p_mm, t.b, t.c)) == crosses(p_mm, t.c, t.a)) return false;
    // Intersects the ray's line with the triangle's plane. A triangle that projects to a line meets no ray.
    const glm::dvec3 normal = glm::cross(t.b - t.a, t.c - t.a);
    if (normal.x == 0.0) return false;
    const glm::dvec3 rel = t.a - p_mm;
    if (glm::dot(normal, rel) / normal.x > 0.0) is_inside = !is_inside;
    return false;
  });
  return is_inside;
}

}  // namespace octotomy::verify
