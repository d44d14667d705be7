// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/landmark_warp.h"

#include <cmath>
#include <gtest/gtest.h>

#include "tests/unit_universe.h"
#include "voxel/measure/measure.h"
#include "voxel/solid/combine.h"

namespace octotomy::voxel {
namespace {

const Expression ball = Sphere{{0, 0, 0}, 40.0};

Octree still() {
  return combine(tests::universe_about_origin(7), ball);
}

TEST(WarpedByLandmarks, TheSurfaceGoesWhereALandmarkOnItGoesAndRestsOutOfReach) {
  const Octree made = warped_by_landmarks(still(), ball, {{{0, -40, 0}, {0, -6, 0}}}, 30.0);
  const Lattice lattice = made.universe().lattice();
  const auto holds = [&](const glm::dvec3& p_mm) {
    return made.contains(glm::ivec3(glm::round(lattice.voxel(p_mm))));
  };
  EXPECT_TRUE(holds({0.5, -45.5, 0.5}));
  EXPECT_FALSE(holds({0.5, -46.5, 0.5}));
  // Half way out of reach the displacement is 6 (1 - 1/2)^4 (4 / 2 + 1) = 1.125 mm; the map along the line is 1 : 1.
  EXPECT_TRUE(holds({0.5, -39.5, 0.5}));
  // Without any change behind and beside.
  const Octree changed = combine(made.universe(), Expression(made) ^ Expression(still()));
  ASSERT_FALSE(changed.is_empty());
  const auto extents = measure(changed).extents;
  ASSERT_TRUE(extents);
  EXPECT_LE(extents->high_mm.y, -40.0 + 30.0);
  EXPECT_GE(extents->low_mm.z, -30.0);
  EXPECT_LE(extents->high_mm.z, 30.0);
}

TEST(WarpedByLandmarks, APointIsInsideExactlyWhereItsOriginIs) {
  const std::vector<LandmarkShift> landmarks{{{0, -40, 0}, {1, -5, 2}}, {{20, -34, 0}, {0, 0, 0}}};
  const Octree made = warped_by_landmarks(still(), ball, landmarks, 35.0);
  // Two weights by hand: the functions of the landmarks at one another.
  const double r = glm::distance(landmarks[0].p_mm, landmarks[1].p_mm) / 35.0;
  const auto share = [](double at) { return at < 1.0 ? std::pow(1.0 - at, 4) * (4.0 * at + 1.0) : 0.0; };
  const glm::dvec3 first = landmarks[0].by_mm / (1.0 - share(r) * share(r)), second = -share(r) * first;
  const Lattice lattice = made.universe().lattice();
  int compared = 0;
  // Forward from points at rest: a displaced point is inside as its origin is.
  for (int x = -25; x <= 25; x += 2)
    for (int z = -25; z <= 25; z += 2)
      for (int y = -48; y <= -20; ++y) {
        const glm::dvec3 p(x, y, z);
        const glm::dvec3 to = p + share(glm::distance(p, landmarks[0].p_mm) / 35.0) * first +
                              share(glm::distance(p, landmarks[1].p_mm) / 35.0) * second;
        // Points within a voxel of the surface are left out, because a voxel is read at its centre.
        if (std::abs(glm::length(p) - 40.0) < 1.5) continue;
        EXPECT_EQ(made.contains(glm::ivec3(glm::round(lattice.voxel(to)))), glm::length(p) < 40.0)
            << x << " " << y << " " << z;
        ++compared;
      }
  EXPECT_GT(compared, 1000);
}

TEST(WarpedByLandmarks, WithoutMotionNothingChanges) {
  EXPECT_EQ(warped_by_landmarks(still(), ball, {{{0, -40, 0}, {0, 0, 0}}}, 30.0), still());
}

TEST(WarpedByLandmarks, WrongInputIsRefusedAndAFoldIsToldWithItsPlace) {
  EXPECT_THROW(warped_by_landmarks(still(), ball, {}, 30.0), InvalidInput);
  EXPECT_THROW(warped_by_landmarks(still(), ball, {{{0, -40, 0}, {0, -1, 0}}}, 0.0), InvalidInput);
  EXPECT_THROW(warped_by_landmarks(still(), ball, {{{0, NAN, 0}, {0, -1, 0}}}, 30.0), InvalidInput);
  EXPECT_THROW(
      warped_by_landmarks(still(), ball, {{{0, -40, 0}, {0, -1, 0}}, {{0, -40, 0}, {0, 1, 0}}}, 30.0),
      InvalidInput);
  try {
    warped_by_landmarks(still(), ball, {{{0, -40, 0}, {0, -40, 0}}}, 30.0);
    FAIL() << "a displacement longer than its reach folds";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("fold the tissue at ("), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace octotomy::voxel
