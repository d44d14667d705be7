// SPDX-License-Identifier: AGPL-3.0-or-later
// A uniform grid: each cell lists the sides whose boxes touch it, and a segment is tested in the cells along it.
#include "brep/contour/span_clearance.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

namespace octotomy::brep {
namespace {

/// Above 0 if c lies on the left of the line from a to b.
double side_of(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool differ(double a, double b) {
  return (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0);
}

}  // namespace

SpanClearance::SpanClearance(const std::vector<Contour>& lower, const std::vector<Contour>& upper) {
  glm::dvec2 high(-std::numeric_limits<double>::infinity());
  low_ = -high;
  double length_mm = 0.0;
  for (const std::vector<Contour>* section : {&lower, &upper})
    for (const Contour& contour : *section)
      for (std::size_t k = 0; k < contour.points_mm.size(); ++k) {
        sides_.push_back({contour.points_mm[k], contour.points_mm[(k + 1) % contour.points_mm.size()]});
        low_ = glm::min(low_, sides_.back().from);
        high = glm::max(high, sides_.back().from);
        length_mm += glm::distance(sides_.back().from, sides_.back().to);
      }
  if (sides_.empty()) return;
  // Cells about as long as two sides, and at most 1024 cells along an axis.
  const double extent_mm = std::max(high.x - low_.x, high.y - low_.y);
  cell_mm_ = std::max({2.0 * length_mm / static_cast<double>(sides_.size()), extent_mm / 1024.0,
                       std::numeric_limits<double>::min()});
  cells_ = glm::ivec2(glm::floor((high - low_) / cell_mm_)) + 1;
  const auto for_cells = [&](const Side& side, const auto& each) {
    const glm::ivec2 from = cell_of(glm::min(side.from, side.to)), to = cell_of(glm::max(side.from, side.to));
    for (int y = from.y; y <= to.y; ++y)
      for (int x = from.x; x <= to.x; ++x) each(index({x, y}));
  };
  first_.assign(index({0, cells_.y}) + 1, 0);
  for (const Side& side : sides_) for_cells(side, [&](std::size_t cell) { ++first_[cell + 1]; });
  for (std::size_t cell = 1; cell < first_.size(); ++cell) first_[cell] += first_[cell - 1];
  held_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t s = 0; s < sides_.size(); ++s)
    for_cells(sides_[s], [&](std::size_t cell) { held_[next[cell]++] = s; });
}

glm::ivec2 SpanClearance::cell_of(const glm::dvec2& p_mm) const {
  return glm::clamp(glm::ivec2(glm::floor((p_mm - low_) / cell_mm_)), glm::ivec2(0), cells_ - 1);
}

int SpanClearance::crossed(const glm::dvec2& from_mm, const glm::dvec2& to_mm, int most) const {
  constexpr int limit = 16;
  assert(most <= limit);
  if (sides_.empty()) return 0;
  std::array<std::uint32_t, limit> found{};
  int count = 0;
  const glm::dvec2& a = from_mm.y <= to_mm.y ? from_mm : to_mm;
  const glm::dvec2& b = from_mm.y <= to_mm.y ? to_mm : from_mm;
  const auto column_of = [&](double x) {
    return static_cast<int>(std::clamp((x - low_.x) / cell_mm_, 0.0, cells_.x - 1.0));
  };
  const int first_row = cell_of(a).y, last_row = cell_of(b).y;
  for (int y = first_row; y <= last_row; ++y) {
    // The part of the segment in this row of cells, lengthened by a hundredth of a cell because of rounding.
    const double height = b.y - a.y, slack = 0.01 * cell_mm_;
    const auto x_at = [&](double at_mm) {
      return height > 0.0 ? a.x + (b.x - a.x) * std::clamp((at_mm - a.y) / height, 0.0, 1.0) : a.x;
    };
    double low = x_at(low_.y + y * cell_mm_ - slack), high = x_at(low_.y + (y + 1) * cell_mm_ + slack);
    if (height <= 0.0) high = b.x;
    if (low > high) std::swap(low, high);
    const int left = column_of(low - slack), right = column_of(high + slack);
    for (int x = left; x <= right; ++x) {
      const std::size_t cell = index({x, y});
      for (std::uint32_t k = first_[cell]; k < first_[cell + 1]; ++k) {
        const Side& side = sides_[held_[k]];
        if (!differ(side_of(a, b, side.from), side_of(a, b, side.to)) ||
            !differ(side_of(side.from, side.to, a), side_of(side.from, side.to, b)) ||
            std::find(found.begin(), found.begin() + count, held_[k]) != found.begin() + count)
          continue;
        found[static_cast<std::size_t>(count++)] = held_[k];
        if (count == most) return count;
      }
    }
  }
  return count;
}

}  // namespace octotomy::brep
