// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <utility>

#include "voxel/space/scene.h"

namespace octotomy::tests {

/// A CT scan along the axes. Its samples are value(voxel, p_mm), in HU; `first_mm` is the position of the
/// first sample.
template <typename Value>
voxel::Scene ct_scene(const glm::ivec3& dims, const glm::dvec3& spacing_mm, const glm::dvec3& first_mm,
                      const Value& value) {
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice(dims, spacing_mm, first_mm);
  scene.meaning = voxel::Meaning::Hounsfield;
  scene.modality = "CT";
  voxel::Int16Samples samples;
  for (int z = 0; z < dims.z; ++z)
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x)
        samples.push_back(
            static_cast<std::int16_t>(value(glm::ivec3(x, y, z), scene.lattice.lps_mm({x, y, z}))));
  scene.samples = std::move(samples);
  return scene;
}

}  // namespace octotomy::tests
