// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cmath>
#include <glm/glm.hpp>

#include "tests/planner/ct_scene.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/scan/write_scene.h"
#include "voxel/space/scene.h"

namespace octotomy::tests {

/// A scan of a ball about (0, 0, 0): 1000 inside, -1000 outside, in between by the part of a voxel that a
/// flat boundary fills, so that a window from 0 is the ball. Voxels of 1 mm, `side` a side.
inline voxel::Scene ball_scene(double radius_mm, int side = 64) {
  const double first_mm = -0.5 * (side - 1);
  voxel::Scene scene = ct_scene(glm::ivec3(side), glm::dvec3(1.0), glm::dvec3(first_mm),
                                [&](const glm::ivec3& at, const glm::dvec3& /*p_mm*/) {
                                  const double depth_mm = radius_mm - glm::length(first_mm + glm::dvec3(at));
                                  return std::lround(2000.0 * std::clamp(depth_mm, -0.5, 0.5));
                                });
  scene.source = "ball";
  return scene;
}

inline double ball_mm3(double radius_mm) {
  return 4.0 / 3.0 * M_PI * radius_mm * radius_mm * radius_mm;
}

/// Volume of the part of a ball beyond a plane at `distance_mm` from its centre.
inline double cap_mm3(double radius_mm, double distance_mm) {
  const double height_mm = radius_mm - distance_mm;
  return M_PI * height_mm * height_mm * (3.0 * radius_mm - height_mm) / 3.0;
}

}  // namespace octotomy::tests
