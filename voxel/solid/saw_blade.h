// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "voxel/solid/expression.h"
#include "voxel/solid/region_mask.h"

namespace octotomy::voxel {

/// A saw cut along a polyline, swept in one direction.
struct SawLine {
  std::vector<glm::dvec3> line_mm;  ///< LPS; at least two points
  glm::dvec3 direction{0, 1, 0};    ///< of the blade into the bone; any length but zero
  double depth_mm = 100.0;          ///< from the first point of the line that the blade meets; above 0
  double kerf_mm = 1.0;             ///< width of the cut, half on either side of the line; above 0
};

/// The volume that the saw removes. Pieces of the line meet in mitres; its ends are square. Throws
/// std::invalid_argument if the direction is zero, the line has fewer than two distinct points in the
/// projection along the direction, or it turns back on itself.
Expression saw_blade(const SawLine& saw);

/// The blade without limits in depth, as a mask of one region. Throws as saw_blade().
RegionMask saw_blade_sides(const SawLine& saw);

}  // namespace octotomy::voxel
