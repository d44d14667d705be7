// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/voxel/winding_number.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <random>
#include <set>
#include <tbb/global_control.h>

#include "brep/io/read_mesh.h"
#include "brep/mesh/distance.h"
#include "brep/mesh/health.h"
#include "convert/voxel/voxelise.h"
#include "tests/convert/surfaces.h"
#include "tests/reference_data.h"
#include "tests/unit_universe.h"
#include "voxel/scan/read_scene.h"

namespace octotomy::convert {
namespace {

using tests::ball;
using tests::box;
using tests::inside_out;
using tests::together;
using tests::unit_universe;

/// The universe of a surface, with space around it.
voxel::Universe universe_of(const brep::Triangles& surface, int side) {
  voxel::Box box{surface.points_mm[0], surface.points_mm[0]};
  for (const glm::dvec3& p : surface.points_mm) {
    box.low_mm = glm::min(box.low_mm, p);
    box.high_mm = glm::max(box.high_mm, p);
  }
  const glm::dvec3 extent = box.high_mm - box.low_mm;
  return voxel::universe_around(box, 1.05 * std::max({extent.x, extent.y, extent.z}) / side);
}

/// The first voxel that contradicts the sum of solid angles, or none. Centres at which that sum is within
/// rounding of a half are skipped.
std::string first_difference(const voxel::Octree& octree, const brep::Triangles& surface) {
  const int side = octree.universe().side();
  const voxel::Lattice lattice = octree.universe().lattice();
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double winds = winding_number(surface, lattice.lps_mm({x, y, z}));
        if (std::abs(winds - 0.5) > 1e-9 && octree.contains({x, y, z}) != (winds > 0.5))
          return "voxel " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) +
                 " against a winding number of " + std::to_string(winds);
      }
  return "";
}

TEST(WindingNumber, IsOneInsideAndNoneOutsideOfAClosedSurface) {
  const brep::Triangles solid = ball({1, 2, 3}, 5.0, 2);
  EXPECT_NEAR(winding_number(solid, {1, 2, 3}), 1.0, 1e-12);
  EXPECT_NEAR(winding_number(solid, {4, 2, 5}), 1.0, 1e-12);
  EXPECT_NEAR(winding_number(solid, {9, 2, 3}), 0.0, 1e-12);
  EXPECT_NEAR(winding_number(inside_out(solid), {1, 2, 3}), -1.0, 1e-12);
}

TEST(WindingNumber, OfABoxWithoutItsLidIsFiveSixthsInTheMiddle) {
  brep::Triangles open = box({-1, -1, -1}, {1, 1, 1});
  open.faces.erase(open.faces.begin(), open.faces.begin() + 2);
  EXPECT_NEAR(winding_number(open, {0, 0, 0}), 5.0 / 6.0, 1e-12);
}

TEST(WindingNumber, VoxelsOfAClosedSolidAreThoseOfParityInEveryPoseAndHandedness) {
  for (const double mirror : {1.0, -1.0}) {
    voxel::Universe universe = unit_universe(6);
    universe.lps_from_voxel = glm::rotate(glm::dmat4(1.0), 0.3, glm::dvec3(1, -2, 0.5)) *
                              glm::scale(glm::dmat4(1.0), glm::dvec3(1, mirror, 0.9));
    const glm::dvec3 centre = universe.lattice().lps_mm(glm::dvec3(31.7));
    const brep::Triangles solid = together(ball(centre, 24.0, 4), inside_out(ball(centre + 2.0, 11.0, 4)));
    const voxel::Octree wound = voxelise_by_winding_number(universe, solid);
    EXPECT_TRUE(wound == voxelise(universe, brep::linked(solid)));
    EXPECT_GT(wound.voxel_count(), 30000U);
  }
}

TEST(WindingNumber, VerticesAndFacesOnCentresFollowTheSameRuleAsParity) {
  const voxel::Universe universe = unit_universe(5);
  for (const brep::Triangles& solid : {box({3, 4, 5}, {13, 11, 30}), tests::octahedron({15, 16, 14}, 9)})
    EXPECT_TRUE(voxelise_by_winding_number(universe, solid) == voxelise(universe, brep::linked(solid)));
}

TEST(WindingNumber, ASurfaceWithHolesAgreesWithTheSumOfSolidAnglesInEveryVoxel) {
  std::uint64_t undecided = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    std::mt19937 random(seed);
    brep::Triangles surface = ball({15.3, 15.8, 16.1}, 11.2, 2);
    const std::size_t whole = surface.faces.size();
    for (std::size_t i = surface.faces.size(); i-- > 0;)
      if (random() % 8 < seed % 4)
        surface.faces.erase(surface.faces.begin() + static_cast<std::ptrdiff_t>(i));
    if (seed % 3 == 1) std::swap(surface.faces[5][0], surface.faces[5][1]);  // one turned round
    if (seed % 3 == 2) surface.faces.push_back(surface.faces[7]);            // one twice
    undecided += whole - surface.faces.size();
    voxel::Universe universe = unit_universe(5);
    universe.lps_from_voxel = glm::scale(glm::dmat4(1.0), glm::dvec3(1.0, 1.0, seed % 2 == 0 ? 1.0 : 1.1));
    EXPECT_EQ(first_difference(voxelise_by_winding_number(universe, surface), surface), "")
        << "seed " << seed;
  }
  EXPECT_GT(undecided, 100U);
}

