// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/deck/materials.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "convert/tet/octree_tetrahedra.h"
#include "tests/voxel/field_scene.h"
#include "voxel/solid/combine.h"

namespace octotomy::convert {
namespace {

/// HU = f(x) at voxel centres of 1.5 mm, 20 along each axis.
template <typename F>
voxel::Scene scan_of(const F& f) {
  return tests::field_scene<float>(
      voxel::axis_aligned_lattice({20, 20, 20}, glm::dvec3(1.5), {-3.0, 2.0, 1.0}), f);
}

Tetrahedra block() {
  voxel::Universe universe;
  universe.depth = 3;
  universe.lps_from_voxel[3] = glm::dvec4(4.3, 8.2, 7.7, 1.0);
  return tetrahedra_of(voxel::combine(universe, voxel::Box{{4, 8, 7}, {11, 15, 14}}));
}

glm::dvec3 middle(const Tetrahedra& t, std::size_t i) {
  const auto& [a, b, c, d] = t.tets[i];
  return 0.25 * (t.nodes_mm[a] + t.nodes_mm[b] + t.nodes_mm[c] + t.nodes_mm[d]);
}

TEST(Materials, TheMeanOfALinearScanIsItsValueAtTheElementsMiddle) {
  const auto hu = [](const glm::dvec3& p) { return 300.0 + 20.0 * p.x - 7.0 * p.y + 3.0 * p.z; };
  const Tetrahedra t = block();
  const ElementMaterials m = element_materials(t, scan_of(hu));
  ASSERT_EQ(m.hu.size(), t.tets.size());
  for (std::size_t i = 0; i < t.tets.size(); ++i) EXPECT_NEAR(m.hu[i], hu(middle(t, i)), 1e-3) << i;
}

TEST(Materials, AThinSheetIsSharedOutByVolumeAndNotSeenOnlyByElementsWhoseMiddleItHolds) {
  // One voxel plane of 1000 in a scan of 0: the interpolant's integral is that of a voxel's thickness.
  const voxel::Scene scan =
      scan_of([](const glm::dvec3& p) { return std::abs(p.z - 10.0) < 0.1 ? 1000.0 : 0.0; });
  const Tetrahedra t = block();
  const ElementMaterials m = element_materials(t, scan);
  double integral = 0.0;
  double area_mm2 = 0.0;
  glm::dvec3 low(1e9);
  glm::dvec3 high(-1e9);
  for (std::size_t i = 0; i < t.tets.size(); ++i) {
    const auto& [a, b, c, d] = t.tets[i];
    const auto& p = t.nodes_mm;
    integral += m.hu[i] * glm::dot(glm::cross(p[b] - p[a], p[c] - p[a]), p[d] - p[a]) / 6.0;
  }
  for (const glm::dvec3& p : t.nodes_mm) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  area_mm2 = (high.x - low.x) * (high.y - low.y);
  EXPECT_NEAR(integral / (1000.0 * 1.5 * area_mm2), 1.0, 0.05);
}

TEST(Materials, LawsGiveTheirPrintedStiffness) {
  EXPECT_NEAR(youngs_modulus_mpa(stiffness_law("morgan2003-femoral-neck"), 1.0), 6850.0, 1e-9);
  EXPECT_NEAR(youngs_modulus_mpa(stiffness_law("morgan2003-pooled"), 0.5), 8920.0 * std::pow(0.5, 1.83),
              1e-9);
  EXPECT_NEAR(youngs_modulus_mpa(stiffness_law("carter-hayes1977"), 1.8),
              3790.0 * std::pow(0.01, 0.06) * 5.832, 1e-3);
  EXPECT_NEAR(youngs_modulus_mpa(stiffness_law("keller1994"), 1.2), 10500.0 * std::pow(1.2, 2.29), 1e-9);
  const StiffnessLaw& keyak = stiffness_law("keyak1998");
  EXPECT_NEAR(youngs_modulus_mpa(keyak, 0.2), 33900.0 * std::pow(0.2, 2.2), 1e-9);
  EXPECT_NEAR(youngs_modulus_mpa(keyak, 0.4), 5307.0 * 0.4 + 469.0, 1e-9);
  EXPECT_NEAR(youngs_modulus_mpa(keyak, 1.0), 10200.0, 1e-9);
  for (const StiffnessLaw& law : stiffness_laws()) EXPECT_FALSE(law.source.empty()) << law.name;
  EXPECT_THROW(stiffness_law("wolff1892"), std::invalid_argument);
}

TEST(Materials, BinsGatherNeighboursInStiffnessAndKeepTheMean) {
  const Tetrahedra t = block();
  MaterialOptions options;
  options.calibration = DensityCalibration{0.001, 0.1};
  options.bins = 5;
  const ElementMaterials m =
      element_materials(t, scan_of([](const glm::dvec3& p) { return 100.0 * p.x; }), options);
  EXPECT_LE(m.materials.size(), 5U);
  EXPECT_GE(m.materials.size(), 3U);
  double exact = 0.0;
  double binned = 0.0;
  double worst = 0.0;
  for (std::size_t i = 0; i < t.tets.size(); ++i) {
    exact += m.youngs_modulus_mpa[i];
    binned += m.materials[m.material_of_tet[i]].youngs_modulus_mpa;
    const double ratio = m.youngs_modulus_mpa[i] / m.materials[m.material_of_tet[i]].youngs_modulus_mpa;
    worst = std::max({worst, ratio, 1.0 / ratio});
  }
  EXPECT_NEAR(binned / exact, 1.0, 1e-12);
  const auto [low, high] = std::minmax_element(m.youngs_modulus_mpa.begin(), m.youngs_modulus_mpa.end());
  EXPECT_LE(worst, std::pow(*high / *low, 1.0 / 5.0));
  EXPECT_DOUBLE_EQ(m.worst_ratio, worst);
  EXPECT_TRUE(m.findings.empty());
}

TEST(Materials, AnUncalibratedScanAndElementsOutsideItAreSaid) {
  Tetrahedra t = block();
  for (glm::dvec3& p : t.nodes_mm) p.x += 21.0;  // part of it leaves the scan
  const ElementMaterials m = element_materials(t, scan_of([](const glm::dvec3&) { return 500.0; }));
  ASSERT_EQ(m.findings.size(), 2U);
  EXPECT_NE(m.findings[0].find("NOT CALIBRATED"), std::string::npos);
  EXPECT_NE(m.findings[1].find("outside the scan"), std::string::npos);
  EXPECT_FALSE(m.outside.empty());
  for (const double hu : m.hu) EXPECT_NEAR(hu, 500.0, 1e-9);
}

TEST(Materials, AirAndMetalStayStiffnessesAndWrongOptionsAreRefused) {
  const Tetrahedra t = block();
  const ElementMaterials air = element_materials(t, scan_of([](const glm::dvec3&) { return -1000.0; }));
  for (const double e : air.youngs_modulus_mpa) EXPECT_EQ(e, 1.0);
  MaterialOptions options;
  options.bins = 0;
  EXPECT_THROW(element_materials(t, scan_of([](const glm::dvec3&) { return 0.0; }), options),
               std::invalid_argument);
  EXPECT_THROW(element_materials({}, scan_of([](const glm::dvec3&) { return 0.0; })), std::invalid_argument);
}

TEST(Materials, VoxelsThatTheSurfaceSharesWithAirCountAsWhatIsBelowWhereAskedFor) {
  const Tetrahedra t = block();
  glm::dvec3 low(1e9), high(-1e9);
  for (const glm::dvec3& p : t.nodes_mm) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  // Bone of 1000, blurred over a voxel at its surface.
  const voxel::Scene scan = scan_of([&](const glm::dvec3& p) {
    const glm::dvec3 in = glm::min(p - low, high - p);
    return 1000.0 * std::clamp(0.5 + std::min({in.x, in.y, in.z}) / 1.5, 0.0, 1.0);
  });
  const ElementMaterials own = element_materials(t, scan);
  EXPECT_LT(*std::min_element(own.hu.begin(), own.hu.end()), 750.0);
  MaterialOptions options;
  options.surface_depth_mm = 1.5 * std::sqrt(3.0);
  const ElementMaterials corrected = element_materials(t, scan, options);
  EXPECT_GT(*std::min_element(corrected.hu.begin(), corrected.hu.end()), 995.0);
  for (std::size_t i = 0; i < own.hu.size(); ++i) ASSERT_GE(corrected.hu[i], own.hu[i]) << i;
  options.surface_depth_mm = -1.0;
  EXPECT_THROW(element_materials(t, scan, options), std::invalid_argument);
}

TEST(Materials, HaveTheSameBitsOnOneThreadAndMany) {
  const voxel::Scene scan = scan_of([](const glm::dvec3& p) { return 300.0 * std::sin(p.x) + 50.0 * p.y; });
  MaterialOptions options;
  options.surface_depth_mm = 1.0;
  const ElementMaterials many = element_materials(block(), scan, options);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(element_materials(block(), scan, options).youngs_modulus_mpa, many.youngs_modulus_mpa);
}

}  // namespace
}  // namespace octotomy::convert
