// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/result/report/scene_pictures.h"
#include "verify/certificate/certificate.h"

namespace octotomy::planner {

/// The voxel kernel's surface coloured by its distance outside (orange) or inside (blue) the mesh kernel's
/// surface, from four sides, with the distance at the ends of the colours.
struct DifferencePictures {
  PictureGroup group;
  double most_mm = 1.0;
};

/// Preconditions: neither answer is empty. The colours end at the largest distance of a voxel at the
/// boundary, at least half a voxel's diagonal. Cost: a search in the mesh for every voxel at the boundary; a
/// float for each voxel of the object's extents.
DifferencePictures difference_pictures(const verify::Contested& contested);

}  // namespace octotomy::planner
