// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certificate/specks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>

#include "brep/mesh/solid.h"
#include "tests/verify/add_box.h"

namespace octotomy::verify {
namespace {

using tests::add_box;

Specks specks_in(const brep::Triangles& mesh, const glm::dvec3& spacing_mm = glm::dvec3(1.0)) {
  return specks_of(brep::trusted_solid(mesh, brep::Proof::Construction),
                   voxel::axis_aligned_lattice({64, 64, 64}, spacing_mm, glm::dvec3(0.0)));
}

TEST(Specks, AreShellsBetweenTheCentresOfVoxelsHoweverWide) {
  brep::Triangles mesh;
  add_box(mesh, {0.5, 0.5, 0.5}, {20.5, 20.5, 20.5});
  EXPECT_EQ(specks_in(mesh).count, 0U);
  EXPECT_TRUE(specks_in(mesh).others.faces.empty());
  add_box(mesh, {30.2, 30.2, 30.2}, {30.7, 30.7, 30.7});  // between eight centres
  add_box(mesh, {40.1, 30.3, 30.3}, {50.1, 45.3, 30.6});  // a sheet between two layers of centres
  add_box(mesh, {39.8, 10.8, 10.8}, {40.1, 11.1, 11.1});  // smaller than both, around a centre
  add_box(mesh, {39.5, 20.3, 20.3}, {42.5, 20.6, 20.6});  // a rod between rows
  const Specks found = specks_in(mesh);
  EXPECT_EQ(found.count, 3U);
  EXPECT_NEAR(found.volume_mm3, 0.125 + 45.0 + 0.27, 1e-9);
  ASSERT_TRUE(found.largest);
  EXPECT_NEAR(found.largest->volume_mm3, 45.0, 1e-9);
  EXPECT_NEAR(found.largest->size_mm, 15.0, 1e-9);
  EXPECT_LT(glm::distance(found.largest->at_mm, {45.1, 37.8, 30.45}), 1e-9);
  EXPECT_EQ(found.largest->what, part_of_mesh_only);
  EXPECT_EQ(found.others.faces.size(), 24U);
}

TEST(Specks, AreCavitiesToo) {
  brep::Triangles mesh;
  add_box(mesh, {0.5, 0.5, 0.5}, {20.5, 20.5, 20.5});
  add_box(mesh, {5.2, 5.2, 5.2}, {5.7, 5.7, 5.7}, true);
  add_box(mesh, {8.7, 8.7, 8.7}, {9.2, 9.2, 9.2}, true);
  const Specks found = specks_in(mesh);
  EXPECT_EQ(found.count, 1U);
  EXPECT_NEAR(found.volume_mm3, 0.125, 1e-9);
  EXPECT_EQ(found.largest->what, part_of_voxels_only);
  EXPECT_EQ(found.others.faces.size(), 24U);
}

/// Faces, edges and corners along the lattice and through its centres.
TEST(Specks, AShellThroughCentresIsNone) {
  for (const glm::dvec3& spacing_mm : {glm::dvec3(1.0), glm::dvec3(0.5, 1.0, 2.0)}) {
    brep::Triangles mesh;
    add_box(mesh, glm::dvec3(4.0), glm::dvec3(6.0));
    add_box(mesh, glm::dvec3(10.0, 10.0, 10.25), glm::dvec3(12.0, 12.0, 13.0));
    EXPECT_EQ(specks_in(mesh, spacing_mm).count, 0U);
  }
}

/// The same sheet at many heights: a speck exactly if no layer of centres lies in it.
TEST(Specks, ASheetIsOneExactlyWhereNoLayerOfCentresLiesInIt) {
  int specks = 0;
  for (int i = 0; i < 100; ++i) {
    const double low = 10.005 + 0.01 * i, high = low + 0.4;
    brep::Triangles mesh;
    add_box(mesh, {5.3, 5.3, low}, {25.6, 25.6, high});
    const bool is_speck = specks_in(mesh).count == 1;
    EXPECT_EQ(is_speck, std::floor(high) < low) << low;
    specks += is_speck ? 1 : 0;
  }
  EXPECT_EQ(specks, 60);
}

}  // namespace
}  // namespace octotomy::verify