/// A box without a side, which is inside out, or has corners moved.
brep::Triangles damaged_box(double side, std::mt19937& random) {
  const auto within = [&](double low, double high) {
    return (low + (high - low) * static_cast<double>(random() % 1000) / 1000.0) * side;
  };
  brep::Triangles open = box({within(0.0, 0.3), within(0.0, 0.3), within(0.0, 0.3)},
                             {within(0.6, 1.1), within(0.6, 1.1), within(0.6, 1.1)});
  if (random() % 3 == 0) open = inside_out(open);
  if (random() % 2 == 0)
    open.points_mm[random() % 8] += glm::dvec3(within(-1, 3), within(-1, 3), within(-1, 3));
  const std::size_t lost = 2 * (random() % 6);
  open.faces.erase(open.faces.begin() + static_cast<std::ptrdiff_t>(lost),
                   open.faces.begin() + static_cast<std::ptrdiff_t>(lost + 1 + random() % 2));
  return open;
}

TEST(WindingNumber, UniversesOfEveryDepthAgreeWithTheSumOfSolidAngles) {
  std::uint64_t inside = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937 random(seed);
    const voxel::Universe universe = unit_universe(2 + static_cast<int>(seed % 5));
    const brep::Triangles open = damaged_box(universe.side(), random);
    const voxel::Octree wound = voxelise_by_winding_number(universe, open);
    EXPECT_EQ(first_difference(wound, open), "") << "seed " << seed;
    inside += wound.voxel_count();
  }
  EXPECT_GT(inside, 100000U);
}

TEST(WindingNumber, AFarVertexAndTheLargestUniverseLeaveTheVoxelsOfASmallOne) {
  for (const glm::dvec3& far : {glm::dvec3(3990, 0, 0), glm::dvec3(2900, 2300, 1800)}) {
    brep::Triangles open = ball({40.3, 41.2, 39.4}, 30.7, 4);
    const auto moved = std::max_element(
        open.points_mm.begin(), open.points_mm.end(),
        [&far](const glm::dvec3& a, const glm::dvec3& b) { return glm::dot(a, far) < glm::dot(b, far); });
    *moved += far;
    const auto vertex = static_cast<std::uint32_t>(moved - open.points_mm.begin());
    open.faces.erase(std::find_if(open.faces.begin(), open.faces.end(), [vertex](const auto& face) {
      return std::find(face.begin(), face.end(), vertex) != face.end();
    }));
    const voxel::Octree large = voxelise_by_winding_number(unit_universe(voxel::Universe::max_depth), open);
    const voxel::Octree small = voxelise_by_winding_number(unit_universe(7), open);
    EXPECT_GT(small.voxel_count(), 100000U);
    EXPECT_GT(large.voxel_count(), small.voxel_count());
    std::uint64_t different = 0;
    for (int z = 0; z < 128; ++z)
      for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 128; ++x) different += large.contains({x, y, z}) != small.contains({x, y, z});
    EXPECT_EQ(different, 0U);
  }
}

TEST(WindingNumber, ReportsWhatIsDoneUpToAll) {
  // Only the calling thread reports. Alone, it does all slabs.
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  std::vector<double> reported;
  voxelise_by_winding_number(unit_universe(6), ball({31.2, 30.7, 33.1}, 25.0, 2),
                             {{}, [&](double fraction) { reported.push_back(fraction); }});
  ASSERT_GT(reported.size(), 16U) << "not every slab";
  EXPECT_TRUE(std::is_sorted(reported.begin(), reported.end()));
  EXPECT_EQ(reported.back(), 1.0);
}

TEST(WindingNumber, TheComparisonSeesTrianglesLost) {
  const brep::Triangles whole = ball({15.3, 15.8, 16.1}, 11.2, 1);
  brep::Triangles holed = whole;
  holed.faces.resize(holed.faces.size() - 8);
  EXPECT_NE(first_difference(voxelise_by_winding_number(unit_universe(5), whole), holed), "");
}

TEST(WindingNumber, AFlatHoleInAPlaneOfCentresIsClosedInTheMiddle) {
  brep::Triangles open = box({3.7, 3.7, 3.7}, {20.3, 20.3, 20});
  open.faces.erase(open.faces.begin() + 2, open.faces.begin() + 4);  // z = 20
  EXPECT_EQ(first_difference(voxelise_by_winding_number(unit_universe(5), open), open), "");
}

