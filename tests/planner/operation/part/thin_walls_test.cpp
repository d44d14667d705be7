// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/part/thin_walls.h"

#include <cmath>
#include <gtest/gtest.h>

#include "brep/measure/local_thickness.h"
#include "brep/shape/prism.h"

namespace octotomy::planner {
namespace {

/// A polygon (x, z) swept by 12 mm along y.
brep::Solid swept(const std::vector<glm::dvec2>& polygon_mm) {
  brep::Prism prism;
  prism.polygons_mm = {polygon_mm};
  prism.to_mm = 12.0;
  return brep::solid_of(prism);
}

struct Trimmed {
  brep::Solid solid;
  std::vector<std::string> findings;
};

Trimmed trimmed(const brep::Solid& solid, double least_mm) {
  const Objects objects;
  const Scans no_scan;
  verify::MeshExpressions expressions(swept({{-50, -50}, {50, -50}, {50, 50}, {-50, 50}}));
  Timings timings;
  const MeshBench bench{glm::dvec3(-50), glm::dvec3(50), objects, no_scan, expressions, timings, {}, {}};
  MeshSide made;
  brep::Solid found = without_thin_walls(solid, least_mm, bench, made);
  return {std::move(found), made.findings};
}

double thinnest_mm(const brep::Solid& solid) {
  const brep::LocalThickness found = brep::local_thickness(solid);
  return found.thinnest_wall ? found.surface[*found.thinnest_wall].thickness_mm : 1e9;
}

TEST(ThinWalls, ABlockKeepsEveryPointAndLosesItsFin) {
  const brep::Solid block = swept({{0, 0}, {14, 0}, {14, 8}, {0, 8}});
  EXPECT_EQ(trimmed(block, 0.6).solid.triangles().points_mm, block.triangles().points_mm);
  const brep::Solid fin = swept({{0, 0}, {14, 0}, {14, 8}, {7.4, 8}, {7.4, 13}, {7, 13}, {7, 8}, {0, 8}});
  EXPECT_NEAR(thinnest_mm(fin), 0.4, 0.01);
  const Trimmed found = trimmed(fin, 0.6);
  EXPECT_TRUE(found.findings.empty()) << testing::PrintToString(found.findings);
  EXPECT_GE(thinnest_mm(found.solid), 0.6);
  // What balls of 0.75 mm hold rises a little into the fin's foot.
  EXPECT_NEAR(brep::volume_mm3(found.solid), 14.0 * 8.0 * 12.0, 0.5);
  EXPECT_LT(found.solid.size().high_mm.z, 8.1);
}

TEST(ThinWalls, AWedgeEndsWhereItIsAsThickAsAsked) {
  // 20 degrees, 15 mm long.
  const double height_mm = 15.0 * std::tan(20.0 * M_PI / 180.0);
  const Trimmed found = trimmed(swept({{0, 0}, {15, height_mm}, {15, 0}}), 0.6);
  EXPECT_TRUE(found.findings.empty()) << testing::PrintToString(found.findings);
  EXPECT_GE(thinnest_mm(found.solid), 0.6);
  // Balls of a radius r have their centre r / sin 10 degrees from the edge, and 1.1 r about it stays. The
  // mesh cuts the sharp edge of those centres off.
  const double radius_mm = 0.375, middle_mm = radius_mm / std::sin(10.0 * M_PI / 180.0);
  EXPECT_NEAR(found.solid.size().low_mm.x, middle_mm * std::cos(10.0 * M_PI / 180.0) - 1.1 * radius_mm, 0.2);
  EXPECT_NEAR(found.solid.size().high_mm.x, 15.0, 1e-9);
}

}  // namespace
}  // namespace octotomy::planner
