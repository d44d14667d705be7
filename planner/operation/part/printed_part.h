// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "brep/boolean/boolean.h"
#include "brep/shape/level_body.h"
#include "planner/operation/table/bench.h"
#include "planner/operation/table/operation.h"

// The last steps in making a printed part, in each kernel: rounding edges, keeping the largest piece, and
// rounding points as files store them.
namespace octotomy::planner {

/// The union of all balls of the radius that fit within a solid. It has rounded edges, and no walls thinner
/// than twice the radius. Cuts stay a tenth of the radius away from the balls, so that other surfaces do not
/// move. If the balls are narrower than voxels, the solid is returned unchanged.
voxel::Expression rounded(const voxel::Expression& solid, double radius_mm, const VoxelBench& bench);
/// Rounds a solid with balls as wide as the least wall, using only the largest connected piece of their
/// centres. Pieces that are connected only by a neck thinner than the least wall are thus cut off, too.
voxel::Expression thick_part(const voxel::Expression& solid, double least_wall_mm, const VoxelBench& bench);

/// Stores the largest piece of a solid in `made`. The voxels of the other pieces are subtracted.
void keep_largest(const voxel::Expression& solid, const VoxelBench& bench, VoxelSide& made);
/// The largest piece of a solid. Adds a finding on the pieces that are left out to `made`.
brep::Solid largest_piece(const brep::Solid& solid, const std::string& part, MeshSide& made);
/// The largest piece of a solid, with points rounded to single precision as files for printers store them,
/// and without intersecting triangles. Findings in `made` list the parts that are left out and the steps that
/// failed.
brep::Solid printed(const brep::Solid& solid, const std::string& part, MeshSide& made);

struct ThickPart {
  double least_wall_mm = 0.8;
  double cell_mm = 0.8;  ///< cell of the mesh's level sets; flat parts lie within an eighth of a cell
  /// Levels of the body's `without`, such as holes for drills, whose surface must lie within a thousandth of
  /// a cell. Other surfaces follow the triangles of the balls' centres, which would narrow a hole by up to a
  /// 16th of a cell.
  std::vector<brep::Level> holes = {};
};
/// The mesh of a body without walls and necks thinner than the least wall: the union of balls of that width
/// within the body whose centres are connected. Its edges are rounded. If a neck is thinner than 0.6 mm and
/// than 0.8 of the least wall, a ball that leaves a cleft of 0.6 mm is cut out of the neck. Keeps the largest
/// piece and rounds points, as printed(). `made` lists the volume that is cut off with thin walls, and the
/// necks. Throws as brep::core_of() and brep::boolean().
brep::Solid thick_part(const brep::LevelBody& body, const ThickPart& asked, const std::string& part,
                       const MeshBench& bench, MeshSide& made);
/// The mean distance in mm of the triangles from the body's surface, over smooth parts.
double thick_part_allowance_mm(const ThickPart& asked);

/// The field "least_wall_mm" of an operation.
template <typename Part>
Field least_wall(double Part::*least_wall_mm) {
  return field("least_wall_mm", least_wall_mm,
               "Thinner walls are cut off, and edges are rounded by half of this. Printers can make walls "
               "from 0.6 on, so 0.8 leaves a reserve of 0.2.")
      .from(0.3)
      .to(3.0);
}
/// Refuses a least wall above 0.9 of a wall's thickness. `wall` is the name of the field with that thickness.
void check_least_wall(double least_wall_mm, double wall_mm, const char* wall, const FieldLocation& place);

/// The solid in a Boolean's result. Adds the result's findings and shift to `made`.
brep::Solid noted(const brep::BooleanResult& result, MeshSide& made);

}  // namespace octotomy::planner
