// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/phantom/leg_phantom.h"

#include <cmath>
#include <gtest/gtest.h>

#include "verify/phantom/sample_volume.h"

namespace octotomy::verify {
namespace {

/// The volume of bone in a stretch of the shaft, as samples share voxels between bone and soft tissue.
double bone_mm3(const voxel::Scene& scene, double from_mm, double to_mm) {
  const LegFibula fibula;
  const HeadTissues tissues;
  const auto& samples = std::get<voxel::Int16Samples>(scene.samples);
  double sum = 0.0;
  std::size_t index = 0;
  for (int z = 0; z < scene.lattice.dims.z; ++z)
    for (int y = 0; y < scene.lattice.dims.y; ++y)
      for (int x = 0; x < scene.lattice.dims.x; ++x, ++index) {
        const glm::dvec3 p = scene.lattice.lps_mm({x, y, z}) - fibula.from_mm;
        const double at_mm = glm::dot(p, fibula.along());
        if (at_mm < from_mm || at_mm > to_mm || glm::length(p - at_mm * fibula.along()) > 12.0) continue;
        sum += (samples[index] - tissues.soft) / (tissues.bone - tissues.soft);
      }
  return sum * scene.lattice.voxel_mm3();
}

TEST(LegPhantom, AStretchOfTheFibulaHasTheVolumeOfItsClosedForm) {
  const voxel::Scene scene = leg_phantom();
  const LegFibula fibula;
  EXPECT_NEAR(bone_mm3(scene, 40, 160) / (120.0 * fibula.section_mm2()), 1.0, 0.01);
  EXPECT_GT(std::abs(bone_mm3(scene, 40, 160) / (123.0 * fibula.section_mm2()) - 1.0), 0.01)
      << "three millimetres more would be seen";
}

TEST(LegPhantom, TheShaftsPredicateIsTheSameClosedForm) {
  const LegFibula fibula;
  const SampledVolume sampled = sample_volume({{15, 0, -110}, {48, 30, 110}}, 0.5, in_fibula_shaft);
  EXPECT_NEAR(sampled.volume_mm3, fibula.section_mm2() * fibula.length_mm(),
              5.0 * sampled.standard_error_mm3);
}

TEST(LegPhantom, NoiseFollowsItsSeedAndOptionsHaveRanges) {
  LegOptions options;
  options.voxel_mm = 4.0;
  options.noise_sigma_hu = 20.0;
  const auto samples = [&] { return std::get<voxel::Int16Samples>(leg_phantom(options).samples); };
  const auto first = samples();
  EXPECT_EQ(first, samples());
  options.seed = 2;
  EXPECT_NE(first, samples());
  options.voxel_mm = 0.0;
  EXPECT_THROW(leg_phantom(options), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::verify
