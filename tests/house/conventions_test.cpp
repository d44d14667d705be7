// SPDX-License-Identifier: AGPL-3.0-or-later
// Frames, orders, signs and windings that every room relies on. Each test fails if its convention is flipped.
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "brep/mesh/measure.h"
#include "brep/mesh/triangles.h"
#include "convert/surface/isosurface.h"
#include "convert/voxel/voxelise.h"
#include "voxel/solid/combine.h"
#include "voxel/space/scene.h"
#include "voxel/space/view.h"
#include "voxel/tree/octree_node.h"

namespace octotomy {
namespace {

TEST(Conventions, IntegerIndexIsTheVoxelsCentre) {
  const voxel::Lattice lattice = voxel::axis_aligned_lattice({4, 4, 4}, {2, 2, 2}, {10, 20, 30});
  EXPECT_EQ(lattice.lps_mm({0, 0, 0}), glm::dvec3(10, 20, 30));
  EXPECT_EQ(voxel::bounds(lattice).low_mm, glm::dvec3(9, 19, 29));
}

TEST(Conventions, StorageIsXFastest) {
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice({2, 3, 4}, {1, 1, 1}, {0, 0, 0});
  voxel::Int16Samples samples(24, 0);
  samples[1] = 100;  // (1, 0, 0)
  samples[2] = 200;  // (0, 1, 0)
  samples[6] = 300;  // (0, 0, 1)
  scene.samples = samples;
  EXPECT_EQ(voxel::interpolate(scene, {1, 0, 0}), 100);
  EXPECT_EQ(voxel::interpolate(scene, {0, 1, 0}), 200);
  EXPECT_EQ(voxel::interpolate(scene, {0, 0, 1}), 300);
}

TEST(Conventions, AnOctantsChildNumberIsXPlus2YPlus4Z) {
  // The physical node's 64 children are numbered alike with base four; the logical octant (x, y, z) is the 2
  // x 2 x 2 group of them from (2x, 2y, 2z) on.
  EXPECT_EQ(voxel::child_index(1, 0, 0), 1);
  EXPECT_EQ(voxel::child_index(0, 1, 0), 4);
  EXPECT_EQ(voxel::child_index(0, 0, 1), 16);
  EXPECT_EQ(voxel::octant_children, 0x0000000000330033ULL);
}

TEST(Conventions, ViewsLookAndLieAsInTheContract) {
  struct Row {
    const char* name;
    glm::dvec3 look, up, right;
  };
  const Row rows[] = {
      {"anterior", {0, 1, 0}, {0, 0, 1}, {1, 0, 0}},    {"posterior", {0, -1, 0}, {0, 0, 1}, {-1, 0, 0}},
      {"left", {-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},       {"right", {1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
      {"superior", {0, 0, -1}, {0, -1, 0}, {-1, 0, 0}}, {"inferior", {0, 0, 1}, {0, -1, 0}, {1, 0, 0}},
  };
  for (const Row& row : rows) {
    const voxel::View view = voxel::parse_view(row.name);
    EXPECT_EQ(view.look, row.look) << row.name;
    EXPECT_EQ(view.up, row.up) << row.name;
    EXPECT_EQ(view.right, row.right) << row.name;
    EXPECT_EQ(view.right, glm::cross(view.look, view.up)) << row.name;
  }
}

TEST(Conventions, AzimuthTurnsTowardsThePatientsLeftAndElevationUpwards) {
  const auto near = [](const glm::dvec3& a, const glm::dvec3& b) { return glm::distance(a, b) < 1e-12; };
  EXPECT_TRUE(near(voxel::parse_view("0,0").look, {0, 1, 0}));
  EXPECT_TRUE(near(voxel::parse_view("90,0").look, voxel::parse_view("left").look));
  EXPECT_TRUE(near(voxel::parse_view("90,0").right, voxel::parse_view("left").right));
  // From above and in front: looking back and down.
  const voxel::View raised = voxel::parse_view("0,30");
  EXPECT_LT(raised.look.z, 0.0);
  EXPECT_GT(raised.look.y, 0.0);
  EXPECT_GT(raised.up.z, 0.0);
  for (const char* wrong : {"front", "30", "30,", "30,100", "a,b", "30,20x", "nan,0", ""})
    EXPECT_THROW(voxel::parse_view(wrong), std::invalid_argument) << wrong;
}

TEST(Conventions, GlmTakesColumnVectorsAndRadians) {
  const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), glm::radians(90.0), glm::dvec3(0, 0, 1));
  const glm::dvec3 p(turn * glm::dvec4(1, 0, 0, 1));
  EXPECT_NEAR(glm::distance(p, glm::dvec3(0, 1, 0)), 0.0, 1e-15);
}

// A box of samples well inside a scan, away from the origin so that a flip of any axis shows.
voxel::Scene box_scene(double x_direction) {
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice({20, 20, 20}, {1, 1, 1}, {100, -40, 7});
  scene.lattice.lps_from_voxel[0][0] = x_direction;
  voxel::Int16Samples samples(8000, 0);
  for (int z = 5; z < 9; ++z)
    for (int y = 4; y < 10; ++y)
      for (int x = 3; x < 15; ++x) samples[static_cast<std::size_t>(x + 20 * (y + 20 * z))] = 1000;
  scene.samples = samples;
  return scene;
}

TEST(Conventions, TrianglesWindCounterClockwiseSeenFromOutsideWhateverTheLatticesHandedness) {
  for (const double x_direction : {1.0, -1.0}) {
    const brep::Mesh mesh = brep::mesh_of(convert::isosurface(box_scene(x_direction), 500, 2000));
    const brep::Measures m = brep::measure(mesh);
    EXPECT_GT(m.volume_mm3, 12 * 6 * 4 * 0.9) << "x direction " << x_direction;
    EXPECT_LT(m.volume_mm3, 12 * 6 * 4);
    // The box lies where its samples lie.
    ASSERT_TRUE(m.centroid_mm.has_value());
    EXPECT_NEAR(glm::distance(*m.centroid_mm, glm::dvec3(100 + x_direction * 8.5, -40 + 6.5, 7 + 6.5)), 0.0,
                1e-9);
  }
}

TEST(Conventions, BothKernelsPutAnObjectInTheSamePlace) {
  const voxel::Scene scene = box_scene(1.0);
  const voxel::Universe universe = voxel::universe_around(voxel::bounds(scene.lattice), 1.0);
  const brep::Mesh mesh = brep::mesh_of(convert::isosurface(scene, 500, 2000));
  const voxel::Octree from_mesh = convert::voxelise(universe, brep::linked_of(mesh));
  const voxel::Octree from_samples =
      voxel::combine(universe, voxel::Window{voxel::grey_octree_of(universe, scene), 500, 2000});
  EXPECT_EQ(from_mesh.voxel_count(), from_samples.voxel_count());
  EXPECT_TRUE(from_mesh == from_samples);
}

}  // namespace
}  // namespace octotomy
