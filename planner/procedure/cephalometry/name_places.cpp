// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/procedure/cephalometry/name_places.h"

#include <algorithm>

#include "voxel/view/lettering.h"

namespace octotomy::planner {
namespace {

bool overlap(const PixelBox& a, const PixelBox& b) {
  return glm::all(glm::lessThan(a.low, b.high)) && glm::all(glm::lessThan(b.low, a.high));
}

}  // namespace

std::optional<glm::dvec2> NamePlaces::place(const std::string& name, const glm::dvec2& point_px) {
  constexpr int most_rows = 8;
  const double width = voxel::text_width_px(name, cap_px_), gap = 0.6 * cap_px_, row_px = 1.3 * cap_px_;
  for (const bool may_cross_lines : {false, true})
    for (int n = 0; n <= 2 * most_rows; ++n) {
      const double row = (n % 2 == 1 ? -1.0 : 1.0) * ((n + 1) / 2);
      for (const double x : {gap, -gap - width}) {
        const glm::dvec2 start = point_px + glm::dvec2(x, row * row_px + 0.5 * cap_px_);
        // With room for the halo and for letters below the baseline.
        const PixelBox box{start - glm::dvec2(0.3 * cap_px_, 1.3 * cap_px_),
                           start + glm::dvec2(width + 0.3 * cap_px_, 0.4 * cap_px_)};
        if (!is_free(box) || (!may_cross_lines && meets_line(box))) continue;
        taken_.push_back(box);
        return start;
      }
    }
  return std::nullopt;
}

bool NamePlaces::is_free(const PixelBox& box) const {
  return glm::all(glm::greaterThanEqual(box.low, glm::dvec2(0.0))) &&
         glm::all(glm::lessThanEqual(box.high, glm::dvec2(size_px_))) &&
         std::none_of(taken_.begin(), taken_.end(),
                      [&](const PixelBox& other) { return overlap(box, other); });
}

/// Compares points of the lines, a quarter of a capital apart, with the box.
bool NamePlaces::meets_line(const PixelBox& box) const {
  return std::any_of(lines_.begin(), lines_.end(), [&](const auto& line) {
    const auto& [from, to] = line;
    const int count = static_cast<int>(glm::distance(from, to) / (0.25 * cap_px_)) + 1;
    for (int i = 0; i <= count; ++i) {
      const glm::dvec2 p = glm::mix(from, to, static_cast<double>(i) / count);
      if (overlap(box, {p, p})) return true;
    }
    return false;
  });
}

}  // namespace octotomy::planner
