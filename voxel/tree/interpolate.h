// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "voxel/tree/grey_octree.h"

namespace octotomy::voxel {

/// How a value between samples is made of those around it: the nearest one; trilinear; or the tricubic
/// convolution of Keys (IEEE Trans. ASSP 29, 1981) with a = -1/2, which reproduces quadratics and overshoots
/// at steps.
enum class Interpolation { Nearest, Linear, Cubic };

/// The samples along one axis that a value depends on, and their weights, which sum to 1.
struct Stencil {
  int first = 0;  ///< index of the first of them
  int count = 1;
  std::array<double, 4> weight{1.0, 0.0, 0.0, 0.0};
};
Stencil stencil(double position, Interpolation interpolation);

/// Samples before floor(position) and after it that a stencil may reach.
struct Margin {
  int before = 0;
  int after = 1;
};
Margin margin(Interpolation interpolation);

/// The range in which a value lies whose samples lie in another: the same, but for Cubic, whose weights' sum
/// of magnitudes is at most 5/4 an axis.
struct ValueRange {
  double low, high;
};
ValueRange value_range(const MinMax& samples, Interpolation interpolation);

/// The value at a position of the octree's universe, in voxel indices; samples beyond it are the background.
double interpolate(const GreyOctree& grey, const glm::dvec3& p_voxel, Interpolation interpolation);

/// The trilinear value at a position, as above, made of the scan's own samples alone: those about the
/// position that are none leave their weight to the others. The background where the nearest voxel is not the
/// scan's.
double interpolate_scan(const GreyOctree& grey, const glm::dvec3& p_voxel);

}  // namespace octotomy::voxel
