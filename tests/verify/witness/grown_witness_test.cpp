// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/witness/grown_witness.h"

#include <gtest/gtest.h>
#include <stdexcept>
#include <utility>

namespace octotomy::verify {
namespace {

/// Two cubes of 4^3 samples of 100 in 12^3 samples of 0, which meet at a corner alone; samples 2 mm apart.
voxel::Scene two_cubes() {
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice(glm::ivec3(12), glm::dvec3(2.0), glm::dvec3(0.0));
  voxel::Int16Samples samples(scene.lattice.sample_count());
  for (int z = 0; z < 4; ++z)
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 4; ++x) {
        const auto at = [&](int first) {
          return static_cast<std::size_t>(x + first + 12 * (y + first + 12 * (z + first)));
        };
        samples[at(1)] = samples[at(5)] = 100;
      }
  scene.samples = std::move(samples);
  return scene;
}

glm::dvec3 sample_mm(const voxel::Scene& scene, int number) {
  return scene.lattice.lps_mm(glm::dvec3(number));
}

TEST(GrownWitness, FacesDoNotJoinCubesThatMeetAtACornerAndCornersDo) {
  const voxel::Scene scene = two_cubes();
  for (const int neighbours : {6, 18, 26}) {
    const Witness witness = witness_of_grown(
        scene, {.seeds_mm = {sample_mm(scene, 2)}, .tolerance = 10.0, .neighbours = neighbours});
    EXPECT_EQ(witness.allowed_sides(sample_mm(scene, 4)).voxel, certainly_in) << neighbours;
    EXPECT_EQ(witness.allowed_sides(sample_mm(scene, 5)).voxel,
              neighbours == 26 ? certainly_in : certainly_out)
        << neighbours;
    EXPECT_EQ(witness.allowed_sides(sample_mm(scene, 0)).voxel, certainly_out) << neighbours;
  }
}

TEST(GrownWitness, AWindowsPartIsTheOneAtTheSeed) {
  const voxel::Scene scene = two_cubes();
  const Witness witness =
      witness_of_grown(scene, {.seeds_mm = {sample_mm(scene, 7)}, .tolerance = {}, .low = 50.0});
  EXPECT_EQ(witness.allowed_sides(sample_mm(scene, 8)).voxel, certainly_in);
  EXPECT_EQ(witness.allowed_sides(sample_mm(scene, 4)).voxel, certainly_out);
}

TEST(GrownWitness, TheRangeOfTheSeedsIsWidenedAtBothEnds) {
  const voxel::Scene scene = two_cubes();
  // Seeds of 0 and 100 hold every sample between them.
  const Witness all =
      witness_of_grown(scene, {.seeds_mm = {sample_mm(scene, 0), sample_mm(scene, 2)}, .tolerance = 0.0});
  for (const int sample : {0, 2, 5, 11})
    EXPECT_EQ(all.allowed_sides(sample_mm(scene, sample)).voxel, certainly_in) << sample;
  EXPECT_EQ(all.allowed_sides(glm::dvec3(-1.5)).voxel, certainly_out) << "beyond the scan";
  const Witness wide = witness_of_grown(scene, {.seeds_mm = {sample_mm(scene, 2)}, .tolerance = 100.0});
  EXPECT_EQ(wide.allowed_sides(sample_mm(scene, 11)).voxel, certainly_in);
  const Witness narrow = witness_of_grown(scene, {.seeds_mm = {sample_mm(scene, 2)}, .tolerance = 99.0});
  EXPECT_EQ(narrow.allowed_sides(sample_mm(scene, 11)).voxel, certainly_out);
}

TEST(GrownWitness, SamplesWithinRoundingOfABoundMayBelongOrNot) {
  const voxel::Scene scene = two_cubes();
  const Witness witness = witness_of_grown(
      scene, {.seeds_mm = {sample_mm(scene, 2)}, .tolerance = {}, .low = 100.0, .rounding = 0.5});
  EXPECT_EQ(witness.allowed_sides(sample_mm(scene, 2)).voxel, either_side);
  EXPECT_EQ(witness.allowed_sides(sample_mm(scene, 0)).voxel, certainly_out);
}

TEST(GrownWitness, ARunningMeanFollowsARampThatTheSeedAloneDoesNot) {
  voxel::Scene scene = two_cubes();
  auto& samples = std::get<voxel::Int16Samples>(scene.samples);
  // A ramp of 10 along x, and a step of 100 at x = 8.
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples[i] = static_cast<std::int16_t>(10 * (i % 12) + (i % 12 >= 8 ? 100 : 0));
  const auto along = [&](const GrownFrom& from) {
    const Witness witness = witness_of_grown(scene, from);
    std::string sides;
    for (int x = 0; x < 12; ++x) {
      const AllowedSides side = witness.allowed_sides(scene.lattice.lps_mm({x, 5, 5})).voxel;
      sides += side == certainly_in ? 'i' : side == certainly_out ? 'o' : '?';
    }
    return sides;
  };
  const GrownFrom fixed{.seeds_mm = {scene.lattice.lps_mm({0, 5, 5})}, .tolerance = 45.0};
  EXPECT_EQ(along(fixed), "iiiiiooooooo");
  GrownFrom running = fixed;
  running.mean_of_steps = 1.0;
  EXPECT_EQ(along(running), "iiiiiiiioooo");
}

TEST(GrownWitness, BetweenSamplesThatDifferTheSideIsUnknown) {
  const voxel::Scene scene = two_cubes();
  const Witness witness = witness_of_grown(scene, {.seeds_mm = {sample_mm(scene, 2)}, .tolerance = 10.0});
  EXPECT_EQ(witness.allowed_sides(scene.lattice.lps_mm({0.5, 2.0, 2.0})).voxel, either_side);
  EXPECT_EQ(witness.allowed_sides(scene.lattice.lps_mm({2.5, 2.5, 2.5})).voxel, certainly_in);
}

TEST(GrownWitness, SeedsBeyondTheScanAreRefused) {
  const voxel::Scene scene = two_cubes();
  EXPECT_THROW(witness_of_grown(scene, {}), std::invalid_argument);
  EXPECT_THROW(witness_of_grown(scene, {.seeds_mm = {glm::dvec3(-20.0)}}), std::invalid_argument);
  EXPECT_THROW(witness_of_grown(scene, {.seeds_mm = {glm::dvec3(2.0)}, .neighbours = 4}),
               std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::verify
