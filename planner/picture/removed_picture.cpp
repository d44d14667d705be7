// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/picture/removed_picture.h"

#include <algorithm>
#include <cmath>

namespace octotomy::planner {
namespace {

constexpr int columns = 5;
constexpr int tile_px = 280;

class Drawing {
 public:
  Drawing(const voxel::Scene& clean, const voxel::GreyOctree& removed)
      : clean_(clean), removed_(removed), samples_(std::get<voxel::Int16Samples>(clean.samples)) {
    const glm::dvec3 size = glm::dvec3(clean.lattice.dims) * clean.lattice.spacing_mm();
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
    const glm::ivec3 dims = clean_.lattice.dims;
    const glm::dvec3 mm = clean_.lattice.spacing_mm();
    // The patient's head is up and the back is down, whichever way the axis is stored.
    const bool is_upright =
        v == 2 ? clean_.lattice.lps_from_voxel[2].z > 0.0 : clean_.lattice.lps_from_voxel[1].y < 0.0;
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
    const std::int16_t gone = removed_.sample(p);
    const bool is_gone = gone != removed_.background();
    const auto at = (static_cast<std::size_t>(p.z) * static_cast<std::size_t>(clean_.lattice.dims.y) +
                     static_cast<std::size_t>(p.y)) *
                        static_cast<std::size_t>(clean_.lattice.dims.x) +
                    static_cast<std::size_t>(p.x);
    const double grey = std::clamp(((is_gone ? gone : samples_[at]) + 1000.0) / 1600.0, 0.0, 1.0) * 255.0;
    std::uint8_t* const rgb =
        &picture_.rgb[3 * (static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(columns * tile_px) +
                           static_cast<std::size_t>(pixel.x))];
    rgb[0] = static_cast<std::uint8_t>(is_gone ? 0.4 * grey + 153.0 : grey);
    rgb[1] = rgb[2] = static_cast<std::uint8_t>(is_gone ? 0.4 * grey : grey);
  }

  const voxel::Scene& clean_;
  const voxel::GreyOctree& removed_;
  const voxel::Int16Samples& samples_;
  double mm_per_px_ = 1.0;
  RemovedPicture picture_;
};

}  // namespace

RemovedPicture removed_picture(const voxel::Scene& clean, const voxel::GreyOctree& removed) {
  return Drawing(clean, removed).run();
}

}  // namespace octotomy::planner
