// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "voxel/solid/expression.h"
#include "voxel/solid/region_mask.h"

namespace octotomy::voxel {

/// A saw cut along a polyline, swept in one direction.
struct SawLine {
  std::vector<glm::dvec3> line_mm;  ///< points of the cut on the bone, LPS; at least two
  glm::dvec3 direction{0, 1, 0};    ///< direction of the blade into the bone, LPS; any length above 0
  /// Depth along the direction, counted from the line's point that the blade meets first; above 0.
  double depth_mm = 100.0;
  double kerf_mm = 1.0;  ///< width of the cut, half on either side of the line; above 0
};

/// The volume that the saw removes. Pieces of the line meet in mitres; the line's ends are square. Throws
/// std::invalid_argument if the direction is zero, the line has fewer than two distinct points in the
/// projection along the direction, or it turns back on itself.
Expression saw_blade(const SawLine& saw);

/// The blade without limits in depth, as a mask of one region. Throws as saw_blade() does.
RegionMask saw_blade_sides(const SawLine& saw);

}  // namespace octotomy::voxel
