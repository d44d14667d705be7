// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

struct Settled {
  Triangles surface;
  std::size_t crossing = 0;  ///< pairs of triangles beside new points that still intersect
  std::size_t flat = 0;      ///< triangles beside new points that still have no area
  glm::dvec3 at_mm{0.0};     ///< a corner of the first of these triangles
};

/// Where to search for folds: beside new points, or in the whole common box of the operands. Where faces of
/// both operands lie on one plane, triangles may intersect without a new point, so CommonBox is necessary. It
/// costs an intersection test of all triangles in the box.
enum class SettleReach { NewPoints, CommonBox };

/// The surface of a Boolean without the folds caused by rounding its points. A new point lies within a
/// rounding of the planes that meet there. Where the planes are nearly parallel, it may still lie far along
/// them from their true common point: small triangles are then reversed and intersect their neighbours. Where
/// triangles beside new points intersect or have no area, sides of thin triangles are contracted, and their
/// long sides are exchanged for the other diagonal. Each change is made only if the surface moves by at most
/// 2^6 roundings of the largest coordinate along its normal. A triangle is thin if its height is at most 2^4
/// roundings; this limit grows to at most 2^34 (the length of a shift, see boolean.h) until no triangles
/// intersect. A surface without such defects is returned unchanged, to the last bit. Points of the operands
/// are kept in preference to new ones. The same result on any number of threads. Precondition: mesh_of()
/// accepts the triangles. Cost: n log n of the operands' points in their common box and of the triangles
/// beside new points, linear in all.
Settled settled(Triangles surface, const std::array<const Triangles*, 2>& operands,
                SettleReach reach = SettleReach::NewPoints);

}  // namespace octotomy::brep
