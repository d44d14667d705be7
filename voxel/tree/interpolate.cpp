// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/interpolate.h"

#include <cassert>
#include <cmath>

namespace octotomy::voxel {

Stencil stencil(double position, Interpolation interpolation) {
  assert(std::isfinite(position));
  const double cell = std::floor(position);
  const double t = position - cell;
  const int low = static_cast<int>(cell);
  switch (interpolation) {
    case Interpolation::Nearest:
      return {static_cast<int>(std::floor(position + 0.5)), 1, {1.0, 0.0, 0.0, 0.0}};
    case Interpolation::Linear:
      return {low, 2, {1.0 - t, t, 0.0, 0.0}};
    case Interpolation::Cubic:
      break;
  }
  return {low - 1,
          4,
          {0.5 * t * (t * (2.0 - t) - 1.0), 0.5 * (t * t * (3.0 * t - 5.0) + 2.0),
           0.5 * t * (t * (4.0 - 3.0 * t) + 1.0), 0.5 * t * t * (t - 1.0)}};
}

Margin margin(Interpolation interpolation) {
  return interpolation == Interpolation::Cubic ? Margin{1, 2} : Margin{0, 1};
}

ValueRange value_range(const MinMax& samples, Interpolation interpolation) {
  assert(samples.low <= samples.high);
  if (interpolation != Interpolation::Cubic)
    return {static_cast<double>(samples.low), static_cast<double>(samples.high)};
  constexpr double most = 1.25 * 1.25 * 1.25;
  const double middle = 0.5 * (samples.low + samples.high);
  const double half = 0.5 * (samples.high - samples.low);
  return {middle - most * half, middle + most * half};
}

double interpolate(const GreyOctree& grey, const glm::dvec3& p_voxel, Interpolation interpolation) {
  const Stencil x = stencil(p_voxel.x, interpolation);
  const Stencil y = stencil(p_voxel.y, interpolation);
  const Stencil z = stencil(p_voxel.z, interpolation);
  double value = 0.0;
  for (int k = 0; k < z.count; ++k) {
    double plane = 0.0;
    for (int j = 0; j < y.count; ++j) {
      double row = 0.0;
      for (int i = 0; i < x.count; ++i)
        row += x.weight[static_cast<std::size_t>(i)] * grey.sample({x.first + i, y.first + j, z.first + k});
      plane += y.weight[static_cast<std::size_t>(j)] * row;
    }
    value += z.weight[static_cast<std::size_t>(k)] * plane;
  }
  return value;
}

double interpolate_scan(const GreyOctree& grey, const glm::dvec3& p_voxel) {
  const glm::ivec3 low(glm::floor(p_voxel));
  const auto corner_of = [&](int number) {
    return low + glm::ivec3(number & 1, number >> 1 & 1, number >> 2);
  };
  // Samples that differ from the background always belong to the scan.
  bool any_background = false;
  for (int number = 0; number < 8 && !any_background; ++number)
    any_background = grey.sample(corner_of(number)) == grey.background();
  if (!any_background) return interpolate(grey, p_voxel, Interpolation::Linear);

  const int side = grey.universe().side();
  const auto in_scan = [&](const glm::ivec3& voxel) {
    return glm::all(glm::greaterThanEqual(voxel, glm::ivec3(0))) &&
           glm::all(glm::lessThan(voxel, glm::ivec3(side))) && grey.scan().contains(voxel);
  };
  if (!in_scan(glm::ivec3(glm::floor(p_voxel + 0.5)))) return grey.background();
  bool any_beyond = false;
  const glm::dvec3 t = p_voxel - glm::dvec3(low);
  double value = 0.0, weights = 0.0;
  for (int number = 0; number < 8; ++number) {
    const glm::ivec3 corner = corner_of(number);
    const glm::dvec3 share = glm::mix(1.0 - t, t, glm::dvec3(corner - low));
    const double weight = share.x * share.y * share.z;
    if (weight == 0.0) continue;
    if (!in_scan(corner)) {
      any_beyond = true;
      continue;
    }
    value += weight * grey.sample(corner);
    weights += weight;
  }
  // If all samples belong to the scan, the result has the same bits as that of interpolate().
  return any_beyond ? value / weights : interpolate(grey, p_voxel, Interpolation::Linear);
}

}  // namespace octotomy::voxel
