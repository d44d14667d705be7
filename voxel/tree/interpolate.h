// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "voxel/tree/grey_octree.h"

namespace octotomy::voxel {

/// Interpolation between samples: the nearest one; trilinear; or the tricubic convolution of Keys (IEEE
/// Trans. ASSP 29, 1981) with a = -1/2, which reproduces quadratics and overshoots at steps.
enum class Interpolation { Nearest, Linear, Cubic };

/// The samples along one axis on which a value depends, and their weights, which sum to 1.
struct Stencil {
  int first = 0;  ///< index of the first sample
  int count = 1;
  std::array<double, 4> weight{1.0, 0.0, 0.0, 0.0};
};
Stencil stencil(double position, Interpolation interpolation);

/// How many samples before and after floor(position) a stencil may include.
struct Margin {
  int before = 0;
  int after = 1;
};
Margin margin(Interpolation interpolation);

/// Bounds of an interpolated value from the range of its samples. The bounds equal this range except for
/// Cubic, whose weights may be negative: their magnitudes sum to at most 5/4 along each axis.
struct ValueRange {
  double low, high;
};
ValueRange value_range(const MinMax& samples, Interpolation interpolation);

/// The value at a position in voxel indices of the octree's universe, in the octree's steps. Samples beyond
/// the universe are the background.
double interpolate(const GreyOctree& grey, const glm::dvec3& p_voxel, Interpolation interpolation);

/// The trilinear value at a position, in voxel indices of the octree's universe, from samples of the scan
/// only. Samples around the position that do not belong to the scan are left out, and the other weights are
/// scaled to sum to 1. Returns the background if the nearest voxel does not belong to the scan.
double interpolate_scan(const GreyOctree& grey, const glm::dvec3& p_voxel);

}  // namespace octotomy::voxel
