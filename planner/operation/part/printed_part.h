// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "brep/boolean/boolean.h"
#include "planner/operation/table/bench.h"

// The last steps of a printed part, in each kernel: rounded edges, the largest piece, points that files hold.
namespace octotomy::planner {

/// What balls of the radius within a solid hold: edges are rounded, and walls thinner than twice the radius are
/// cut off. Cuts stand off those balls by a tenth of the radius, so that the other surfaces do not move.
voxel::Expression rounded(const voxel::Expression& solid, double radius_mm, const VoxelBench& bench);
struct MeshRounding {
  double radius_mm = 1.0;
  /// Cell size of the mesh's offsets, at most the radius. Flat parts lie within a 16th of it, which must be
  /// less than the distance of the cuts from the balls.
  double cell_mm = 1.0;
};
/// The same of a mesh. Empty if no ball fits. Throws as brep::offset() and brep::boolean().
brep::Solid rounded(const brep::Solid& solid, const MeshRounding& rounding, const MeshBench& bench,
                    MeshSide& made);

/// Keeps the largest piece. What is not of it is taken away with a voxel around it.
void keep_largest(const voxel::Expression& solid, const VoxelBench& bench, VoxelSide& made);
/// The largest piece; a finding of `made` lists what is left out.
brep::Solid largest_piece(const brep::Solid& solid, const std::string& part, MeshSide& made);
/// The largest piece, with points of single precision, as files for printers have them, and still without
/// triangles that intersect. Findings of `made` list what is left out and what could not be done.
brep::Solid printed(const brep::Solid& solid, const std::string& part, MeshSide& made);

/// The solid of a Boolean; `made` keeps its findings and shift.
brep::Solid noted(const brep::BooleanResult& result, MeshSide& made);

}  // namespace octotomy::planner
