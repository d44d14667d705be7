// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/surface/trace_contours.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>

#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "convert/surface/isosurface.h"
#include "tests/reference_data.h"
#include "tests/voxel/field_scene.h"
#include "voxel/scan/read_scene.h"

namespace octotomy::convert {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Depth below the surface of an ellipsoid, in tenths of a millimetre.
voxel::Scene ellipsoid(const glm::dmat4& lps_from_voxel, const glm::ivec3& dims, const glm::dvec3& centre_mm,
                       const glm::dvec3& axes_mm) {
  return tests::field_scene<float>({dims, lps_from_voxel}, [&](const glm::dvec3& p_mm) {
    return 10.0 * (1.0 - glm::length((p_mm - centre_mm) / axes_mm)) * axes_mm.z;
  });
}

TEST(ContourSurface, AnEllipsoidHasItsVolumeAndPlaceInAnyLattice) {
  const glm::dvec3 centre(-3.0, 5.0, 7.0), axes(12.0, 9.0, 10.0);
  const double whole = 4.0 / 3.0 * std::numbers::pi * axes.x * axes.y * axes.z;
  // Upright; mirrored in x; slices sheared as under a tilted gantry.
  const glm::dmat4 lattices[] = {{{0.5, 0, 0, 0}, {0, 0.5, 0, 0}, {0, 0, 1.0, 0}, {-18, -8, -6, 1}},
                                 {{-0.5, 0, 0, 0}, {0, 0.5, 0, 0}, {0, 0, 1.0, 0}, {12, -8, -6, 1}},
                                 {{0.5, 0, 0, 0}, {0, 0.5, 0, 0}, {0, 0.25, 1.0, 0}, {-18, -14, -6, 1}}};
  for (const glm::dmat4& lattice : lattices) {
    const brep::TiledSections tiled =
        contour_surface(ellipsoid(lattice, {60, 80, 26}, centre, axes), 0.0, infinity);
    const brep::Health found = brep::health(tiled.surface);
    EXPECT_TRUE(found.solid()) << found.findings.front();
    const brep::Measures measures = brep::measure(brep::mesh_of(tiled.surface));
    EXPECT_NEAR(measures.volume_mm3, whole, 0.015 * whole);
    ASSERT_TRUE(measures.centroid_mm);
    EXPECT_LT(glm::distance(*measures.centroid_mm, centre), 0.05);
  }
}

TEST(ContourSurface, ABoundedWindowLeavesTheCoreOut) {
  const glm::dmat4 lattice = {{0.5, 0, 0, 0}, {0, 0.5, 0, 0}, {0, 0, 1.0, 0}, {-18, -8, -6, 1}};
  const voxel::Scene scene = ellipsoid(lattice, {60, 60, 26}, {-3, 5, 7}, {10, 10, 10});
  const brep::TiledSections tiled = contour_surface(scene, 0.0, 50.0);
  const double shell = 4.0 / 3.0 * std::numbers::pi * (1000.0 - 125.0);
  EXPECT_NEAR(brep::size_of(tiled.surface).volume_mm3, shell, 0.01 * shell);
  EXPECT_EQ(brep::health(tiled.surface).shells, 2u);
  EXPECT_THROW(trace_contours(scene, std::nan(""), 1.0), std::invalid_argument);
}

/// The volumes may differ by the surface's area times a share of the distance of slices. Across a gap,
/// isosurface() joins contours that do not overlap; the tiled surface closes them half way.
void expect_near_isosurface(const voxel::Scene& scene, double low, double share) {
  const brep::TiledSections tiled = contour_surface(scene, low, infinity);
  const brep::Health found = brep::health(tiled.surface);
  EXPECT_TRUE(found.solid()) << found.findings.front();
  EXPECT_EQ(found.self_intersections, 0u);
  const brep::Size size = brep::size_of(tiled.surface);
  const brep::Size other = brep::size_of(isosurface(scene, low, infinity));
  EXPECT_NEAR(size.volume_mm3, other.volume_mm3, share * scene.lattice.spacing_mm().z * other.area_mm2);
  EXPECT_NEAR(size.area_mm2, other.area_mm2, 0.03 * other.area_mm2);
  EXPECT_GT(tiled.strips, 500u);
  EXPECT_LT(tiled.crossed_strips, tiled.strips / 20);
}

TEST(ContourSurface, TheSkinOfARealHeadIsASolidAsLargeAsItsIsosurface) {
  OCTOTOMY_NEEDS_DATA("ct_unc_cthead.nrrd");
  expect_near_isosurface(voxel::read_scene(tests::reference_data("ct_unc_cthead.nrrd")), -200.0, 0.01);
}

TEST(ContourSurface, TheBoneOfARealHeadIsASolidNearlyAsLargeAsItsIsosurface) {
  OCTOTOMY_NEEDS_DATA("ct_unc_cthead.nrrd");
  expect_near_isosurface(voxel::read_scene(tests::reference_data("ct_unc_cthead.nrrd")), 300.0, 0.05);
}

}  // namespace
}  // namespace octotomy::convert
