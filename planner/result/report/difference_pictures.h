// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/result/report/scene_pictures.h"
#include "verify/certificate/certificate.h"

namespace octotomy::planner {

/// Pictures of the voxel kernel's surface from four sides. Colours show its distance to the mesh kernel's
/// surface: orange outside, blue inside. `most_mm` is the distance at the ends of the colours.
struct DifferencePictures {
  PictureGroup group;
  double most_mm = 1.0;
};

/// Draws the difference of both answers, neither of which may be empty. The ends of the colours are the
/// largest distance of a voxel at the boundary, but at least half a voxel's diagonal. Cost: a search in the
/// mesh for each voxel at the boundary. Memory: a float for each voxel of the object's box.
DifferencePictures difference_pictures(const verify::Contested& contested);

}  // namespace octotomy::planner
