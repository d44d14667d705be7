// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "voxel/solid/expression.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

struct ShadowOptions {
  glm::dvec3 direction{0.0, 1.0, 0.0};  ///< unit vector, LPS: the direction in which a part is put on
  double end_mm = 0.0;                  ///< position along `direction` of the plane at which the shadow ends
  Progress progress = {};
};

struct Shadow {
  /// Each sample is the share of a voxel in the shadow minus one half, so that the window can be combined,
  /// moved and sampled between voxels.
  Window window;
  /// The surface's farthest position along `direction`, computed from the object's voxels.
  double far_end_mm = 0.0;
};

/// The points of an object and all points behind it as seen along a direction, up to a plane across that
/// direction: an object that moves along the direction from outside cannot reach them. `octree` holds the
/// object's voxels, and `solid` decides where its surface crosses the lines between neighbouring voxels'
/// centres. The object ends at the universe's border, and so does the shadow.
///
/// Columns run along the direction, a fifth of the smallest voxel edge apart. A column begins where it first
/// meets a surface through those crossings (SurfaceCrossings). Beside an outline, where the triangles cut
/// edges off, a column begins at the solid itself. A voxel's share is counted at 5^3 points in the voxel,
/// each in the nearest column. The shadow's side walls therefore deviate at random by up to 0.15 of a voxel
/// edge, and on average by 0. A voxel belongs to the shadow if its centre does, also behind a tip that is
/// narrower than a voxel. Walls thinner than half a voxel along the direction may contain no voxel.
///
/// Throws std::invalid_argument if the direction is not a unit vector, the end is not finite or the octree
/// is empty; Stopped. Parallel; same bits on any thread count. Cost: that of the crossings, and 125 look-ups
/// for each voxel at the shadow's boundary. Memory: 8 bytes a column, and 2 bytes for each voxel in the
/// blocks of 16 voxels a side that contain a part of the shadow.
Shadow shadow(const Octree& octree, const Expression& solid, const ShadowOptions& options);

/// The farthest position of the object's surface along a unit direction, computed from the object's voxels.
/// Throws as shadow() does. Cost: that of the crossings.
double far_end_mm(const Octree& octree, const Expression& solid, const glm::dvec3& direction);

/// For each of the unit directions, the volume that shadow() adds to the object up to the object's far end:
/// the volume of the columns minus that of the object's voxels. Accurate to the columns' noise and to half a
/// voxel edge at the object's far end. Throws as shadow() does. Parallel; same bits on any thread count.
/// Cost: that of the crossings once, and of the columns for each direction.
std::vector<double> filled_mm3(const Octree& octree, const Expression& solid,
                               const std::vector<glm::dvec3>& directions, const Progress& progress = {});

}  // namespace octotomy::voxel
