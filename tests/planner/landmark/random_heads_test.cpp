// SPDX-License-Identifier: AGPL-3.0-or-later
#include <array>
#include <cstdio>
#include <gtest/gtest.h>

#include "convert/surface/isosurface.h"
#include "planner/landmark/first_guess.h"
#include "planner/table/plan_universe.h"
#include "verify/random_head.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

using verify::HeadKind;
using verify::RandomHead;

SkullGuess guess_on(const RandomHead& head) {
  const voxel::Scene scene = head.scan();
  const double level = head.half_level_hu(), high = std::numeric_limits<double>::infinity();
  const voxel::GreyOctree grey = voxel::grey_octree_of(universe_of(scene.lattice, std::nullopt), scene);
  voxel::DrawnObject bone{
      "bone", voxel::combine(grey.universe(), voxel::Expression(voxel::Window{grey, level, high}))};
  bone.grey = grey;
  bone.threshold = level;
  return guess_landmarks(bone, brep::mesh_of(convert::isosurface(grey, level, high)));
}

// What even a sharp rule misses is added by the operation, by name; two millimetres are the mean of it.
constexpr double least_mm = 2.0;

/// Of one head: points found, and those among them beyond their interval. Prints each of these.
std::pair<int, int> counted(HeadKind kind, std::uint64_t seed) {
  const RandomHead head(kind, seed);
  const SkullGuess guess = guess_on(head);
  int beyond = 0;
  for (const LandmarkGuess& one : guess.found) {
    const double error_mm = head.error_mm(one.name, one.p_mm);
    if (error_mm <= one.within_mm + least_mm) continue;
    ++beyond;
    std::printf("%s, seed %d: %s is %.1f mm off, within %.1f\n", verify::name_of(kind),
                static_cast<int>(seed), one.name.c_str(), error_mm, one.within_mm);
  }
  return {static_cast<int>(guess.found.size()), beyond};
}

TEST(RandomHeads, OfACouchAMarkerAndNoTeethNoGuessLiesBeyondItsInterval) {
  for (const HeadKind kind : {HeadKind::Toothless, HeadKind::Couch, HeadKind::Marker}) {
    const auto [found, beyond] = counted(kind, 0);
    EXPECT_EQ(beyond, 0) << verify::name_of(kind);
    EXPECT_GE(found, 11) << verify::name_of(kind);
  }
}

TEST(RandomHead, TellsTruthsOfWhatItHasAlone) {
  const RandomHead whole(HeadKind::Plain, 1), toothless(HeadKind::Toothless, 0);
  EXPECT_GE(whole.truths_mm().size(), 16u);
  EXPECT_FALSE(toothless.truths_mm().contains("incisor") && toothless.truths_mm().contains("lower_incisor"));
  EXPECT_EQ(whole.error_mm("midline_top", {900, 0, 0}), std::numeric_limits<double>::infinity());
  const glm::dvec3 q(12, -40, 20);
  EXPECT_LE(glm::distance(whole.canonical_mm(whole.head_mm(q)), q), 1e-9);
}

}  // namespace
}  // namespace octotomy::planner
