// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "brep/mesh/solid.h"
#include "brep/shape/offset.h"

// Bodies composed of moved surfaces. They are computed from distances to the surfaces, without Booleans of
// triangles.
namespace octotomy::brep {

/// The points within by_mm of a solid or, if by_mm is negative, the points deeper than |by_mm| inside it.
struct Level {
  Solid solid;  ///< not empty
  double by_mm = 0.0;
};

/// The union of parts minus other levels; each part is the intersection of its levels.
struct LevelBody {
  std::vector<std::vector<Level>> parts;
  std::vector<Level> without;
};

/// The possible centres of balls that lie within one of the body's parts and outside all of `without`;
/// -options.by_mm is their radius, at least 0. offset() of the result by the radius gives the volume that
/// such balls fill, so every wall of that volume is at least as thick as a ball. Balls that fit only into
/// several parts together do not count. Guarantees as offset(): walls thinner than a cell may be missed,
/// sharp edges are cut off within a quarter of a cell, and no triangles intersect. Throws as offset(), also
/// std::invalid_argument if by_mm is above 0, there is no part, or a part or a level is empty. Cost: as
/// offset(), with a distance to each level nearby.
Solid core_of(const LevelBody& body, const OffsetOptions& options);

/// The volume of the body's points that lie more than `beyond_mm` outside a solid. Computed from samples in
/// the middles of cubes of `step_mm`; the error is about one cube for each place with such points. Cost:
/// grows with the body's surface; one distance to each level for each cube.
double volume_beyond_mm3(const LevelBody& body, const Solid& solid, double beyond_mm, double step_mm);

}  // namespace octotomy::brep
