// SPDX-License-Identifier: AGPL-3.0-or-later
//
// How hidden triangles are found. Divide the view into cells. In each cell, join triangles across the edges
// that they share to sheets. A sheet has a border within the cell only if the surface turns away at one of
// the sheet's edges there. A sheet without a border in the cell covers the whole cell or nothing of it: all
// if it covers the cell's middle. In that cell, everything deeper than all corners of a covering sheet's
// triangles is hidden.
#include "brep/shape/front_faces.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tbb/parallel_for.h>

#include "brep/mesh/disjoint_sets.h"

namespace octotomy::brep {
namespace {

constexpr double no_depth = std::numeric_limits<double>::infinity();
/// More cells than this cost memory and save no time.
constexpr double most_view_cells = 4.0e6;

struct FlatBox {
  glm::dvec2 low, high;
};
template <std::size_t N>
FlatBox flat_box(const std::array<glm::dvec3, N>& points) {
  FlatBox box{glm::dvec2(points[0]), glm::dvec2(points[0])};
  for (const glm::dvec3& p : points) {
    box.low = glm::min(box.low, glm::dvec2(p));
    box.high = glm::max(box.high, glm::dvec2(p));
  }
  return box;
}

/// 1 if a, b, c run counter-clockwise in the view's plane, -1 if clockwise, 0 on one line; exact.
int turn_of(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  using Exact = CGAL::Exact_predicates_inexact_constructions_kernel;
  return static_cast<int>(
      CGAL::orientation(Exact::Point_2(a.x, a.y), Exact::Point_2(b.x, b.y), Exact::Point_2(c.x, c.y)));
}

}  // namespace

ViewAxes::ViewAxes(const glm::dvec3& direction) {
  const glm::dvec3 size = glm::abs(direction);
  int least = size.y < size.x ? 1 : 0;
  if (size.z < size[least]) least = 2;
  glm::dvec3 axis(0.0);
  axis[least] = 1.0;
  const glm::dvec3 x = glm::normalize(glm::cross(axis, direction));
  lps_from_view = glm::dmat3(x, glm::cross(direction, x), direction);
}

FrontFaces::FrontFaces(const Linked& surface, const std::vector<glm::dvec3>& points)
    : surface_(surface), points_(points), is_seen_(surface.triangles.faces.size(), 0) {
  // A triangle faces the direction where it turns clockwise in the view.
  std::vector<std::uint8_t> is_front(is_seen_.size(), 0);
  tbb::parallel_for(std::size_t{0}, is_front.size(), [&](std::size_t i) {
    const auto [a, b, c] = corners(static_cast<std::uint32_t>(i));
    is_front[i] = turn_of(a, b, c) < 0 ? 1 : 0;
  });
  std::vector<std::uint32_t> front;
  for (std::uint32_t i = 0; i < is_front.size(); ++i)
    if (is_front[i] != 0) front.push_back(i);
  if (front.empty()) return;
  sort_into_cells(front);
  leave_out_hidden(front, is_front);
  sort_into_cells(seen_);
}

FrontFaces::Corners FrontFaces::corners(std::uint32_t triangle) const {
  const auto& [a, b, c] = surface_.triangles.faces[triangle];
  return {points_[a], points_[b], points_[c]};
}

glm::ivec2 FrontFaces::cell_of(const glm::dvec2& at) const {
  return glm::clamp(glm::ivec2(glm::floor((at - low_) / cell_mm_)), glm::ivec2(0), dims_ - 1);
}
std::size_t FrontFaces::index(const glm::ivec2& cell) const {
  return static_cast<std::size_t>(cell.x) +
         static_cast<std::size_t>(dims_.x) * static_cast<std::size_t>(cell.y);
}

/// Chooses about as many cells as there are triangles.
void FrontFaces::sort_into_cells(const std::vector<std::uint32_t>& triangles) {
  std::vector<FlatBox> boxes;
  boxes.reserve(triangles.size());
  for (const std::uint32_t i : triangles) boxes.push_back(flat_box(corners(i)));
  low_ = boxes.front().low;
  glm::dvec2 high = boxes.front().high;
  for (const FlatBox& box : boxes) {
    low_ = glm::min(low_, box.low);
    high = glm::max(high, box.high);
  }
  const glm::dvec2 extent = high - low_;
  const double cells = std::min(static_cast<double>(triangles.size()), most_view_cells);
  cell_mm_ = std::max(std::sqrt(extent.x * extent.y / cells), std::max(extent.x, extent.y) / cells);
  dims_ = glm::ivec2(glm::floor(extent / cell_mm_)) + 1;

  const auto for_cells = [this](const FlatBox& box, const auto& visit) {
    const glm::ivec2 from = cell_of(box.low), to = cell_of(box.high);
    for (int y = from.y; y <= to.y; ++y)
      for (int x = from.x; x <= to.x; ++x) visit(index({x, y}));
  };
  first_.assign(index({0, dims_.y}) + 1, 0);
  for (const FlatBox& box : boxes) for_cells(box, [this](std::size_t cell) { ++first_[cell + 1]; });
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  in_cell_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for_cells(boxes[i], [&](std::size_t cell) { in_cell_[next[cell]++] = triangles[i]; });
}

/// Depth in a cell behind which no triangle is visible.
double FrontFaces::depth_of_cover(std::size_t cell, const std::vector<std::uint8_t>& is_front) const {
  const auto begin = in_cell_.begin() + first_[cell], end = in_cell_.begin() + first_[cell + 1];
  const auto count = static_cast<std::size_t>(end - begin);
  const glm::ivec2 place(static_cast<int>(cell % static_cast<std::size_t>(dims_.x)),
                         static_cast<int>(cell / static_cast<std::size_t>(dims_.x)));
  DisjointSets sets(count);
  std::vector<std::uint8_t> ends_here(count, 0);
  for (std::uint32_t i = 0; i < count; ++i)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t side = 3 * begin[i] + k, beyond = surface_.opposite[side] / 3;
      if (is_front[beyond] != 0) {
        // The triangle beyond has an edge in this cell only if it is in the cell itself.
        const auto found = std::lower_bound(begin, end, beyond);
        if (found != end && *found == beyond) sets.join(i, static_cast<std::uint32_t>(found - begin));
        continue;
      }
      const FlatBox edge = flat_box(std::array{points_[surface_.from(side)], points_[surface_.to(side)]});
      if (glm::all(glm::lessThanEqual(cell_of(edge.low), place)) &&
          glm::all(glm::lessThanEqual(place, cell_of(edge.high))))
        ends_here[i] = 1;
    }
  std::vector<std::uint8_t> ends(count, 0), has_middle(count, 0);
  std::vector<double> deepest(count, -no_depth);
  const glm::dvec2 middle = low_ + (glm::dvec2(place) + 0.5) * cell_mm_;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t set = sets.set_of(i);
    ends[set] |= ends_here[i];
    if (has_middle[set] == 0 && covers(begin[i], middle)) has_middle[set] = 1;
    for (const glm::dvec3& p : corners(begin[i])) deepest[set] = std::max(deepest[set], p.z);
  }
  double cover = no_depth;
  for (std::size_t set = 0; set < count; ++set)
    if (has_middle[set] != 0 && ends[set] == 0) cover = std::min(cover, deepest[set]);
  return cover;
}

