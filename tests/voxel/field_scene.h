// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cmath>
#include <type_traits>

#include "voxel/space/scene.h"

namespace octotomy::tests {

/// A scene whose samples are the values of a function of millimetres on a lattice: floats unchanged, int16
/// rounded.
template <typename Sample, typename Field>
voxel::Scene field_scene(const voxel::Lattice& lattice, const Field& field) {
  voxel::Scene scene;
  scene.lattice = lattice;
  scene.meaning = voxel::Meaning::Hounsfield;
  scene.source = "field";
  voxel::Samples<Sample> samples;
  samples.reserve(lattice.sample_count());
  for (int z = 0; z < lattice.dims.z; ++z)
    for (int y = 0; y < lattice.dims.y; ++y)
      for (int x = 0; x < lattice.dims.x; ++x) {
        const double value = field(lattice.lps_mm({x, y, z}));
        samples.push_back(static_cast<Sample>(std::is_integral_v<Sample> ? std::round(value) : value));
      }
  scene.samples = std::move(samples);
  return scene;
}

/// The sample at an index.
inline double sample_at(const voxel::Scene& scene, const glm::ivec3& p) {
  const glm::ivec3 dims = scene.lattice.dims;
  const auto at =
      (static_cast<std::size_t>(p.z) * static_cast<std::size_t>(dims.y) + static_cast<std::size_t>(p.y)) *
          static_cast<std::size_t>(dims.x) +
      static_cast<std::size_t>(p.x);
  return std::visit([&](const auto& samples) { return static_cast<double>(samples[at]); }, scene.samples);
}

/// Calls `visit` for every index at least `margin` from the faces.
template <typename Visit>
void for_each_index(const voxel::Lattice& lattice, int margin, const Visit& visit) {
  for (int z = margin; z < lattice.dims.z - margin; ++z)
    for (int y = margin; y < lattice.dims.y - margin; ++y)
      for (int x = margin; x < lattice.dims.x - margin; ++x) visit(glm::ivec3(x, y, z));
}

}  // namespace octotomy::tests
