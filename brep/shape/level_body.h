// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "brep/mesh/solid.h"
#include "brep/shape/offset.h"

// Bodies composed of moved surfaces, from the distances to these, without Booleans of
// triangles.
namespace octotomy::brep {

/// The points within by_mm of a solid; for by_mm below 0 those deeper than that within it.
struct Level {
  Solid solid;  ///< not empty
  double by_mm = 0.0;
};

/// The union of parts, each the intersection of its levels, less other levels.
struct LevelBody {
  std::vector<std::vector<Level>> parts;
  std::vector<Level> without;
};

/// The points of a body that a ball of a radius within one of its parts, and outside all of `without`, can reach
/// the middle of: -options.by_mm is the radius, at least 0. Grown by the radius, which offset() does, it is what
/// such balls hold, so that every wall of it is at least as thick as a ball. Balls that only fit into several
/// parts together do not count. Guarantees as offset(): walls thinner than a cell may be missed, edges that are
/// sharp are cut off within a quarter of a cell, and no triangles intersect. Throws as offset(), also
/// std::invalid_argument if by_mm is above 0, there is no part, or a part or a level is empty. Cost: as offset(),
/// with a distance to each level that lies near.
Solid core_of(const LevelBody& body, const OffsetOptions& options);

/// The volume of the body's points that lie further than `beyond_mm` outside a solid, from samples in the middles
/// of cubes of `step_mm`: good to about a cube for each place where there are any. Cost: grows with the body's
/// surface, and a distance to each level for each cube.
double volume_beyond_mm3(const LevelBody& body, const Solid& solid, double beyond_mm, double step_mm);

}  // namespace octotomy::brep