TEST(WindingNumber, OverlapsAreInsideOnceAndNotCutOutAsByParity) {
  const brep::Triangles two =
      together(box({2.5, 2.5, 2.5}, {9.5, 9.5, 9.5}), box({6.5, 6.5, 6.5}, {12.5, 12.5, 12.5}));
  const voxel::Octree octree = voxelise_by_winding_number(unit_universe(4), two);
  EXPECT_EQ(octree.voxel_count(), 343U + 216U - 27U);
  EXPECT_LT(voxelise(unit_universe(4), brep::linked(two)).voxel_count(), octree.voxel_count());
}

TEST(WindingNumber, ATriangleThatNamesNoPointIsRefused) {
  brep::Triangles bad = box({1, 1, 1}, {5, 5, 5});
  bad.faces[3][1] = 8;
  EXPECT_THROW(voxelise_by_winding_number(unit_universe(4), bad), voxel::Error);
}

TEST(WindingNumber, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(
      voxelise_by_winding_number(unit_universe(5), box({1, 1, 1}, {5, 5, 5}), {stop.get_token(), {}}),
      voxel::Stopped);
}

TEST(WindingNumber, GivesTheSameOctreeOnOneThreadAndMany) {
  brep::Triangles open = ball({31.2, 30.7, 33.1}, 25.0, 4);
  open.faces.resize(open.faces.size() - 60);
  const voxel::Octree many = voxelise_by_winding_number(unit_universe(6), open);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_TRUE(voxelise_by_winding_number(unit_universe(6), open) == many);
}

/// Sound meshes of the reference data are broken in the ways of scanners and exporters. Voxels away from the
/// damage must not change.
class Broken : public testing::TestWithParam<const char*> {};

TEST_P(Broken, VoxelsAwayFromTheDamageAreThoseOfTheSoundTwin) {
  OCTOTOMY_NEEDS_DATA("meshes");
  const brep::Triangles sound =
      brep::read_triangles(tests::reference_data(std::string("meshes/") + GetParam()));
  const voxel::Universe universe = universe_of(sound, 64);
  const voxel::Octree truth = voxelise(universe, brep::linked(sound));
  const double voxel_mm = universe.lattice().spacing_mm().x;

  std::mt19937 random(7);
  brep::Triangles broken = sound;
  std::vector<glm::dvec3> damage_mm;
  for (int i = 0; i < 40; ++i) {
    const std::size_t face = random() % broken.faces.size();
    for (const std::uint32_t v : broken.faces[face]) damage_mm.push_back(broken.points_mm[v]);
    if (i % 4 == 0)
      std::swap(broken.faces[face][0], broken.faces[face][1]);
    else if (i % 4 == 1)
      broken.faces.push_back(broken.faces[face]);
    else
      broken.faces.erase(broken.faces.begin() + static_cast<std::ptrdiff_t>(face));
  }
  ASSERT_FALSE(brep::health(broken, {.self_intersections = false}).closed);

  const voxel::Octree wound = voxelise_by_winding_number(universe, broken);
  std::uint64_t looked_at = 0;
  std::uint64_t different = 0;
  for (int z = 0; z < universe.side(); ++z)
    for (int y = 0; y < universe.side(); ++y)
      for (int x = 0; x < universe.side(); ++x) {
        const glm::dvec3 p_mm = universe.lattice().lps_mm({x, y, z});
        bool near = false;
        for (const glm::dvec3& d : damage_mm) near = near || glm::distance(d, p_mm) < 2.0 * voxel_mm;
        if (near) continue;
        ++looked_at;
        different += wound.contains({x, y, z}) != truth.contains({x, y, z});
      }
  EXPECT_GT(looked_at, 200000U);
  EXPECT_LE(static_cast<double>(different), 0.001 * static_cast<double>(truth.voxel_count()))
      << different << " of " << truth.voxel_count();
  EXPECT_FALSE(wound == truth);  // the damage is real
}

INSTANTIATE_TEST_SUITE_P(WindingNumber, Broken, testing::Values("cgal_femur.off", "ballA.off"),
                         [](const auto& name) {
                           return std::string(name.param).substr(0, std::string(name.param).find('.'));
                         });

TEST(WindingNumber, RealBrokenMeshesAgreeWithTheSumOfSolidAngles) {
  OCTOTOMY_NEEDS_DATA("meshes");
  for (const char* name : {"trimesh_bunny_nonmanifold.ply", "fran_cut.vtk", "trimesh_octagonal_pocket.stl"}) {
    const brep::Triangles broken = brep::read_triangles(tests::reference_data(std::string("meshes/") + name));
    const voxel::Universe universe = universe_of(broken, 16);
    EXPECT_EQ(first_difference(voxelise_by_winding_number(universe, broken), broken), "") << name;
  }
}

}  // namespace
}  // namespace octotomy::convert
