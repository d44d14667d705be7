// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/grid.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "voxel/space/error.h"
#include "voxel/view/lettering.h"
#include "voxel/view/pixel_index.h"

namespace octotomy::voxel {
namespace {

constexpr double nearest_lines_px = 4.0;
const glm::vec3 ink(0.05f, 0.40f, 0.85f);
constexpr float line_strength = 0.32f, labelled_strength = 0.62f;

/// The height of letters, equal to that of annotations on pictures of this size.
double cap_px(const glm::ivec2& size_px) {
  return std::max(7.0, std::min(size_px.x, size_px.y) / 50.0);
}

struct Line {
  double at_mm;
  int pixel;  ///< the column or row in which the line lies
};

/// The lines across u (axis 0, columns) or v (axis 1, rows), in ascending order of pixels.
std::vector<Line> lines_of(const glm::ivec2& size_px, const Grid& grid, int axis) {
  const double along = axis == 0 ? grid.pixel_mm : -grid.pixel_mm;
  const double from_mm = grid.corner_mm[axis], to_mm = from_mm + along * size_px[axis];
  const auto first = std::llround(std::ceil(std::min(from_mm, to_mm) / grid.spacing_mm));
  const auto last = std::llround(std::floor(std::max(from_mm, to_mm) / grid.spacing_mm));
  std::vector<Line> lines;
  for (auto number = first; number <= last; ++number) {
    const double at_mm = static_cast<double>(number) * grid.spacing_mm;
    const int pixel = static_cast<int>(std::floor((at_mm - from_mm) / along));
    if (pixel >= 0 && pixel < size_px[axis]) lines.push_back({at_mm, pixel});
  }
  if (axis == 1) std::reverse(lines.begin(), lines.end());
  return lines;
}

std::string text_of(double mm) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", mm + 0.0);
  return text;
}

/// Every n-th line gets a label. Returns the least n for which there is at least a letter's width between
/// labels.
int labelled_every(const std::vector<Line>& lines, const Grid& grid, double cap, int axis) {
  double room_px = 1.8 * cap;
  if (axis == 0)
    for (const Line& line : lines) room_px = std::max(room_px, text_width_px(text_of(line.at_mm), cap) + cap);
  int every = 1;
  for (const int factor : {2, 5, 10, 20, 50, 100, 200, 500})
    if (every * grid.spacing_mm / grid.pixel_mm < room_px) every = factor;
  return every;
}

bool is_labelled(const Line& line, const Grid& grid, int every) {
  return std::llround(line.at_mm / grid.spacing_mm) % every == 0;
}

void check(const Grid& grid, const glm::ivec2& size_px) {
  const double apart_px = grid.spacing_mm / grid.pixel_mm;
  if (!(apart_px >= nearest_lines_px))
    throw InvalidInput("a grid of " + text_of(grid.spacing_mm) + " mm has lines " +
                       text_of(std::round(10.0 * apart_px) / 10.0) + " pixels apart: choose at least " +
                       text_of(std::ceil(nearest_lines_px * grid.pixel_mm)) + " mm");
  if (lines_of(size_px, grid, 0).empty() && lines_of(size_px, grid, 1).empty())
    throw InvalidInput("a grid of " + text_of(grid.spacing_mm) +
                       " mm has no line in this picture: choose a smaller one");
}

}  // namespace

Grid grid_of(const ImagePlane& plane, double spacing_mm) {
  return {spacing_mm, plane.view_mm({0.0, 0.0}), plane.pixel_mm};
}

void draw_grid(const Canvas& canvas, const Grid& grid) {
  check(grid, canvas.size_px);
  const auto blend = [&](int x, int y, float strength) {
    std::uint8_t* rgb = &(*canvas.rgb)[3 * pixel_index(canvas.size_px, x, y)];
    for (int channel = 0; channel < 3; ++channel)
      rgb[channel] = static_cast<std::uint8_t>(std::lround(
          (1.0f - strength) * static_cast<float>(rgb[channel]) + strength * 255.0f * ink[channel]));
  };
  for (const int axis : {0, 1}) {
    const std::vector<Line> lines = lines_of(canvas.size_px, grid, axis);
    const int every = labelled_every(lines, grid, cap_px(canvas.size_px), axis);
    for (const Line& line : lines) {
      const float strength = is_labelled(line, grid, every) ? labelled_strength : line_strength;
      for (int along = 0; along < canvas.size_px[1 - axis]; ++along)
        blend(axis == 0 ? line.pixel : along, axis == 0 ? along : line.pixel, strength);
    }
  }
}

glm::ivec2 add_grid_margin(std::vector<std::uint8_t>& rgb, const glm::ivec2& size_px, const Grid& grid) {
  const double cap = cap_px(size_px);
  const std::vector<Line> columns = lines_of(size_px, grid, 0), rows = lines_of(size_px, grid, 1);
  double widest_px = text_width_px("mm", cap);
  for (const Line& row : rows) widest_px = std::max(widest_px, text_width_px(text_of(row.at_mm), cap));
  const glm::ivec2 whole_px =
      size_px + glm::ivec2(std::lround(std::ceil(widest_px + 1.6 * cap)), std::lround(std::ceil(2.6 * cap)));
  std::vector<std::uint8_t> whole(std::size_t{3} * pixel_count(whole_px), 245);
  for (int y = 0; y < size_px.y; ++y)
    std::copy_n(rgb.begin() + static_cast<std::ptrdiff_t>(3 * pixel_index(size_px, 0, y)),
                std::ptrdiff_t{3} * size_px.x,
                whole.begin() + static_cast<std::ptrdiff_t>(3 * pixel_index(whole_px, 0, y)));
  rgb = std::move(whole);
  const Canvas canvas{whole_px, &rgb};
  const Pen pen{std::max(1.1, cap / 7.5), glm::vec3(0.1f)};
  const Pen tick{1.0, ink};
  const auto write = [&](const std::string& text, const glm::dvec2& baseline_px) {
    draw_lines(canvas, strokes_of_text(text, baseline_px, cap), pen);
  };
  const double right = size_px.x, below = size_px.y;
  for (const Line& column : columns)
    if (is_labelled(column, grid, labelled_every(columns, grid, cap, 0))) {
      const std::string text = text_of(column.at_mm);
      const double half = 0.5 * text_width_px(text, cap), x = column.pixel + 0.5;
      draw_lines(canvas, {{{x, below}, {x, below + 0.5 * cap}}}, tick);
      // Skips a label at an edge if it would be cut off or overlap the unit.
      if (x >= half && x + half + 0.3 * cap <= right) write(text, {x - half, below + 2.0 * cap});
    }
  for (const Line& row : rows)
    if (is_labelled(row, grid, labelled_every(rows, grid, cap, 1))) {
      const double y = row.pixel + 0.5;
      draw_lines(canvas, {{{right, y}, {right + 0.5 * cap, y}}}, tick);
      write(text_of(row.at_mm), {right + 0.8 * cap, std::max(cap + 1.0, y + 0.5 * cap)});
    }
  // The unit is drawn below the labels of the rows and right of the labels of the columns.
  write("mm", {right + 0.8 * cap, below + 2.0 * cap});
  return whole_px;
}

}  // namespace octotomy::voxel
