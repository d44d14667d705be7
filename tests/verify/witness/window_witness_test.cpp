// SPDX-License-Identifier: AGPL-3.0-or-later
// The witness of a window has nothing against either kernel's own answer, whatever the samples.
#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <utility>

#include "brep/mesh/solid.h"
#include "convert/surface/isosurface.h"
#include "convert/voxel/voxelise.h"
#include "verify/witness/witness.h"

namespace octotomy::verify {
namespace {

/// Samples of some coarse noise, so that levels are crossed one and several at a time, and at the border.
std::shared_ptr<const voxel::Scene> noise(unsigned seed, int range, std::optional<double> padding) {
  std::mt19937 random(seed);
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice({12, 11, 13}, {1.0, 1.2, 0.9}, {2.3, 2.1, 2.4});
  voxel::Int16Samples samples;
  for (std::size_t i = 0; i < scene.lattice.sample_count(); ++i) {
    const bool is_padding = padding && random() % 8 == 0;
    samples.push_back(is_padding ? static_cast<std::int16_t>(*padding)
                                 : static_cast<std::int16_t>(random() % static_cast<unsigned>(range)));
  }
  scene.samples = std::move(samples);
  scene.padding = padding;
  return std::make_shared<const voxel::Scene>(std::move(scene));
}

/// Points at which the mesh of a window, or of `subject`, contradicts the window's witness: centres of its
/// triangles without a surface near, and voxels' centres on the wrong side.
struct Contradictions {
  std::size_t triangles = 0, voxels = 0, sure = 0;
};
Contradictions contradictions(const std::shared_ptr<const voxel::Scene>& scan, double low, double high,
                              const voxel::Scene& subject) {
  voxel::Universe universe;
  universe.depth = 6;
  universe.lps_from_voxel[0][0] = universe.lps_from_voxel[1][1] = universe.lps_from_voxel[2][2] = 0.31;
  const Witness witness = witness_of_window(scan, low, high, universe);
  const brep::Triangles mesh = convert::isosurface(subject, low, high);
  Contradictions found;
  for (const auto& [a, b, c] : mesh.faces)
    found.triangles +=
        witness.mesh_sides((mesh.points_mm[a] + mesh.points_mm[b] + mesh.points_mm[c]) / 3.0).near ? 0 : 1;
  const voxel::Octree inside =
      convert::voxelise(universe, brep::trusted_solid(mesh, brep::Proof::Construction).linked());
  for (int z = 0; z < 64; ++z)
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        const AllowedSides allowed = witness.mesh_sides(universe.lattice().lps_mm({x, y, z}));
        found.sure += allowed == certainly_in ? 1 : 0;
        found.voxels += allowed.allows(inside.contains({x, y, z})) ? 0 : 1;
      }
  return found;
}

TEST(WindowWitness, AllowsTheMeshOfAWindowWithSamplesOnEitherSide) {
  std::size_t sure = 0;
  for (unsigned seed = 1; seed <= 6; ++seed)
    for (const std::optional<double> padding : {std::optional<double>(), std::optional(-3000.0)}) {
      const auto scan = noise(seed, 40 << seed, padding);
      const int middle = 20 << seed;
      const Contradictions found = contradictions(scan, 0.6 * middle, 1.3 * middle, *scan);
      EXPECT_EQ(found.triangles, 0U) << "seed " << seed << (padding ? ", with padding" : "");
      EXPECT_EQ(found.voxels, 0U) << "seed " << seed << (padding ? ", with padding" : "");
      sure += found.sure;
    }
  EXPECT_GT(sure, 100U);
}

TEST(WindowWitness, SeesAMeshOfAnotherWindow) {
  const auto scan = noise(3, 320, std::nullopt);
  voxel::Scene other = *scan;
  for (std::int16_t& sample : std::get<voxel::Int16Samples>(other.samples))
    sample = static_cast<std::int16_t>(sample + 60);
  const Contradictions found = contradictions(scan, 96.0, 208.0, other);
  EXPECT_GT(found.triangles, 100U);
  EXPECT_GT(found.voxels, 100U);
}

}  // namespace
}  // namespace octotomy::verify
