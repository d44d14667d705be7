// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/interval/two_phase.h"

#include <cmath>
#include <gtest/gtest.h>

#include "verify/phantom/drawn_solid.h"
#include "verify/suite/interval_suite.h"

namespace octotomy::verify {
namespace {

void expect_holds(const Interval& found, double truth) {
  EXPECT_NEAR(found.value, truth, found.half_width);
}

DrawnSolid plate(double thickness_mm) {
  const glm::dvec3 half(6.0, 7.0, 0.5 * thickness_mm);
  return {"plate",
          [half](const glm::dvec3& p) {
            const glm::dvec3 q = glm::abs(p) - half;
            return glm::length(glm::max(q, glm::dvec3(0.0))) + std::min(std::max({q.x, q.y, q.z}), 0.0);
          },
          9.5, 8.0 * half.x * half.y * half.z, 8.0 * (half.x * half.y + half.y * half.z + half.z * half.x)};
}

TEST(TwoPhase, HoldsAPlateThatNoSampleRaisesOverTheHalfLevel) {
  Chance chance(3);
  DrawnScan how;
  how.blur_voxels = 0.9;
  const DrawnSolid solid = plate(0.8);
  const auto found = two_phase(scan_of(solid, how, chance), how.half());
  ASSERT_TRUE(found);
  EXPECT_LT(found->evidence.highest, 0.5);
  EXPECT_FALSE(found->evidence.has_core);
  expect_holds(found->volume_mm3, solid.volume_mm3);
  expect_holds(found->area_mm2, solid.area_mm2);
  EXPECT_LT(found->volume_mm3.half_width, 0.2 * solid.volume_mm3);
}

TEST(TwoPhase, MeasuresTheContrastWhereTheSolidIsThickAndIsSureThen) {
  Chance chance(4);
  const DrawnScan how;
  const DrawnSolid solid = plate(12.0);
  const auto found = two_phase(scan_of(solid, how, chance), how.half() - 10.0);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->evidence.has_core);
  EXPECT_NEAR(found->evidence.contrast, how.contrast, 5.0);
  EXPECT_NEAR(found->evidence.noise, how.noise, 2.0);
  expect_holds(found->volume_mm3, solid.volume_mm3);
  expect_holds(found->area_mm2, solid.area_mm2);
  EXPECT_LT(found->volume_mm3.half_width, 0.02 * solid.volume_mm3);
}

TEST(TwoPhase, KeepsToTwoDensitiesAndToSolidsWithinTheScan) {
  Chance chance(5);
  const DrawnScan how;
  voxel::Scene scan = scan_of(plate(6.0), how, chance);
  ASSERT_TRUE(two_phase(scan, how.half()));
  EXPECT_FALSE(two_phase(scan, 200.0)) << "the core is far above twice the bound";
  const auto below = two_phase(scan, 5000.0);
  EXPECT_TRUE(!below || below->evidence.is_ambiguous) << "a thick solid of a fifth of the density";
  auto& samples = std::get<voxel::Int16Samples>(scan.samples);
  const voxel::Int16Samples before = samples;
  for (std::size_t i = 0; i < samples.size() / 10; ++i)
    samples[i] = static_cast<std::int16_t>(samples[i] + 300);
  EXPECT_FALSE(two_phase(scan, how.half())) << "a third density between both";
  samples = before;
  for (std::size_t i = 0; i < 9; ++i) samples[i] = 1000;
  EXPECT_FALSE(two_phase(scan, how.half())) << "a solid at the border";
}

TEST(TwoPhase, HoldsThinSolidsInTissueWithAirAboutIt) {
  DrawnScan how;
  how.blur_voxels = 0.5;
  how.third = -1000.0;
  for (const double thickness : {1.2, 2.0, 3.0}) {
    Chance chance(6);
    how.third_from_mm = 8.0;
    const DrawnSolid solid = plate(thickness);
    const voxel::Scene scan = scan_of(solid, how, chance);
    const auto& samples = std::get<voxel::Int16Samples>(scan.samples);
    ASSERT_GT(4 * std::count_if(samples.begin(), samples.end(), [](int sample) { return sample < -500; }),
              static_cast<std::ptrdiff_t>(samples.size()))
        << "over a quarter is air";
    const auto found = two_phase(scan, how.half());
    ASSERT_TRUE(found) << thickness;
    EXPECT_TRUE(found->evidence.has_third);
    EXPECT_FALSE(found->evidence.is_ambiguous);
    EXPECT_NEAR(found->evidence.background, how.background, 10.0);
    expect_holds(found->volume_mm3, solid.volume_mm3);
    expect_holds(found->area_mm2, solid.area_mm2);
    EXPECT_LT(found->volume_mm3.half_width, 0.2 * solid.volume_mm3);
    how.third_from_mm = 1.5;
    // A wall that blur lowers shows no density of its own: with a thin coat it looks as a wall in air.
    if (thickness < 1.5) continue;
    const auto coated = two_phase(scan_of(solid, how, chance), how.half());
    EXPECT_TRUE(!coated || coated->evidence.is_ambiguous) << "air at the solid";
  }
}

TEST(TwoPhase, LeavesShearedScansAndNeighboursOfAThirdDensityToTheSurface) {
  Chance chance(8);
  DrawnScan how;
  how.blur_voxels = 0.6;
  const DrawnSolid solid = plate(6.0);
  voxel::Scene scan = scan_of(solid, how, chance);
  ASSERT_TRUE(two_phase(scan, how.half()));
  voxel::Scene sheared = scan;
  sheared.lattice.lps_from_voxel[2].y += 0.4;
  EXPECT_FALSE(two_phase(sheared, how.half()));
  // A block of a fifth of the density that touches the plate from below.
  auto& samples = std::get<voxel::Int16Samples>(scan.samples);
  const glm::ivec3 dims = scan.lattice.dims;
  std::size_t i = 0;
  for (int z = 0; z < dims.z; ++z)
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x, ++i) {
        const glm::dvec3 p = scan.lattice.lps_mm({x, y, z});
        if (std::abs(p.x) < 7.0 && std::abs(p.y) < 8.0 && p.z < -3.0 && p.z > -8.0)
          samples[i] = static_cast<std::int16_t>(std::max<int>(samples[i], 200));
      }
  const auto beside = two_phase(scan, how.half());
  EXPECT_TRUE(!beside || beside->evidence.is_ambiguous);
}

