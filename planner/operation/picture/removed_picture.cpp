// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/picture/removed_picture.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

constexpr int columns = 5;
constexpr int tile_px = 280;

class Drawing {
 public:
  Drawing(const voxel::Lattice& lattice, const voxel::Int16Samples& before, const voxel::Int16Samples& after)
      : lattice_(lattice), before_(before), after_(after) {
    const glm::dvec3 size = glm::dvec3(lattice.dims) * lattice.spacing_mm();
    mm_per_px_ = std::max({size.x, size.y, size.z}) / tile_px;
    picture_.size_px = {columns * tile_px, 3 * tile_px};
    picture_.rgb.assign(static_cast<std::size_t>(3 * columns * tile_px) * 3 * tile_px, 0);
  }

  RemovedPicture run() {
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < columns; ++column) draw(2 - row, row, column);
    return std::move(picture_);
  }

 private:
  void draw(int across, int row, int column) {
    const int u = across == 0 ? 1 : 0, v = across == 2 ? 1 : 2;
    const glm::ivec3 dims = lattice_.dims;
    const glm::dvec3 mm = lattice_.spacing_mm();
    // The patient's head is at the top and the back at the bottom, in whichever direction the axis is stored.
    const bool is_upright = v == 2 ? lattice_.lps_from_voxel[2].z > 0.0 : lattice_.lps_from_voxel[1].y < 0.0;
    glm::ivec3 p(0);
    p[across] = dims[across] * (2 * column + 1) / (2 * columns);
    for (int y = 0; y < tile_px; ++y)
      for (int x = 0; x < tile_px; ++x) {
        p[u] = static_cast<int>(x * mm_per_px_ / mm[u]);
        p[v] = static_cast<int>(y * mm_per_px_ / mm[v]);
        if (p[u] >= dims[u] || p[v] >= dims[v]) continue;
        if (is_upright) p[v] = dims[v] - 1 - p[v];
        paint(p, {column * tile_px + x, row * tile_px + y});
      }
  }

  void paint(const glm::ivec3& p, const glm::ivec2& pixel) {
    const auto at = (static_cast<std::size_t>(p.z) * static_cast<std::size_t>(lattice_.dims.y) +
                     static_cast<std::size_t>(p.y)) *
                        static_cast<std::size_t>(lattice_.dims.x) +
                    static_cast<std::size_t>(p.x);
    const bool is_gone = before_[at] != after_[at];
    const double grey = std::clamp((before_[at] + 1000.0) / 1600.0, 0.0, 1.0) * 255.0;
    std::uint8_t* const rgb =
        &picture_.rgb[3 * (static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(columns * tile_px) +
                           static_cast<std::size_t>(pixel.x))];
    rgb[0] = static_cast<std::uint8_t>(is_gone ? 0.4 * grey + 153.0 : grey);
    rgb[1] = rgb[2] = static_cast<std::uint8_t>(is_gone ? 0.4 * grey : grey);
  }

  const voxel::Lattice& lattice_;
  const voxel::Int16Samples &before_, &after_;
  double mm_per_px_ = 1.0;
  RemovedPicture picture_;
};

}  // namespace

RemovedPicture removed_picture(const voxel::Scene& before, const voxel::Scene& after) {
  const auto* const was = std::get_if<voxel::Int16Samples>(&before.samples);
  const auto* const is = std::get_if<voxel::Int16Samples>(&after.samples);
  if (was == nullptr || is == nullptr || !(before.lattice == after.lattice))
    throw voxel::InvalidInput(before.source + ": only int16 samples on the same lattice can be compared");
  return Drawing(before.lattice, *was, *is).run();
}

}  // namespace octotomy::planner
