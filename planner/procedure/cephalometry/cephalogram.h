// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "planner/operation/anatomy/movement.h"
#include "planner/procedure/cephalometry/definition.h"
#include "voxel/space/progress.h"
#include "voxel/tree/grey_octree.h"

namespace octotomy::planner {

struct Cephalogram {
  glm::ivec2 size_px{0};
  std::vector<std::uint8_t> rgb;
  double pixel_mm = 0.0;
};

/// Draws the patient's radiograph as seen from the right, so that the face is at the right, in true scale and
/// in the head's orientation. Adds the landmarks and lines of the lateral measures: pale blue as scanned and,
/// if different, orange as planned. The picture is a square around the landmarks with a margin of 25 mm,
/// `size_px` pixels along each side. Throws Stopped. Cost: at most one ray per pixel. Rays are at least half
/// a voxel apart, but at least 64 along each side if `size_px` allows it.
Cephalogram draw_cephalogram(const voxel::GreyOctree& grey, const Cephalometry& definitions,
                             const std::vector<MovedLandmark>& landmarks, const glm::dmat3& lps_from_head,
                             int size_px, const voxel::Progress& progress = {});

}  // namespace octotomy::planner
