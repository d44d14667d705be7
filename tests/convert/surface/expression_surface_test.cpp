// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/surface/expression_surface.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "convert/surface/isosurface.h"
#include "tests/convert/surfaces.h"
#include "tests/voxel/field_scene.h"
#include "voxel/solid/combine.h"

namespace octotomy::convert {
namespace {

voxel::Universe universe_of(int depth, double voxel_mm) {
  voxel::Universe universe;
  universe.depth = depth;
  for (int axis = 0; axis < 3; ++axis) universe.lps_from_voxel[axis][axis] = voxel_mm;
  return universe;
}

/// Samples fall by 100 a voxel with the distance from a point.
voxel::GreyOctree distance_samples(const voxel::Universe& universe, const glm::dvec3& centre_mm,
                                   double radius_mm) {
  return voxel::grey_octree_of(
      universe, tests::field_scene<std::int16_t>(universe.lattice(), [&](const glm::dvec3& p_mm) {
        return 100.0 * (radius_mm - glm::distance(p_mm, centre_mm));
      }));
}

TEST(ExpressionSurface, OfAWindowIsTheIsosurfaceOfItsSamples) {
  const voxel::Universe universe = universe_of(5, 1.0);
  const voxel::GreyOctree grey = distance_samples(universe, {15.3, 15.7, 16.1}, 9.0);
  const brep::Triangles by_samples = isosurface(grey, 50.0, 32767.0);
  const brep::Triangles by_questions = isosurface(universe, voxel::Window{grey, 50.0, 32767.0});
  EXPECT_EQ(by_questions.faces, by_samples.faces);
  ASSERT_EQ(by_questions.points_mm.size(), by_samples.points_mm.size());
  for (std::size_t i = 0; i < by_samples.points_mm.size(); ++i)
    // isosurface() keeps points 2^-10 of an edge from samples.
    EXPECT_LT(glm::distance(by_questions.points_mm[i], by_samples.points_mm[i]), 0x1p-10 + 1e-9);
}

TEST(ExpressionSurface, AnObliqueCutIsFlatToAMillionthOfAMillimetre) {
  const voxel::Universe universe = universe_of(6, 0.5);
  const glm::dvec3 centre(15.8, 15.3, 16.1);
  const voxel::GreyOctree grey = distance_samples(universe, centre, 10.0);
  const glm::dvec3 normal = glm::normalize(glm::dvec3(0.3, -0.5, 0.8));
  const double offset = glm::dot(normal, centre) + 2.0;
  const brep::Triangles cut = isosurface(
      universe, voxel::Expression(voxel::Window{grey, 0.0, 32767.0}) & voxel::HalfSpace{normal, offset});
  EXPECT_EQ(tests::fault_in_closedness(cut), std::nullopt);
  double flat_mm2 = 0.0;
  double worst_mm = 0.0;
  for (const auto& [a, b, c] : cut.faces) {
    const glm::dvec3 n = glm::cross(cut.points_mm[b] - cut.points_mm[a], cut.points_mm[c] - cut.points_mm[a]);
    double furthest = 0.0;
    for (const std::uint32_t v : {a, b, c})
      furthest = std::max(furthest, std::abs(glm::dot(normal, cut.points_mm[v]) - offset));
    // Triangles of the cut are those near its plane and not beside its rim.
    const glm::dvec3 middle = (cut.points_mm[a] + cut.points_mm[b] + cut.points_mm[c]) / 3.0;
    if (furthest > 0.1 || glm::distance(middle, centre) > 9.0) continue;
    worst_mm = std::max(worst_mm, furthest);
    flat_mm2 += 0.5 * glm::length(n);
  }
  EXPECT_LT(worst_mm, 1e-6);
  EXPECT_NEAR(flat_mm2, std::numbers::pi * (81.0 - 4.0), 0.05 * std::numbers::pi * 77.0);
  // A ball less a cap of height r - 2: the ridge that is cut off takes a part.
  const double cap = std::numbers::pi * 64.0 * (30.0 - 8.0) / 3.0;
  EXPECT_NEAR(tests::volume_mm3(cut) / (4.0 / 3.0 * std::numbers::pi * 1000.0 - cap), 1.0, 0.005);
}

TEST(ExpressionSurface, ASpheresPointsLieOnItAndABoxKeepsItsPlanesUnderAMotion) {
  const voxel::Universe universe = universe_of(5, 1.0);
  const brep::Triangles sphere = isosurface(universe, voxel::Sphere{{15.2, 15.9, 16.3}, 9.7});
  for (const glm::dvec3& p : sphere.points_mm)
    EXPECT_NEAR(glm::distance(p, glm::dvec3(15.2, 15.9, 16.3)), 9.7, 1e-6);
  const glm::dmat4 motion = voxel::moved_from_still(
      {.translate_mm = {0.3, 0.1, -0.2}, .degrees = 20, .axis = {1, 1, 0}, .about_mm = {16, 16, 16}});
  const brep::Triangles box = isosurface(universe, moved(voxel::Box{{9, 9, 9}, {23, 21, 20}}, motion));
  EXPECT_EQ(tests::fault_in_closedness(box), std::nullopt);
  const glm::dmat4 back = glm::inverse(motion);
  for (const glm::dvec3& p : box.points_mm) {
    const glm::dvec3 q = back * glm::dvec4(p, 1.0);
    const glm::dvec3 off = glm::min(glm::abs(q - glm::dvec3(9, 9, 9)), glm::abs(q - glm::dvec3(23, 21, 20)));
    EXPECT_LT(std::min({off.x, off.y, off.z}), 1e-6);
  }
}

TEST(ExpressionSurface, OfAnOctreeRunsHalfWayBetweenItsVoxels) {
  const voxel::Universe universe = universe_of(4, 2.0);
  const voxel::Octree octree = voxel::combine(universe, voxel::Sphere{{15.0, 14.0, 16.0}, 9.0});
  for (const glm::dvec3& p : isosurface(universe, octree).points_mm) {
    const glm::dvec3 v = p / 2.0;
    const glm::dvec3 from_half = glm::abs(glm::fract(v) - 0.5);
    EXPECT_LT(std::min({from_half.x, from_half.y, from_half.z}), 1e-9);
  }
}

}  // namespace
}  // namespace octotomy::convert
