// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/contour/cross_section.h"

#include <gtest/gtest.h>
#include <random>

#include "brep/boolean/boolean.h"
#include "brep/contour/tile_sections.h"
#include "brep/mesh/measure.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

using std::numbers::pi;

TEST(CrossSection, ABallsSectionsConvergeToTheirCirclesInAnyDirection) {
  const double r = 5.0;
  for (const glm::dvec3& normal : {glm::dvec3(0, 0, 1), glm::dvec3(1, -2, 0.3), glm::dvec3(0, -1, 0)}) {
    double area_error = 0.0;
    for (int splits = 3; splits <= 5; ++splits) {
      const glm::dvec3 centre(10, -20, 30);
      const double height = 2.0;
      const CrossSection section =
          cross_section(mesh_of(shapes::sphere(centre, r, splits)),
                        plane_through(centre + height * glm::normalize(normal), normal));
      ASSERT_EQ(section.contours.size(), 1u);
      const double error = pi * (r * r - height * height) - section.area_mm2;
      EXPECT_GT(error, 0.0);
      EXPECT_NEAR(section.perimeter_mm, 2 * pi * std::sqrt(r * r - height * height), 0.2 * error + 0.02);
      if (splits > 3) {
        EXPECT_NEAR(area_error / error, 4.0, 0.6) << splits << " splits";
      }
      area_error = error;
    }
  }
}

TEST(CrossSection, ContoursThatTouchAtAVertexInThePlaneArePartedAndTile) {
  // The middle sections of two pyramids meet with a corner at the origin.
  const auto pyramid = [](double side) {
    Triangles made;
    made.points_mm = {{0, 0, 0}, {side * 4, -3, -2}, {side * 4, 3, -2}, {side * 4, 0, 3}};
    made.faces = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
    if (volume_mm3(mesh_of(made)) < 0.0) made = shapes::inside_out(made);
    return made;
  };
  const Triangles both = shapes::together(pyramid(1.0), pyramid(-1.0));
  CrossSection section = cross_section(mesh_of(both), plane_through({0, 0, 0}, {0, 0, 1}));
  ASSERT_EQ(section.contours.size(), 2u);
  const auto common = [&] {
    std::size_t count = 0;
    for (const glm::dvec2& a : section.contours[0].points_mm)
      for (const glm::dvec2& b : section.contours[1].points_mm) count += a == b ? 1 : 0;
    return count;
  };
  EXPECT_EQ(common(), 1u);
  const double before_mm2 = signed_area_mm2(section.contours[0]);
  part_touching(section.contours);
  EXPECT_EQ(common(), 0u);
  EXPECT_EQ(section.contours[0].points_mm.size(), 4u);
  // The corner that is cut off is the contour at 1/1024 of its size.
  EXPECT_NEAR(signed_area_mm2(section.contours[0]) / before_mm2, 1.0 - 1.0 / (1024.0 * 1024.0), 1e-12);
  std::vector<Contour> parted = section.contours;
  part_touching(parted);
  EXPECT_EQ(parted[0].points_mm, section.contours[0].points_mm) << "nothing touches any more";
  EXPECT_NO_THROW(tile_sections({Section{0.0, section.contours}, Section{1.0, section.contours}}));
}

TEST(CrossSection, HolesRunTheOtherWayRoundAndAreTakenOff) {
  const Triangles shell = shapes::together(shapes::box({0, 0, 0}, {10, 8, 6}),
                                           shapes::inside_out(shapes::box({2, 2, 2}, {5, 4, 4})));
  const CrossSection section = cross_section(mesh_of(shell), plane_through({0, 0, 3}, {0, 0, 1}));
  ASSERT_EQ(section.contours.size(), 2u);
  EXPECT_NEAR(section.area_mm2, 80 - 6, 1e-12);
  EXPECT_NEAR(section.perimeter_mm, 36 + 10, 1e-12);
  EXPECT_NEAR(signed_area_mm2(section.contours[0]), 80, 1e-12);
  EXPECT_NEAR(signed_area_mm2(section.contours[1]), -6, 1e-12);
  EXPECT_EQ(section.open, 0u);
}

TEST(CrossSection, APlaneThroughCornersEdgesAndFacesCutsAsIfJustBelow) {
  const Mesh cube = mesh_of(shapes::box({0, 0, 0}, {2, 2, 2}));
  EXPECT_NEAR(cross_section(cube, plane_through({0, 0, 2}, {0, 0, 1})).area_mm2, 4.0, 1e-14);
  EXPECT_EQ(cross_section(cube, plane_through({0, 0, 0}, {0, 0, 1})).contours.size(), 0u);
  // The plane passes through four corners, along two edges.
  EXPECT_NEAR(cross_section(cube, plane_through({0, 0, 0}, {1, -1, 0})).area_mm2, 4.0 * std::sqrt(2.0),
              1e-13);
  // The plane passes through three corners: an equilateral triangle of side 2 sqrt 2.
  EXPECT_NEAR(cross_section(cube, plane_through({2, 0, 0}, {1, 1, 1})).area_mm2, 2.0 * std::sqrt(3.0), 1e-13);
  EXPECT_TRUE(cross_section(cube, plane_through({0, 0, 3}, {0, 0, 1})).contours.empty());
}

TEST(CrossSection, SectionsOfADifferenceAreThoseOfTheWholeLessTheCommon) {
  const Solid a = solid_of(shapes::sphere({0, 0, 0}, 5, 3)),
              b = solid_of(shapes::box({-6, -1, -2}, {6, 1.5, 2.5}));
  const Solid rest = boolean(a, Operation::Difference, b).solid,
              common = boolean(a, Operation::Intersection, b).solid;
  int met = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> any(-1, 1);
    const Plane plane = plane_through(3.0 * glm::dvec3(any(random), any(random), any(random)),
                                      {any(random), any(random), any(random)});
    const double common_mm2 = cross_section(common, plane).area_mm2;
    EXPECT_NEAR(cross_section(rest, plane).area_mm2 + common_mm2, cross_section(a, plane).area_mm2, 1e-9)
        << "seed " << seed;
    met += common_mm2 > 0.1;
  }
  EXPECT_GT(met, 20);
}

TEST(CrossSection, AnOpenSurfaceLeavesOpenLines) {
  Triangles lid = shapes::box({0, 0, 0}, {2, 2, 2});
  lid.faces.erase(lid.faces.begin() + 10, lid.faces.end());  // without x = 2
  const CrossSection section = cross_section(mesh_of(lid), plane_through({0, 0, 1}, {0, 0, 1}));
  ASSERT_EQ(section.contours.size(), 1u);
  EXPECT_EQ(section.open, 1u);
  EXPECT_NEAR(section.perimeter_mm, 6.0, 1e-14);
  EXPECT_EQ(section.area_mm2, 0.0);
}

TEST(CrossSection, PlanesHaveTheViewsAxes) {
  const Plane axial = plane_through({0, 0, 0}, {0, 0, 2}), coronal = plane_through({0, 0, 0}, {0, -1, 0});
  EXPECT_EQ(axial.right, glm::dvec3(-1, 0, 0));
  EXPECT_EQ(axial.up, glm::dvec3(0, -1, 0));
  EXPECT_EQ(coronal.right, glm::dvec3(1, 0, 0));
  EXPECT_EQ(coronal.up, glm::dvec3(0, 0, 1));
  EXPECT_THROW(plane_through({0, 0, 0}, {0, 0, 0}), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::brep
