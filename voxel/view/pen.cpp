// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/pen.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "voxel/view/pixel_index.h"
#include "voxel/view/srgb.h"

namespace octotomy::voxel {
namespace {

/// A rectangle of pixels from first up to, not including, last.
struct PixelBox {
  glm::ivec2 first{0};
  glm::ivec2 last{0};

  bool is_empty() const { return first.x >= last.x || first.y >= last.y; }
};

PixelBox box_about(const Polyline& line, double reach_px, const glm::ivec2& size_px) {
  glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const glm::dvec2& point : line) {
    low = glm::min(low, point);
    high = glm::max(high, point);
  }
  const glm::dvec2 size(size_px);
  return {glm::ivec2(glm::clamp(glm::floor(low - reach_px), glm::dvec2(0.0), size)),
          glm::ivec2(glm::clamp(glm::ceil(high + reach_px), glm::dvec2(0.0), size))};
}

double distance_to(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 along = b - a;
  const double square = glm::dot(along, along);
  const double t = square > 0.0 ? std::clamp(glm::dot(p - a, along) / square, 0.0, 1.0) : 0.0;
  return glm::distance(p, a + t * along);
}

void mix(std::uint8_t* rgb, const glm::vec3& linear, float share) {
  glm::vec3 mixed;
  for (int channel = 0; channel < 3; ++channel)
    mixed[channel] = glm::mix(SrgbTable::table().linear(rgb[channel]), linear[channel], share);
  put_srgb(rgb, mixed);
}

}  // namespace

void draw_lines(const Canvas& canvas, const std::vector<Polyline>& lines, const Pen& pen) {
  assert(canvas.rgb != nullptr);
  const double reach_px = 0.5 * pen.width_px + pen.halo_px + 1.0;
  PixelBox all{canvas.size_px, glm::ivec2(0)};
  for (const Polyline& line : lines) {
    const PixelBox box = box_about(line, reach_px, canvas.size_px);
    all.first = glm::min(all.first, box.first);
    all.last = glm::max(all.last, box.last);
  }
  if (all.is_empty()) return;
  const glm::ivec2 extent = all.last - all.first;
  std::vector<float> distance(static_cast<std::size_t>(extent.x) * static_cast<std::size_t>(extent.y),
                              std::numeric_limits<float>::infinity());
  const auto index = [&](int x, int y) {
    return static_cast<std::size_t>(y - all.first.y) * static_cast<std::size_t>(extent.x) +
           static_cast<std::size_t>(x - all.first.x);
  };
  for (const Polyline& line : lines)
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
      const PixelBox box = box_about({line[i], line[i + 1]}, reach_px, canvas.size_px);
      for (int y = box.first.y; y < box.last.y; ++y)
        for (int x = box.first.x; x < box.last.x; ++x) {
          float& least = distance[index(x, y)];
          least = std::min(least, static_cast<float>(distance_to({x + 0.5, y + 0.5}, line[i], line[i + 1])));
        }
    }
  const glm::vec3 ink = linear_from_srgb(pen.colour), halo = linear_from_srgb(pen.halo);
  for (int y = all.first.y; y < all.last.y; ++y)
    for (int x = all.first.x; x < all.last.x; ++x) {
      // The coverage is the distance from the pixel's near side to the line's edge, which is exact for edges
      // along rows and columns.
      const auto cover = [&](double half_px) {
        return static_cast<float>(std::clamp(half_px + 0.5 - distance[index(x, y)], 0.0, 1.0));
      };
      std::uint8_t* rgb = &(*canvas.rgb)[3 * pixel_index(canvas.size_px, x, y)];
      if (pen.halo_px > 0.0) mix(rgb, halo, cover(0.5 * pen.width_px + pen.halo_px));
      mix(rgb, ink, cover(0.5 * pen.width_px));
    }
}

void fill_rectangle(const Canvas& canvas, const glm::ivec2& first, const glm::ivec2& last,
                    const glm::vec3& colour) {
  assert(canvas.rgb != nullptr);
  const glm::ivec2 low = glm::clamp(first, glm::ivec2(0), canvas.size_px);
  const glm::ivec2 high = glm::clamp(last, glm::ivec2(0), canvas.size_px);
  for (int y = low.y; y < high.y; ++y)
    for (int x = low.x; x < high.x; ++x)
      put_srgb(&(*canvas.rgb)[3 * pixel_index(canvas.size_px, x, y)], linear_from_srgb(colour));
}

}  // namespace octotomy::voxel
