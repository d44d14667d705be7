// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <variant>

#include "tests/bench/picture_plane.h"
#include "voxel/space/scene.h"

namespace octotomy::bench {

/// A scan in the form that peers read. Its samples are not copied. Precondition: 16 bits a sample, on an
/// axis-aligned lattice.
inline FlatScan flat_scan(const voxel::Scene& scene) {
  FlatScan scan;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int i = static_cast<int>(axis);
    scan.dims[axis] = scene.lattice.dims[i];
    scan.spacing_mm[axis] = scene.lattice.spacing_mm()[i];
    scan.first_mm[axis] = scene.lattice.lps_mm(glm::dvec3(0.0))[i];
  }
  scan.samples = std::get<voxel::Int16Samples>(scene.samples).data();
  return scan;
}

}  // namespace octotomy::bench
