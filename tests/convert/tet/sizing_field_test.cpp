// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/sizing_field.h"

#include <algorithm>
#include <gtest/gtest.h>

#include "convert/tet/region_tetrahedra.h"
#include "convert/tet/tetrahedralise.h"
#include "tests/convert/surfaces.h"
#include "tests/unit_universe.h"
#include "voxel/solid/combine.h"

namespace octotomy::convert {
namespace {

using tests::ball;
using tests::box;

const glm::dvec3 landmark_mm(20, 0, 0);  // on the ball below

Refinement at_landmark(double size_mm) {
  return {{landmark_mm}, {}, size_mm};
}

double smallest_angle_deg(const brep::Triangles& t) {
  double least = 180.0;
  for (const auto& face : t.faces)
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::dvec3 &a = t.points_mm[face[i]], &b = t.points_mm[face[(i + 1) % 3]],
                       &c = t.points_mm[face[(i + 2) % 3]];
      least =
          std::min(least, glm::degrees(std::acos(glm::dot(glm::normalize(b - a), glm::normalize(c - a)))));
    }
  return least;
}

/// The mean length and the number of the sides of elements whose middles are within a distance of a point.
struct Sides {
  double mean_mm = 0.0;
  std::size_t elements = 0;
};
Sides sides_within(const Tetrahedra& t, const glm::dvec3& p_mm, double low_mm, double high_mm) {
  Sides sides;
  for (std::size_t i = 0; i < t.tets.size(); ++i) {
    const TetCorners c = corners_mm(t, i);
    const double way_mm = glm::distance(0.25 * (c[0] + c[1] + c[2] + c[3]), p_mm);
    if (way_mm < low_mm || way_mm >= high_mm) continue;
    ++sides.elements;
    for (const auto& [a, b] : sides_of_tet) sides.mean_mm += glm::distance(c.at(a), c.at(b)) / 6.0;
  }
  sides.mean_mm /= static_cast<double>(sides.elements);
  return sides;
}

TEST(SizingField, SizesGrowWithTheWayFromTheNearestPlace) {
  const SizingField sizes({at_landmark(0.5), {{}, box({-30, -30, -31}, {30, 30, -30}), 2.0}});
  const std::vector<double> at_mm = sizes.at_mm({landmark_mm, {20, 0, 5}, {0, 0, -20}, {3, 4, -30}});
  EXPECT_DOUBLE_EQ(at_mm[0], 0.5);
  EXPECT_DOUBLE_EQ(at_mm[1], 0.5 + 5 * sizing_growth());
  EXPECT_DOUBLE_EQ(at_mm[2], 2.0 + 10 * sizing_growth());
  EXPECT_DOUBLE_EQ(at_mm[3], 2.0);
  EXPECT_EQ(sizes.least_mm(), 0.5);
  EXPECT_THROW(SizingField({at_landmark(0.0)}), std::invalid_argument);
  EXPECT_THROW(SizingField({Refinement{}}), std::invalid_argument);
}

TEST(SizingField, ASurfaceIsDividedThereAndStaysClosedAndInPlace) {
  const brep::Triangles coarse = ball({0, 0, 0}, 20.0, 3);
  const SizingField sizes({at_landmark(0.4)});
  const brep::Triangles fine = refined_surface(coarse, sizes);
  EXPECT_EQ(tests::fault_in_closedness(fine), std::nullopt);
  EXPECT_NEAR(tests::volume_mm3(fine), tests::volume_mm3(coarse), 1e-9 * tests::volume_mm3(coarse));
  EXPECT_NEAR(tests::area_mm2(fine), tests::area_mm2(coarse), 1e-9 * tests::area_mm2(coarse));
  EXPECT_GE(smallest_angle_deg(fine), 0.5 * smallest_angle_deg(coarse)) << "Rivara's bound";
  EXPECT_TRUE(std::equal(coarse.points_mm.begin(), coarse.points_mm.end(), fine.points_mm.begin()));
  std::vector<glm::dvec3> middles_mm;
  std::vector<double> lengths_mm;
  for (const auto& face : fine.faces)
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::dvec3 &a = fine.points_mm[face[i]], &b = fine.points_mm[face[(i + 1) % 3]];
      middles_mm.push_back(0.5 * (a + b));
      lengths_mm.push_back(glm::distance(a, b));
    }
  const std::vector<double> most_mm = sizes.at_mm(middles_mm);
  for (std::size_t i = 0; i < most_mm.size(); ++i) EXPECT_LE(lengths_mm[i], 4.0 / 3.0 * most_mm[i]);
  EXPECT_GT(fine.faces.size(), coarse.faces.size() + 200);
  EXPECT_LT(fine.faces.size(), 2 * coarse.faces.size()) << "far away it stays as it was";
  EXPECT_EQ(refined_surface(coarse, SizingField({at_landmark(50.0)})).faces, coarse.faces);
  EXPECT_THROW(refined_surface(coarse, SizingField({{{}, coarse, 1e-3}})), voxel::Error);
}

