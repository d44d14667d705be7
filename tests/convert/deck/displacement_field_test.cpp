// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/deck/displacement_field.h"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <random>

#include "brep/mesh/measure.h"
#include "convert/deck/calculix_result.h"
#include "convert/tet/octree_tetrahedra.h"
#include "tests/convert/surfaces.h"
#include "tests/unit_universe.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/solid/combine.h"

namespace octotomy::convert {
namespace {

using tests::unit_universe;

/// Elements of several sizes within a ball of 12 mm.
Tetrahedra ball_of_elements() {
  return tetrahedra_of(voxel::combine(unit_universe(5), voxel::Sphere{{15, 16, 14}, 12.0}));
}

glm::dvec3 affine(const glm::dvec3& p_mm) {
  return {0.5 + 0.1 * p_mm.x - 0.05 * p_mm.y, -1.0 + 0.02 * p_mm.z, 0.25 + 0.03 * p_mm.x + 0.08 * p_mm.z};
}

DisplacementField affine_field() {
  const Tetrahedra elements = ball_of_elements();
  std::vector<glm::dvec3> displacements;
  for (const glm::dvec3& p_mm : elements.nodes_mm) displacements.push_back(affine(p_mm));
  return {elements, displacements, 20.0};
}

/// A field with one displacement for all nodes of the ball. Its voxels' box is x 2.5..27.5, y 3.5..28.5, z
/// 1.5..26.5.
DisplacementField uniform_field(const glm::dvec3& displacement_mm, double fade_mm = 20.0) {
  const Tetrahedra elements = ball_of_elements();
  return {elements, std::vector<glm::dvec3>(elements.nodes_mm.size(), displacement_mm), fade_mm};
}

std::vector<glm::dvec3> random_points(double radius_mm, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
  std::vector<glm::dvec3> points;
  while (points.size() < 500) {
    const glm::dvec3 p(coordinate(random), coordinate(random), coordinate(random));
    if (glm::length(p) < 1.0) points.push_back(glm::dvec3(15, 16, 14) + radius_mm * p);
  }
  return points;
}

TEST(DisplacementField, AnAffineDisplacementIsExactWithinAndThatOfTheSurfaceAtTheBox) {
  const DisplacementField field = affine_field();
  const std::vector<glm::dvec3> inside = random_points(11.0, 1);
  const std::vector<glm::dvec3> found = field.at(inside);
  for (std::size_t i = 0; i < inside.size(); ++i)
    EXPECT_LT(glm::distance(found[i], affine(inside[i])), 1e-9) << i;
  // The ball's voxel farthest to the right ends at x = 27.5.
  const std::vector<glm::dvec3> outside = field.at({{27.5 + 1e-9, 16.0, 14.0}, {27.5, 16.0, 14.0}});
  EXPECT_LT(glm::distance(outside[0], affine({27.5, 16.0, 14.0})), 1e-6);
  EXPECT_LT(glm::distance(outside[1], affine({27.5, 16.0, 14.0})), 1e-9);
}

TEST(DisplacementField, FadesBeyondTheBoxToZeroAtItsDistanceAndIsHeldWithinTheBox) {
  const glm::dvec3 moved_mm(0.0, -4.0, 1.0);
  const DisplacementField field = uniform_field(moved_mm);
  // (1-r)^4 (4r+1) at r = 0, 1/4, 1/2, 1 and 2; the first is a corner of the box, outside of the ball.
  const std::vector<glm::dvec3> found =
      field.at({{27.5, 28.5, 26.5}, {32.5, 16, 14}, {15, 16, 36.5}, {47.5, 16, 14}, {15, -36.5, 14}});
  const std::array<double, 5> shares{1.0, 0.6328125, 0.1875, 0.0, 0.0};
  for (std::size_t i = 0; i < shares.size(); ++i)
    EXPECT_LT(glm::distance(found[i], shares[i] * moved_mm), 1e-9) << i;
  EXPECT_EQ(found[3], glm::dvec3(0.0));
  EXPECT_EQ(found[4], glm::dvec3(0.0));
}

TEST(DisplacementField, TheInverseLeadsBackBeyondTheBox) {
  const DisplacementField field = uniform_field({6.0, -5.0, 3.0});
  const DisplacementField back = field.inverse();
  for (const double x_mm : {27.6, 30.0, 33.0, 38.0, 44.0, 47.4, 60.0}) {
    const glm::dvec3 p_mm(x_mm, 16.0, 14.0);
    const glm::dvec3 there_mm = p_mm + field.at({p_mm})[0];
    EXPECT_LT(glm::distance(there_mm + back.at({there_mm})[0], p_mm), 1e-9) << x_mm;
  }
}

TEST(DisplacementField, MayNotFadeSoFastThatSpaceFolds) {
  EXPECT_DOUBLE_EQ(least_fade_mm(4.0), 8.4375);
  EXPECT_THROW(uniform_field({0, 4, 0}, 8.4375), std::invalid_argument);
  // Just above the limit, points along the direction of the motion keep their order.
  const DisplacementField field = uniform_field({0, 4, 0}, 8.44);
  double last_mm = 0.0;
  for (double y_mm = 28.0; y_mm < 40.0; y_mm += 0.05) {
    const double there_mm = y_mm + field.at({{15.0, y_mm, 14.0}})[0].y;
    EXPECT_GT(there_mm, last_mm) << y_mm;
    last_mm = there_mm;
  }
}

TEST(DisplacementField, TheInverseLeadsBackToWherePointsCameFrom) {
  const DisplacementField field = affine_field();
  EXPECT_TRUE(field.turned_over().empty());
  const std::vector<glm::dvec3> points = random_points(11.0, 2);
  const std::vector<glm::dvec3> there = field.at(points);
  std::vector<glm::dvec3> displaced;
  for (std::size_t i = 0; i < points.size(); ++i) displaced.push_back(points[i] + there[i]);
  const std::vector<glm::dvec3> back = field.inverse().at(displaced);
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_LT(glm::distance(displaced[i] + back[i], points[i]), 1e-9) << i;
}

TEST(DisplacementField, ElementsPushedThroughThemselvesAreFoundWithTheirPlace) {
  const Tetrahedra elements = ball_of_elements();
  std::vector<glm::dvec3> mirrored;
  for (const glm::dvec3& p_mm : elements.nodes_mm) mirrored.push_back({-3.0 * p_mm.x, 0.0, 0.0});
  const std::vector<TurnedOver> all = DisplacementField(elements, mirrored, 200.0).turned_over();
  ASSERT_EQ(all.size(), elements.tets.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_NEAR(all[i].volume_ratio, -2.0, 1e-9);
    const TetCorners c = corners_mm(elements, i);
    EXPECT_LT(glm::distance(all[i].centre_mm, (c[0] + c[1] + c[2] + c[3]) / 4.0), 1e-9);
  }
}

TEST(DisplacementField, AWarpedSurfaceHasTheVolumeOfItsStretch) {
  const brep::Mesh small = brep::mesh_of(tests::ball({15, 16, 14}, 8.0, 3));
  const brep::Mesh displaced = warped(small, affine_field());
  // The determinant of 1 + the displacement's gradient.
  const glm::dmat3 gradient(glm::dvec3(1.1, 0.0, 0.03), glm::dvec3(-0.05, 1.0, 0.0),
                            glm::dvec3(0.0, 0.02, 1.08));
  EXPECT_NEAR(brep::measure(displaced).volume_mm3 / brep::measure(small).volume_mm3,
              glm::determinant(gradient), 1e-9);
}

TEST(DisplacementField, AWarpedScanShowsWhatWasThereBefore) {
  // Samples that are linear in space stay so under an affine displacement, to the rounding of samples.
  voxel::Scene scan;
  scan.lattice = voxel::axis_aligned_lattice(glm::ivec3(30), glm::dvec3(1.0), glm::dvec3(0.0));
  voxel::Int16Samples samples;
  for (int z = 0; z < 30; ++z)
    for (int y = 0; y < 30; ++y)
      for (int x = 0; x < 30; ++x) samples.push_back(static_cast<std::int16_t>(100 * x + 10 * y - 30 * z));
  scan.samples = std::move(samples);
  const Tetrahedra elements = ball_of_elements();
  const DisplacementField moved(elements,
                                std::vector<glm::dvec3>(elements.nodes_mm.size(), {0.5, 0.25, -1.0}), 20.0);
  const voxel::Scene after = warped(scan, moved);
  const auto& before_samples = std::get<voxel::Int16Samples>(scan.samples);
  const auto& after_samples = std::get<voxel::Int16Samples>(after.samples);
  const auto at = [](int x, int y, int z) { return static_cast<std::size_t>(x + 30 * (y + 30 * z)); };
  for (const auto& [x, y, z] : {std::array{15, 16, 14}, {12, 13, 9}, {20, 20, 10}})
    EXPECT_NEAR(after_samples[at(x, y, z)], before_samples[at(x, y, z)] - 100 * 0.5 - 10 * 0.25 - 30 * 1.0,
                0.51);
  EXPECT_EQ(
      std::get<voxel::Int16Samples>(
          warped(scan, DisplacementField(elements, std::vector<glm::dvec3>(elements.nodes_mm.size()), 20.0))
              .samples),
      before_samples);
}

TEST(DisplacementField, NeedsElementsAndADisplacementANode) {
  EXPECT_THROW(DisplacementField({}, {}, 20.0), std::invalid_argument);
  EXPECT_THROW(DisplacementField(ball_of_elements(), {{1, 0, 0}}, 20.0), std::invalid_argument);
}

class SolvedFile : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) const {
    std::ofstream(folder_ / "a.frd") << text;
    return folder_ / "a.frd";
  }
  /// One element whose fourth node is raised.
  std::string text_ =
      "    1C\n"
      "    2C                             4                                     1\n"
      " -1         1 0.00000E+00 0.00000E+00 0.00000E+00\n"
      " -1         2 1.00000E+00 0.00000E+00 0.00000E+00\n"
      " -1         3 0.00000E+00 1.00000E+00 0.00000E+00\n"
      " -1         4 0.00000E+00-1.00000E+00 2.00000E+00\n"
      " -3\n"
      "    3C                             1                                     1\n"
      " -1         1    3    0    1\n"
      " -2         1         2         3         4\n"
      " -3\n"
      " -4  DISP        4    1\n"
      " -5  D1          1    2    1    0\n"
      " -1         1 0.00000E+00 0.00000E+00 0.00000E+00\n"
      " -1         2 0.00000E+00 0.00000E+00 0.00000E+00\n"
      " -1         3 0.00000E+00 0.00000E+00 0.00000E+00\n"
      " -1         4 0.00000E+00 0.00000E+00-5.00000E-01\n"
      " -3\n";
  tests::ScratchFolder folder_;
};