void FrontFaces::leave_out_hidden(const std::vector<std::uint32_t>& front,
                                  const std::vector<std::uint8_t>& is_front) {
  std::vector<double> cover(first_.size() - 1);
  tbb::parallel_for(std::size_t{0}, cover.size(),
                    [&](std::size_t cell) { cover[cell] = depth_of_cover(cell, is_front); });
  tbb::parallel_for(std::size_t{0}, front.size(), [&](std::size_t i) {
    const Corners points = corners(front[i]);
    const double nearest = std::min({points[0].z, points[1].z, points[2].z});
    const FlatBox box = flat_box(points);
    const glm::ivec2 from = cell_of(box.low), to = cell_of(box.high);
    for (int y = from.y; y <= to.y; ++y)
      for (int x = from.x; x <= to.x; ++x)
        if (nearest <= cover[index({x, y})]) is_seen_[front[i]] = 1;
  });
  for (const std::uint32_t i : front)
    if (is_seen_[i] != 0) seen_.push_back(i);
}

bool FrontFaces::covers(std::uint32_t triangle, const glm::dvec2& at) const {
  const auto [a, b, c] = corners(triangle);
  return turn_of(a, b, at) <= 0 && turn_of(b, c, at) <= 0 && turn_of(c, a, at) <= 0;
}

double FrontFaces::depth(std::uint32_t triangle, const glm::dvec2& at) const {
  const auto [a, b, c] = corners(triangle);
  const auto area = [](const glm::dvec2& p, const glm::dvec2& q, const glm::dvec2& r) {
    return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
  };
  const double of_a = area(b, c, at), of_b = area(c, a, at), of_c = area(a, b, at);
  const auto [low, high] = std::minmax({a.z, b.z, c.z});
  return std::clamp((of_a * a.z + of_b * b.z + of_c * c.z) / (of_a + of_b + of_c), low, high);
}

std::uint32_t FrontFaces::first_at(const glm::dvec2& at) const {
  std::uint32_t first = none;
  if (seen_.empty()) return first;
  double nearest = no_depth;
  const std::size_t cell = index(cell_of(at));
  for (std::uint32_t i = first_[cell]; i < first_[cell + 1]; ++i) {
    const std::uint32_t triangle = in_cell_[i];
    const auto [a, b, c] = corners(triangle);
    if (std::min({a.z, b.z, c.z}) >= nearest || !covers(triangle, at)) continue;
    if (const double found = depth(triangle, at); found < nearest) {
      nearest = found;
      first = triangle;
    }
  }
  return first;
}

}  // namespace octotomy::brep