// Blurred walls that nowhere reach the bound look like one solid of a lower density.
TEST(TwoPhase, NothingFoundReachesToThinWallsThatAreEverywhere) {
  Chance chance(7);
  DrawnScan how;
  how.blur_voxels = 1.1;
  const double apart = 4.0, thickness = 0.9, side = 16.0;
  const DrawnSolid walls{"walls",
                         [=](const glm::dvec3& p) {
                           const double off = std::abs(p.x / apart - std::round(p.x / apart)) * apart;
                           const double within = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
                           return std::max(off - 0.5 * thickness, within - 0.5 * side);
                         },
                         14.0, 3.0 * side * side * thickness + side * side * thickness, 8.0 * side * side};
  const voxel::Scene scan = scan_of(walls, how, chance);
  const auto found = two_phase(scan, how.half());
  ASSERT_TRUE(found);
  Interval volume = nothing_found(how.spacing_mm).volume_mm3;
  EXPECT_LT(volume.half_width, 0.1 * walls.volume_mm3);
  widen_to(found->volume_mm3, volume);
  EXPECT_EQ(volume.value, 0.0);
  expect_holds(volume, walls.volume_mm3);
  EXPECT_EQ(volume.sources.back().name, "faint");
  const double wide = volume.half_width;
  widen_to(found->volume_mm3, volume);
  EXPECT_EQ(volume.half_width, wide) << "nothing is widened twice";
}

TEST(DrawnSuite, IntervalsHoldSolidsOfClassesThatNoConstantWasMadeFor) {
  IntervalSuiteOptions options;
  options.solids = 54;
  options.seed = 77;
  int classes = 0;
  for (const IntervalCoverage& row : drawn_suite(options)) {
    if (!row.group.empty()) {
      ++classes;
      EXPECT_EQ(row.cases, 2) << row.group;
      continue;
    }
    EXPECT_TRUE(is_likely(row, least_held)) << row.quantity << " " << row.sampling << " " << row.held;
  }
  EXPECT_EQ(classes, 2 * static_cast<int>(drawn_groups().size()));
}

TEST(DrawnSuite, ThreeMissesOfTwentySevenAreNotLikely) {
  IntervalCoverage row;
  row.cases = 27;
  for (const int missed : {0, 1, 2, 3, 4}) {
    row.held = 1.0 - missed / 27.0;
    EXPECT_EQ(is_likely(row, least_held), missed <= 2) << missed;
  }
  row.cases = 5000;
  row.held = 0.984;
  EXPECT_TRUE(is_likely(row, least_held));
  row.held = 0.98;
  EXPECT_FALSE(is_likely(row, least_held));
}

TEST(DrawnSuite, TruthsOfClosedFormsAreThoseOfLinesByChance) {
  // Lines through the reach's ball: mean length within and crossings (Cauchy and Crofton).
  for (const DrawnGroup& group : drawn_groups()) {
    Chance chance(11);
    const DrawnSolid solid = drawn_solid(group.name, chance);
    constexpr int lines = 20000;
    double within = 0.0;
    int crossings = 0;
    for (int i = 0; i < lines; ++i) {
      const double z = chance.between(-1.0, 1.0), angle = chance.between(0.0, 2.0 * M_PI);
      const glm::dvec3 along(std::sqrt(1 - z * z) * std::cos(angle), std::sqrt(1 - z * z) * std::sin(angle),
                             z);
      const glm::dvec3 u =
          glm::normalize(glm::cross(along, std::abs(z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0)));
      const double rho = solid.reach_mm * std::sqrt(chance.between(0.0, 1.0));
      const double turn = chance.between(0.0, 2.0 * M_PI);
      const glm::dvec3 start = rho * (std::cos(turn) * u + std::sin(turn) * glm::cross(along, u));
      const double half = std::sqrt(solid.reach_mm * solid.reach_mm - rho * rho);
      bool was_inside = false;
      for (double at = -half; at < half;) {
        const double value = solid.signed_mm(start + at * along), step = std::max(std::abs(value), 2e-3);
        crossings += (value < 0.0) != was_inside ? 1 : 0;
        was_inside = value < 0.0;
        within += was_inside ? step : 0.0;
        at += step;
      }
    }
    const double ball_mm2 = M_PI * solid.reach_mm * solid.reach_mm;
    // Three deviations of counts whose own spread is about their mean where lines seldom meet the solid.
    const double area_mm2 = 2.0 * crossings / lines * ball_mm2;
    EXPECT_NEAR(within / lines * ball_mm2, solid.volume_mm3, 0.06 * solid.volume_mm3) << group.name;
    EXPECT_NEAR(area_mm2, solid.area_mm2, solid.area_mm2 * (0.02 + 6.0 / std::sqrt(crossings + 1.0)))
        << group.name;
  }
}

}  // namespace
}  // namespace octotomy::verify
