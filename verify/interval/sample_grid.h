// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <tbb/parallel_for.h>
#include <vector>

// A scan's samples as an array, x fastest, and filters of the whole array. Parallel; same bits on any thread
// count. Cost: order n.
namespace octotomy::verify {

using SampleValues = std::vector<float>;
using SampleMask = std::vector<std::uint8_t>;

struct SampleGrid {
  glm::ivec3 dims{0};
  glm::dvec3 spacing_mm{1.0};
  std::size_t size() const {
    return static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y) *
           static_cast<std::size_t>(dims.z);
  }
  std::size_t stride(int axis) const {
    return axis == 0   ? 1
           : axis == 1 ? static_cast<std::size_t>(dims.x)
                       : static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y);
  }
  std::size_t at(int x, int y, int z) const {
    return static_cast<std::size_t>(x) + stride(1) * static_cast<std::size_t>(y) +
           stride(2) * static_cast<std::size_t>(z);
  }
};

/// Sums in an order that does not depend on the threads: within planes of z, then over the planes.
template <typename Sum, typename PerPlane>
Sum by_planes(const SampleGrid& grid, const PerPlane& per_plane) {
  std::vector<Sum> planes(static_cast<std::size_t>(grid.dims.z));
  tbb::parallel_for(0, grid.dims.z, [&](int z) { per_plane(z, planes[static_cast<std::size_t>(z)]); });
  Sum whole{};
  for (const Sum& plane : planes) whole += plane;
  return whole;
}

/// A Gaussian blur with a deviation in samples along each axis. Beyond the border, samples repeat those of
/// the border.
SampleValues blurred(const SampleGrid& grid, SampleValues values, double deviation);

/// The lowest, or highest, of the samples within `reach` samples along each axis.
SampleValues extremes(const SampleGrid& grid, SampleValues values, std::size_t reach, bool highest);

/// Sets all samples within `reach` samples along each axis of one that is set.
void grow(const SampleGrid& grid, SampleMask& mask, std::size_t reach);

/// The area of the isosurface of `level`, with each cell divided into six tetrahedra around a diagonal.
double level_mm2(const SampleGrid& grid, const SampleValues& values, float level);

}  // namespace octotomy::verify
