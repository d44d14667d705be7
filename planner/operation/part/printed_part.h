// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "brep/boolean/boolean.h"
#include "brep/shape/level_body.h"
#include "planner/operation/table/bench.h"
#include "planner/operation/table/operation.h"

// The last steps of a printed part, in each kernel: rounded edges, the largest piece, points that files hold.
namespace octotomy::planner {

/// What balls of the radius within a solid hold: edges are rounded, and walls thinner than twice the radius are
/// cut off. Cuts stand off those balls by a tenth of the radius, so that the other surfaces do not move.
/// Voxels wider than the balls do not resolve them: then the solid is returned as it is.
voxel::Expression rounded(const voxel::Expression& solid, double radius_mm, const VoxelBench& bench);

/// Keeps the largest piece. What is not of it is taken away with a voxel around it.
void keep_largest(const voxel::Expression& solid, const VoxelBench& bench, VoxelSide& made);
/// The largest piece; a finding of `made` lists what is left out.
brep::Solid largest_piece(const brep::Solid& solid, const std::string& part, MeshSide& made);
/// The largest piece, with points of single precision, as files for printers have them, and still without
/// triangles that intersect. Findings of `made` list what is left out and what could not be done.
brep::Solid printed(const brep::Solid& solid, const std::string& part, MeshSide& made);

struct ThickPart {
  double least_wall_mm = 0.8;
  double cell_mm = 0.8;  ///< of the mesh's level sets; flat parts lie within an eighth of it
};
/// The mesh of a body without walls thinner than asked: what balls of that width hold, so that edges are
/// rounded. The largest piece, as printed(). `made` lists the volume that is cut off with thin walls. Throws as
/// brep::core_of().
brep::Solid thick_part(const brep::LevelBody& body, const ThickPart& asked, const std::string& part,
                       const MeshBench& bench, MeshSide& made);
/// How far its triangles lie from the body's surface on the mean over smooth parts.
double thick_part_allowance_mm(const ThickPart& asked);

/// The field of the least wall.
template <typename Part>
Field least_wall(double Part::*least_wall_mm) {
  return field(
             "least_wall_mm", least_wall_mm,
             "Thinner walls are cut off, and edges are rounded by half of this. Printers make walls from 0.6 "
             "on; the default is a project's choice.")
      .from(0.3)
      .to(3.0);
}
/// Refuses a least wall that is more than 0.9 of a wall's thickness.
void check_least_wall(double least_wall_mm, double wall_mm, const char* wall, const FieldLocation& place);

/// The solid of a Boolean; `made` keeps its findings and shift.
brep::Solid noted(const brep::BooleanResult& result, MeshSide& made);

}  // namespace octotomy::planner
