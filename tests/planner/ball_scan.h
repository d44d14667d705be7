// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cmath>
#include <glm/glm.hpp>

#include "tests/voxel/scratch_folder.h"
#include "voxel/scan/write_scene.h"
#include "voxel/space/scene.h"

namespace octotomy::tests {

/// A scan of a ball about (0, 0, 0): 1000 inside, -1000 outside, in between by the part of a voxel that a
/// flat boundary fills, so that a window from 0 is the ball. Voxels of 1 mm, `side` a side.
inline voxel::Scene ball_scene(double radius_mm, int side = 64) {
  voxel::Scene scene;
  const double first_mm = -0.5 * (side - 1);
  scene.lattice = voxel::axis_aligned_lattice(glm::ivec3(side), glm::dvec3(1.0), glm::dvec3(first_mm));
  voxel::Int16Samples samples;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double depth_mm = radius_mm - glm::length(first_mm + glm::dvec3(x, y, z));
        samples.push_back(static_cast<std::int16_t>(std::lround(2000.0 * std::clamp(depth_mm, -0.5, 0.5))));
      }
  scene.samples = std::move(samples);
  scene.meaning = voxel::Meaning::Hounsfield;
  scene.modality = "CT";
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
