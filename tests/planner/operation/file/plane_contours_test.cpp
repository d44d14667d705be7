// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/plane_contours.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "brep/contour/contour.h"
#include "convert/surface/isosurface.h"
#include "tests/planner/ball_scan.h"

namespace octotomy::planner {
namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();

std::vector<glm::dvec2> square(double half_mm, double u_mm = 0.0) {
  return {{u_mm - half_mm, -half_mm},
          {u_mm + half_mm, -half_mm},
          {u_mm + half_mm, half_mm},
          {u_mm - half_mm, half_mm}};
}

TEST(PlaneContours, AnyPlaneCutsABallInItsCircle) {
  const voxel::Scene ball = tests::ball_scene(20.0, 64);
  const brep::Mesh surface = brep::mesh_of(convert::isosurface(ball, 0.0, unbounded));
  for (const char* view : {"anterior", "left", "inferior", "35,15", "-120,-40"})
    for (const double position_mm : {-11.3, 0.2, 14.7}) {
      const ViewPlane plane{voxel::parse_view(view), position_mm};
      const double radius_mm = std::sqrt(400.0 - position_mm * position_mm);
      for (const PlaneContours& found :
           {contours_in_plane(ball, 0.0, unbounded, plane), contours_in_plane(surface, plane)}) {
        ASSERT_EQ(found.size(), 1u) << view << position_mm;
        for (const glm::dvec2& p : found[0])
          EXPECT_NEAR(glm::length(p), radius_mm, 0.2) << view << position_mm;
        EXPECT_NEAR(brep::signed_area_mm2({found[0]}) / (M_PI * radius_mm * radius_mm), 1.0, 0.01)
            << view << position_mm << ": outlines run counter-clockwise";
      }
    }
}

TEST(PlaneContours, WithAnUpperBoundAloneTheBallIsAHoleOfTheScan) {
  const voxel::Scene ball = tests::ball_scene(20.0, 64);
  const PlaneContours found = contours_in_plane(ball, -unbounded, 0.0, {voxel::parse_view("anterior"), 0.5});
  ASSERT_EQ(found.size(), 2u);
  const double one = brep::signed_area_mm2({found[0]}), other = brep::signed_area_mm2({found[1]});
  EXPECT_NEAR(std::max(one, other), 64.0 * 64.0, 5.0) << "the scan ends half a voxel beyond its samples";
  EXPECT_NEAR(std::min(one, other), -M_PI * 400.0, 15.0);
}

TEST(PlaneContours, APlaneThatMissesHasNone) {
  const voxel::Scene ball = tests::ball_scene(20.0, 64);
  EXPECT_TRUE(contours_in_plane(ball, 0.0, unbounded, {voxel::parse_view("left"), 25.0}).empty());
  EXPECT_TRUE(contours_in_plane(ball, 0.0, unbounded, {voxel::parse_view("left"), 250.0}).empty());
}

TEST(PlaneContours, LabelsAtTheirOwnValueEndWithTheScan) {
  voxel::Scene labels = tests::ball_scene(20.0, 16);
  labels.samples = voxel::Int16Samples(16 * 16 * 16, 1);
  const double reach_mm = labels.lattice.spacing_mm().x * 8.0;
  for (const char* view : {"anterior", "35,15"}) {
    const voxel::View looking = voxel::parse_view(view);
    const glm::dvec3 middle_mm = labels.lattice.lps_mm(glm::dvec3(7.5));
    const ViewPlane plane{looking, glm::dot(middle_mm, looking.look)};
    const PlaneContours found = contours_in_plane(labels, 1.0, unbounded, plane);
    ASSERT_EQ(found.size(), 1u) << view;
    for (const glm::dvec2& p : found[0]) {
      const glm::dvec3 apart_mm = glm::abs(plane.lps_mm(p) - middle_mm);
      EXPECT_LE(std::max({apart_mm.x, apart_mm.y, apart_mm.z}), reach_mm + 1e-6) << view;
    }
  }
}

TEST(PlaneContours, ARegionIsTheInnermostOutlineWithItsHoles) {
  const PlaneContours all{square(20.0), square(10.0), square(5.0), square(3.0, 50.0), square(2.0, 15.0)};
  const auto sizes = [&](const glm::dvec2& p) {
    std::vector<double> areas;
    for (const auto& polygon : region_around(all, p))
      areas.push_back(std::abs(brep::signed_area_mm2({polygon})));
    return areas;
  };
  EXPECT_EQ(sizes({0.0, 15.0}), (std::vector<double>{1600.0, 400.0, 16.0}));
  EXPECT_EQ(sizes({0.0, 0.0}), (std::vector<double>{100.0})) << "an island in a hole";
  EXPECT_EQ(sizes({50.0, 0.0}), (std::vector<double>{36.0}));
  EXPECT_TRUE(sizes({0.0, 7.0}).empty()) << "in a hole";
  EXPECT_TRUE(sizes({0.0, 30.0}).empty()) << "outside";
}

}  // namespace
}  // namespace octotomy::planner