TEST(SizingField, BothMeshersGradeElementsTowardsALandmark) {
  const brep::Mesh solid = brep::mesh_of(ball({0, 0, 0}, 20.0, 3));
  for (const Mesher mesher : {Mesher::TetGen, Mesher::Mesh3}) {
    TetOptions options;
    options.mesher = mesher;
    const Tetrahedra even = tetrahedralise(solid, options);
    options.finer = {at_landmark(0.4)};
    const Tetrahedra graded = tetrahedralise(solid, options);
    SCOPED_TRACE(graded.method);
    const Sides near = sides_within(graded, landmark_mm, 0.0, 1.0);
    EXPECT_GT(near.elements, 20U);
    EXPECT_GT(near.mean_mm, 0.2);
    EXPECT_LT(near.mean_mm, 0.75);
    EXPECT_GT(sides_within(even, landmark_mm, 0.0, 3.0).mean_mm, 2.0);
    EXPECT_LT(near.mean_mm, 0.6 * sides_within(graded, landmark_mm, 3.0, 5.0).mean_mm) << "growing";
    const double far = static_cast<double>(sides_within(graded, landmark_mm, 25.0, 50.0).elements);
    EXPECT_NEAR(far / static_cast<double>(sides_within(even, landmark_mm, 25.0, 50.0).elements), 1.0, 0.35)
        << "as it was";
    EXPECT_GE(quality(graded).min_dihedral_deg, fit_dihedral_deg());
    EXPECT_NEAR(quality(graded).volume_mm3, quality(even).volume_mm3, 2e-3 * quality(even).volume_mm3);
  }
}

TEST(SizingField, ElementsOfRegionsAreGradedTowardsASurface) {
  const voxel::Universe universe = tests::unit_universe(5);
  const auto block = [&](const glm::dvec3& low, const glm::dvec3& high) {
    return voxel::combine(universe, voxel::Expression(voxel::Box{low, high}));
  };
  const std::vector<voxel::Octree> halves{block({3.5, 3.5, 3.5}, {27.5, 27.5, 15.5}),
                                          block({3.5, 3.5, 15.5}, {27.5, 27.5, 27.5})};
  RegionMeshOptions options;
  options.size_mm = 5.0;
  const Tetrahedra even = smooth_tetrahedra_of(halves, options);
  // A plate along the cut between them.
  options.finer = {{{}, box({3.5, 3.5, 15.4}, {27.5, 27.5, 15.6}), 1.5}};
  const Tetrahedra graded = smooth_tetrahedra_of(halves, options);
  const auto sides_at = [](const Tetrahedra& t, double low_z, double high_z) {
    double sum_mm = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < t.tets.size(); ++i) {
      const TetCorners c = corners_mm(t, i);
      const double off = std::abs(0.25 * (c[0].z + c[1].z + c[2].z + c[3].z) - 15.5);
      if (off < low_z || off >= high_z) continue;
      for (const auto& [a, b] : sides_of_tet) sum_mm += glm::distance(c.at(a), c.at(b));
      count += 6;
    }
    return sum_mm / static_cast<double>(count);
  };
  EXPECT_LT(sides_at(graded, 0, 1), 0.65 * sides_at(even, 0, 3));
  EXPECT_LT(sides_at(graded, 0, 1), 0.7 * sides_at(graded, 7, 12));
  EXPECT_GE(quality(graded).min_dihedral_deg, fit_dihedral_deg());
}

TEST(SizingField, APlaceTooDeepForItsSizeIsTold) {
  const brep::Mesh solid = brep::mesh_of(ball({0, 0, 0}, 10.0, 3));
  TetOptions options;
  const auto findings = [&](const glm::dvec3& p_mm, double size_mm) {
    options.finer = {{{p_mm}, {}, size_mm}};
    return tetrahedralise(solid, options).findings;
  };
  const std::vector<std::string> deep = findings({0, 0, 0}, 0.1);
  ASSERT_FALSE(deep.empty());
  EXPECT_NE(deep.back().find("elements at (0, 0, 0) mm have sides of "), std::string::npos) << deep.back();
  EXPECT_NE(deep.back().find(" mm where 0.1 mm "), std::string::npos) << deep.back();
  EXPECT_TRUE(findings({9.5, 0, 0}, 0.3).empty());
  EXPECT_TRUE(findings({0, 0, 0}, 4.0).empty());
}

}  // namespace
}  // namespace octotomy::convert
