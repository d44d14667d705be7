// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "brep/boolean/boolean.h"
#include "brep/shape/level_body.h"
#include "planner/operation/table/bench.h"
#include "planner/operation/table/operation.h"

// The last steps of a printed part, in each kernel: rounding edges, keeping the largest piece, and rounding
// points as files store them.
namespace octotomy::planner {

/// The union of all balls of the radius that fit within a solid: edges are rounded, and walls thinner than
/// twice the radius are cut off. Cuts keep a tenth of the radius away from those balls, so that other
/// surfaces do not move. If the balls are narrower than voxels, they are not resolved, and the solid is
/// returned unchanged.
voxel::Expression rounded(const voxel::Expression& solid, double radius_mm, const VoxelBench& bench);
/// rounded() with balls as wide as the least wall, about the largest connected piece of their middles: pieces
/// that are connected only by a neck thinner than the least wall are cut off, too.
voxel::Expression thick_part(const voxel::Expression& solid, double least_wall_mm, const VoxelBench& bench);

/// Keeps the largest piece. The voxels of the other pieces are subtracted.
void keep_largest(const voxel::Expression& solid, const VoxelBench& bench, VoxelSide& made);
/// The largest piece. A finding in `made` lists the pieces that are left out.
brep::Solid largest_piece(const brep::Solid& solid, const std::string& part, MeshSide& made);
/// The largest piece, with points rounded to single precision as in files for printers, and still without
/// intersecting triangles. Findings in `made` list the parts left out and the steps that failed.
brep::Solid printed(const brep::Solid& solid, const std::string& part, MeshSide& made);

struct ThickPart {
  double least_wall_mm = 0.8;
  double cell_mm = 0.8;  ///< of the mesh's level sets; flat parts lie within an eighth of it
  /// Levels of the body's `without`, such as drills' holes, whose surface points lie within a thousandth of a
  /// cell. Other surfaces follow the triangles of the balls' middles, which narrow a hole by up to a 16th of
  /// a cell.
  std::vector<brep::Level> holes = {};
};
/// The mesh of a body without walls and necks thinner than the least wall: the union of balls of that width
/// within the body whose middles are connected, so edges are rounded. Where two sides overlap in a neck
/// thinner than 0.6 mm and than 0.8 of the least wall, a ball that leaves a cleft of 0.6 mm is cut out
/// between them. Keeps the largest piece, as printed(). `made` lists the volume that is cut off with thin
/// walls, and the necks. Throws as brep::core_of() and brep::boolean().
brep::Solid thick_part(const brep::LevelBody& body, const ThickPart& asked, const std::string& part,
                       const MeshBench& bench, MeshSide& made);
/// The mean distance of the triangles from the body's surface, over smooth parts.
double thick_part_allowance_mm(const ThickPart& asked);

/// The field "least_wall_mm" of an operation.
template <typename Part>
Field least_wall(double Part::*least_wall_mm) {
  return field(
             "least_wall_mm", least_wall_mm,
             "Thinner walls are cut off, and edges are rounded by half of this. Printers make walls from 0.6 "
             "on, and 0.8 keeps 0.2 in reserve.")
      .from(0.3)
      .to(3.0);
}
/// Refuses a least wall that is more than 0.9 of a wall's thickness.
void check_least_wall(double least_wall_mm, double wall_mm, const char* wall, const FieldLocation& place);

/// The solid that a Boolean returned; adds the Boolean's findings and shift to `made`.
brep::Solid noted(const brep::BooleanResult& result, MeshSide& made);

}  // namespace octotomy::planner
