// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <tbb/parallel_for.h>
#include <vector>

// A scan's samples as an array, x fastest, and filters of the whole array. All are parallel and return the
// same bits on any thread count. Cost: linear in the samples.
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

/// Adds up the sums that `per_plane` computes for each plane of z. The order does not depend on the threads.
template <typename Sum, typename PerPlane>
Sum by_planes(const SampleGrid& grid, const PerPlane& per_plane) {
  std::vector<Sum> planes(static_cast<std::size_t>(grid.dims.z));
  tbb::parallel_for(0, grid.dims.z, [&](int z) { per_plane(z, planes[static_cast<std::size_t>(z)]); });
  Sum whole{};
  for (const Sum& plane : planes) whole += plane;
  return whole;
}

/// Blurs by a Gaussian with this deviation, in samples, along each axis. Beyond the border, samples repeat
/// those of the border.
SampleValues blurred(const SampleGrid& grid, SampleValues values, double deviation);

/// Returns for each sample the lowest, or highest, of the samples within `reach` samples along each axis.
SampleValues extremes(const SampleGrid& grid, SampleValues values, std::size_t reach, bool highest);

/// Sets all samples that are within `reach` samples, along each axis, of a sample that is set.
void grow(const SampleGrid& grid, SampleMask& mask, std::size_t reach);

/// Returns the area of the isosurface of `level`. Each cell is divided into six tetrahedra around a diagonal.
double level_mm2(const SampleGrid& grid, const SampleValues& values, float level);

}  // namespace octotomy::verify
