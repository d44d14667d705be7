// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "tests/unit_universe.h"
#include "voxel/solid/combine.h"

namespace octotomy::tests {

/// A ball among 64 voxels of 1 mm a side about the origin.
inline voxel::Octree ball(const glm::dvec3& centre_mm, double radius_mm) {
  return voxel::combine(universe_about_origin(6), voxel::Expression(voxel::Sphere{centre_mm, radius_mm}));
}

}  // namespace octotomy::tests
