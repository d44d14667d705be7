// SPDX-License-Identifier: AGPL-3.0-or-later
// The painter's algorithm: cells are filled with white and outlined in black, from the farthest to the nearest.
#include "planner/operation/picture/relief.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <set>

#include "voxel/view/pen.h"

namespace octotomy::planner {
namespace {

/// The heights in mm of the grid's corners above the plane of the farthest lit depth.
struct Heights {
  glm::ivec2 corners{0};
  double cell_px = 1.0;
  std::vector<float> mm;
  float at(int x, int y) const { return mm[static_cast<std::size_t>(y * corners.x + x)]; }
};

/// Fills a convex polygon of the picture with white.
void fill_white(const voxel::Canvas& canvas, const std::vector<glm::dvec2>& polygon) {
  double top = polygon.front().y, bottom = top;
  for (const glm::dvec2& p : polygon) {
    top = std::min(top, p.y);
    bottom = std::max(bottom, p.y);
  }
  const int last = std::min(canvas.size_px.y - 1, static_cast<int>(std::floor(bottom)));
  for (int y = std::max(0, static_cast<int>(std::floor(top))); y <= last; ++y) {
    double left = std::numeric_limits<double>::infinity(), right = -left;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec2& a = polygon[i];
      const glm::dvec2& b = polygon[(i + 1) % polygon.size()];
      const double at = y + 0.5;
      if ((a.y <= at) == (b.y <= at)) continue;
      const double x = a.x + (b.x - a.x) * (at - a.y) / (b.y - a.y);
      left = std::min(left, x);
      right = std::max(right, x);
    }
    if (!(left < right)) continue;
    const int first = std::max(0, static_cast<int>(std::ceil(left - 0.5)));
    const int end = std::min(canvas.size_px.x, static_cast<int>(std::ceil(right - 0.5)));
    if (first < end) voxel::fill_rectangle(canvas, {first, y}, {end, y + 1}, glm::vec3(1.0f));
  }
}

Heights heights_of(const voxel::Picture& picture, int cells, Relief& relief) {
  Heights heights;
  heights.cell_px = static_cast<double>(std::max(picture.size_px.x, picture.size_px.y)) / cells;
  heights.corners = glm::max(glm::ivec2(glm::dvec2(picture.size_px) / heights.cell_px), 1);
  float far_mm = 0.0f;
  for (const float depth : picture.depth_mm)
    if (std::isfinite(depth)) far_mm = std::max(far_mm, depth);
  std::set<float> levels;
  for (int y = 0; y < heights.corners.y; ++y)
    for (int x = 0; x < heights.corners.x; ++x) {
      // The pixel whose depth a corner of the grid has.
      const glm::ivec2 pixel(glm::dvec2(x + 0.5, y + 0.5) * heights.cell_px);
      const float depth =
          picture.depth_mm[static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(picture.size_px.x) +
                           static_cast<std::size_t>(pixel.x)];
      const bool is_lit = std::isfinite(depth);
      heights.mm.push_back(is_lit ? far_mm - depth : 0.0f);
      if (!is_lit) continue;
      levels.insert(depth);
      ++relief.corners;
    }
  relief.levels = levels.size();
  return heights;
}

}  // namespace

Relief relief_of(const voxel::Picture& picture, int cells) {
  Relief relief;
  const Heights heights = heights_of(picture, cells, relief);
  relief.rgb.assign(3 * picture.depth_mm.size(), 255);
  const voxel::Canvas canvas{picture.size_px, &relief.rgb};
  // An isometric projection: the two axes of the plane go down to the left and to the right at 30 degrees,
  // and heights go up.
  const double cell_mm = heights.cell_px * picture.pixel_mm;
  const glm::dvec2 right(std::sqrt(0.75), 0.5), down(-std::sqrt(0.75), 0.5), up(0.0, -1.0);
  const auto flat = [&](int x, int y) {
    return cell_mm * (double(x) * right + double(y) * down) + double(heights.at(x, y)) * up;
  };
  glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
  for (int y = 0; y < heights.corners.y; ++y)
    for (int x = 0; x < heights.corners.x; ++x) {
      low = glm::min(low, flat(x, y));
      high = glm::max(high, flat(x, y));
    }
  const glm::dvec2 extent = glm::max(high - low, 1e-9);
  const glm::dvec2 room = 0.95 * glm::dvec2(picture.size_px) / extent;
  const double px_per_mm = std::min(room.x, room.y);
  const auto at = [&](int x, int y) {
    return px_per_mm * (flat(x, y) - 0.5 * (low + high)) + 0.5 * glm::dvec2(picture.size_px);
  };
  const voxel::Pen pen{1.0, glm::vec3(0.0f), 0.0, glm::vec3(1.0f)};
  for (int far = 0; far <= heights.corners.x + heights.corners.y - 4; ++far)
    for (int x = std::max(0, far - heights.corners.y + 2); x <= std::min(far, heights.corners.x - 2); ++x) {
      const int y = far - x;
      const std::vector<glm::dvec2> cell{at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)};
      // A cell is drawn as two triangles, because a bent cell may not be convex in the picture.
      fill_white(canvas, {cell[0], cell[1], cell[2]});
      fill_white(canvas, {cell[0], cell[2], cell[3]});
      voxel::draw_lines(canvas, {{cell[0], cell[1], cell[2], cell[3], cell[0]}}, pen);
    }
  return relief;
}

}  // namespace octotomy::planner