TEST_F(SolvedFile, IsReadWithItsNodesElementsAndDisplacements) {
  std::vector<double> reported;
  const SolvedDeck deck =
      read_solved_deck(write(text_), {{}, [&](double fraction) { reported.push_back(fraction); }});
  EXPECT_EQ(reported, (std::vector<double>{0.0, 1.0}));
  ASSERT_EQ(deck.tetrahedra.tets.size(), 1u);
  EXPECT_EQ(deck.tetrahedra.nodes_mm[3], glm::dvec3(0, -1, 2));
  EXPECT_EQ(deck.displacement_mm[3], glm::dvec3(0, 0, -0.5));
  EXPECT_EQ(deck.tetrahedra.boundary_nodes.size(), 4u);
}

TEST_F(SolvedFile, IsRefusedWithItsLineWhereItIsDamaged) {
  const auto refusal = [&](const std::string& from, const std::string& to) {
    std::string text = text_;
    text.replace(text.find(from), from.size(), to);
    try {
      read_solved_deck(write(text));
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refusal("    3    0    1", "    4    0    1").find("line 9"), std::string::npos);
  EXPECT_NE(refusal("         3         4\n", "         3         9\n").find("line 10"), std::string::npos);
  EXPECT_NE(refusal(" -1         2 1.0", " -1         7 1.0").find("line 4"), std::string::npos);
  EXPECT_NE(refusal("-5.00000E-01", "NaN         ").find("line 17"), std::string::npos);
  EXPECT_NE(refusal(" -1         4 0.00000E+00 0.00000E+00-5.00000E-01\n", "").find("node 4"),
            std::string::npos);
  EXPECT_NE(refusal(" -4  DISP", " -4  STRS").find("no displacements"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::convert
