// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/solid.h"
#include "planner/operation/table/bench.h"

// Walls of a part that a printer cannot make.
namespace octotomy::planner {

/// Takes the walls thinner than a length out of a part's mesh: where it has any, only what balls somewhat wider
/// than that hold is left, and nothing changes elsewhere. Walls are what `printable` counts as such: two sides
/// that converge by at most 30 degrees. They are looked for at places on each triangle that are about that
/// length apart. A finding of `made` says where walls stay, after three rounds. Throws as
/// brep::offset() and brep::boolean(); Stopped. Cost: about log n a triangle, and offsets of the parts about
/// such walls.
brep::Solid without_thin_walls(const brep::Solid& solid, double least_mm, const MeshBench& bench,
                               MeshSide& made);

/// The same in voxels of the whole part: what balls of that width hold. Voxels that cannot resolve such balls
/// show no such walls, and then the part stays as it is.
voxel::Expression without_thin_walls(const voxel::Expression& solid, double least_mm,
                                     const VoxelBench& bench);

}  // namespace octotomy::planner
