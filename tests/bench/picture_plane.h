// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace octotomy::bench {

using Triple = std::array<double, 3>;

/// The rays of a square orthographic picture, in LPS millimetres and without any library's types: pixel (i,
/// j) looks from first + i per_px_x + j per_px_y, counted from the picture's top left pixel's centre.
struct PicturePlane {
  int side_px = 512;
  Triple first_mm{}, per_px_x_mm{}, per_px_y_mm{};
  Triple look{}, up{};
  Triple centre_mm{};  ///< of the picture
  double width_mm = 1.0;
  double range_mm = 1.0;  ///< depth of the universe's farthest corner
};

/// A surface as flat arrays.
struct FlatMesh {
  std::vector<float> points_mm;      ///< x, y, z a point
  std::vector<std::uint32_t> faces;  ///< three points a triangle
};

/// Samples of a scan on an axis-aligned lattice.
struct FlatScan {
  std::array<int, 3> dims{};
  Triple first_mm{}, spacing_mm{};
  const std::int16_t* samples = nullptr;
};

}  // namespace octotomy::bench
