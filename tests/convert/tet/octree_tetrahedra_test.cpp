// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/octree_tetrahedra.h"

#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <unistd.h>

#include "convert/deck/deck.h"
#include "tests/unit_universe.h"
#include "voxel/codes/cuberille_faces.h"
#include "voxel/solid/combine.h"
#include "voxel/space/memory_need.h"
#include "voxel/tree/build.h"

namespace octotomy::convert {
namespace {

using tests::unit_universe;

/// Random cubes of random sizes: cells of every size beside each other.
voxel::Octree random_cubes(int depth, unsigned seed) {
  const voxel::Universe universe = unit_universe(depth);
  std::mt19937 random(seed);
  voxel::Expression all = voxel::Octree::empty(universe);
  for (int i = 0; i < 12; ++i) {
    const int side = 1 << (random() % static_cast<unsigned>(depth));
    const auto at = [&] {
      return static_cast<int>(random() % static_cast<unsigned>(universe.side() / side)) * side;
    };
    const glm::dvec3 low = glm::dvec3(at(), at(), at()) - 0.5;
    all = i % 4 == 3 ? all - voxel::Box{low, low + static_cast<double>(side)}
                     : all | voxel::Box{low, low + static_cast<double>(side)};
  }
  return voxel::combine(universe, all);
}

/// The reason why the elements do not fill the voxels exactly or do not share whole faces; empty if they do.
std::string fault_of(const voxel::Octree& octree, const Tetrahedra& t) {
  std::map<std::array<std::uint32_t, 3>, int> faces;
  for (const auto& [a, b, c, d] : t.tets)
    for (std::array<std::uint32_t, 3> face : {std::array{a, b, c}, {a, b, d}, {a, c, d}, {b, c, d}}) {
      std::sort(face.begin(), face.end());
      ++faces[face];
    }
  double boundary_mm2 = 0.0;
  for (const auto& [face, count] : faces) {
    if (count > 2) return "a face of three elements";
    if (count == 1)
      boundary_mm2 += 0.5 * glm::length(glm::cross(t.nodes_mm[face[1]] - t.nodes_mm[face[0]],
                                                   t.nodes_mm[face[2]] - t.nodes_mm[face[0]]));
  }
  const TetQuality q = quality(t);
  if (!(q.min_volume_mm3 > 0.0)) return "an element of volume " + std::to_string(q.min_volume_mm3);
  if (std::abs(q.volume_mm3 - static_cast<double>(octree.voxel_count())) > 1e-6)
    return "volume " + std::to_string(q.volume_mm3) + " of " + std::to_string(octree.voxel_count()) +
           " voxels";
  // Faces that do not match leave boundary within.
  const auto exposed = static_cast<double>(voxel::cuberille_faces(octree).face_count());
  if (std::abs(boundary_mm2 - exposed) > 1e-6)
    return "boundary " + std::to_string(boundary_mm2) + " of " + std::to_string(exposed) + " faces";
  if (q.min_dihedral_deg < 30.0 - 1e-9) return "a dihedral angle of " + std::to_string(q.min_dihedral_deg);
  return "";
}

TEST(OctreeTetrahedra, OneVoxelIsTwelveElements) {
  const voxel::Octree octree = voxel::combine(unit_universe(2), voxel::Box{{0.5, 0.5, 0.5}, {1.5, 1.5, 1.5}});
  const Tetrahedra t = tetrahedra_of(octree);
  EXPECT_EQ(t.tets.size(), 12U);
  EXPECT_EQ(t.nodes_mm.size(), 9U);
  EXPECT_EQ(fault_of(octree, t), "");
}

TEST(OctreeTetrahedra, FillRandomCubesOfEverySizeExactlyAndConform) {
  std::size_t graded = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const voxel::Octree octree = random_cubes(3 + static_cast<int>(seed % 3), seed);
    if (octree.is_empty()) continue;
    const Tetrahedra t = tetrahedra_of(octree);
    EXPECT_EQ(fault_of(octree, t), "") << "seed " << seed;
    graded += t.tets.size() < 12 * octree.voxel_count();
  }
  EXPECT_GT(graded, 40U);
}

TEST(OctreeTetrahedra, TheProofSeesAMissingAndATurnedElement) {
  const voxel::Octree octree = random_cubes(4, 3);
  Tetrahedra t = tetrahedra_of(octree);
  std::swap(t.tets[5][0], t.tets[5][1]);
  EXPECT_NE(fault_of(octree, t), "");
  t = tetrahedra_of(octree);
  t.tets.pop_back();
  EXPECT_NE(fault_of(octree, t), "");
}

TEST(OctreeTetrahedra, ABallHasFarFewerElementsThanItsVoxelsWould) {
  const voxel::Octree ball = voxel::combine(unit_universe(6), voxel::Sphere{{31, 32, 30}, 27.0});
  const Tetrahedra t = tetrahedra_of(ball);
  EXPECT_EQ(fault_of(ball, t), "");
  EXPECT_LT(t.tets.size(), 6 * ball.voxel_count());
  EXPECT_FALSE(t.boundary_nodes.empty());
  EXPECT_EQ(t.method, "octree");
}

TEST(OctreeTetrahedra, CellsAtTheBoundaryAreVoxelsWhereAskedFor) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const voxel::Octree octree = random_cubes(4, seed);
    if (octree.is_empty()) continue;
    const Tetrahedra t = tetrahedra_of(octree, BoundaryCells::Voxels);
    EXPECT_EQ(fault_of(octree, t), "") << "seed " << seed;
    EXPECT_EQ(surface_faces(t).size(), 2 * voxel::cuberille_faces(octree).face_count()) << "seed " << seed;
  }
  const voxel::Octree cube =
      voxel::combine(unit_universe(5), voxel::Box{{7.5, 7.5, 7.5}, {23.5, 23.5, 23.5}});
  const Tetrahedra t = tetrahedra_of(cube, BoundaryCells::Voxels);
  EXPECT_EQ(fault_of(cube, t), "");
  EXPECT_LT(t.tets.size(), 9 * cube.voxel_count());
  EXPECT_LT(surface_faces(tetrahedra_of(cube)).size(), surface_faces(t).size());
}

TEST(OctreeTetrahedra, RegionsOfRandomCubesShareTheirInterfacesAndNoneReachesIntoAnother) {
  std::size_t touching = 0;
  for (unsigned seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const voxel::Octree a = random_cubes(4, seed);
    const voxel::Octree b = voxel::combine(a.universe(), voxel::Expression(random_cubes(4, seed + 1000)) - a);
    if (a.is_empty() || b.is_empty()) continue;
    const voxel::Octree both = voxel::combine(a.universe(), voxel::Expression(a) | b);
    for (const BoundaryCells cells : {BoundaryCells::Nodes, BoundaryCells::Voxels}) {
      const Tetrahedra t = tetrahedra_of({a, b}, cells);
      EXPECT_EQ(fault_of(both, t), "");
      std::array<double, 2> volumes{};
      for (std::size_t i = 0; i < t.tets.size(); ++i)
        volumes.at(t.region_of_tet[i]) += six_volumes(corners_mm(t, i)) / 6.0;
      EXPECT_NEAR(volumes[0], static_cast<double>(a.voxel_count()), 1e-6);
      EXPECT_NEAR(volumes[1], static_cast<double>(b.voxel_count()), 1e-6);

      // The interface's area is half of the surface that the two regions have in addition to that of both
      // together.
      double area_mm2 = 0.0;
      for (const Interface& between : interfaces(t))
        for (const ElementFace& face : between.faces) {
          EXPECT_EQ(t.region_of_tet[face.tet], 0U);
          const auto [p, q, r] = corners_of(t, face);
          area_mm2 +=
              0.5 * glm::length(glm::cross(t.nodes_mm[q] - t.nodes_mm[p], t.nodes_mm[r] - t.nodes_mm[p]));
        }
      const auto faces = [](const voxel::Octree& o) {
        return static_cast<double>(voxel::cuberille_faces(o).face_count());
      };
      EXPECT_NEAR(area_mm2, 0.5 * (faces(a) + faces(b) - faces(both)), 1e-6);
      touching += area_mm2 > 0.0;
    }
  }
  EXPECT_GT(touching, 20U);
}

TEST(OctreeTetrahedra, WhatIsInTwoRegionsIsTheFirsts) {
  const voxel::Octree a = voxel::combine(unit_universe(3), voxel::Box{{-0.5, -0.5, -0.5}, {3.5, 3.5, 3.5}});
  const voxel::Octree b = voxel::combine(unit_universe(3), voxel::Box{{-0.5, -0.5, -0.5}, {3.5, 3.5, 5.5}});
  const Tetrahedra t = tetrahedra_of({a, b});
  double first = 0.0;
  for (std::size_t i = 0; i < t.tets.size(); ++i)
    if (t.region_of_tet[i] == 0) first += six_volumes(corners_mm(t, i)) / 6.0;
  EXPECT_NEAR(first, 64.0, 1e-9);
  EXPECT_NEAR(quality(t).volume_mm3, 96.0, 1e-9);
}

/// A checksum of nodes, elements, boundary and regions, including their order.
std::uint64_t sum_of(const Tetrahedra& t) {
  std::uint64_t sum = 14695981039346656037U;  // FNV-1a
  const auto add = [&sum](const void* data, std::size_t bytes) {
    for (std::size_t i = 0; i < bytes; ++i)
      sum = (sum ^ static_cast<const unsigned char*>(data)[i]) * 1099511628211U;
  };
  add(t.nodes_mm.data(), t.nodes_mm.size() * sizeof t.nodes_mm[0]);
  add(t.tets.data(), t.tets.size() * sizeof t.tets[0]);
  add(t.boundary_nodes.data(), t.boundary_nodes.size() * sizeof t.boundary_nodes[0]);
  add(t.region_of_tet.data(), t.region_of_tet.size() * sizeof t.region_of_tet[0]);
  return sum;
}

TEST(OctreeTetrahedra, NodesAndElementsStandInTheOrderInWhichDecksNumberThem) {
  // Frozen, because decks on disk refer to nodes and elements by these numbers.
  const voxel::Universe universe = unit_universe(5);
  const voxel::Octree ball = voxel::combine(universe, voxel::Sphere{{15.3, 16.1, 14.2}, 12.7});
  const voxel::Octree slab = voxel::combine(universe, voxel::Box{{-0.5, -0.5, 3.5}, {31.5, 20.5, 19.5}});
  EXPECT_EQ(sum_of(tetrahedra_of(ball)), 0x3cd099787fc59046U);
  EXPECT_EQ(sum_of(tetrahedra_of(ball, BoundaryCells::Voxels)), 0x617f26deec817024U);
  EXPECT_EQ(sum_of(tetrahedra_of({slab, ball})), 0xc66ee927486e3fc1U);
  EXPECT_EQ(sum_of(tetrahedra_of({slab, ball}, BoundaryCells::Voxels)), 0x4b8efbf8cbe85c29U);
}

TEST(OctreeTetrahedra, BoundaryNodesAreThoseOfFacesOfOneElement) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    const voxel::Octree a = random_cubes(4, seed), b = random_cubes(4, seed + 1000);
    if (a.is_empty() || b.is_empty()) continue;
    for (const BoundaryCells cells : {BoundaryCells::Nodes, BoundaryCells::Voxels}) {
      const Tetrahedra t = tetrahedra_of({a, b}, cells);
      EXPECT_EQ(t.boundary_nodes, boundary_nodes(t.tets)) << "seed " << seed;
    }
  }
}

TEST(OctreeTetrahedra, WhatTakesMoreMemoryThanThereIsIsRefusedBefore) {
  // In a process of its own, because the limit applies to the process.
  const voxel::Octree ball = voxel::combine(unit_universe(7), voxel::Sphere{{63, 63, 63}, 60.0});
  EXPECT_EXIT(
      {
        voxel::limit_memory(1);
        try {
          tetrahedra_of(ball);
        } catch (const voxel::Error& error) {
          const bool says = std::string(error.what()).find("million elements take") != std::string::npos;
          ::_exit(error.code() == voxel::ErrorCode::Resource && says ? 3 : 2);
        }
        ::_exit(1);
      },
      testing::ExitedWithCode(3), "");
}

TEST(OctreeTetrahedra, NothingIsRefused) {
  EXPECT_THROW(tetrahedra_of(voxel::Octree::empty(unit_universe(4))), std::invalid_argument);
  EXPECT_THROW(tetrahedra_of(std::vector<voxel::Octree>{}), std::invalid_argument);
  EXPECT_THROW(tetrahedra_of({random_cubes(4, 3), random_cubes(3, 3)}), std::invalid_argument);
}

TEST(OctreeTetrahedra, ReportsWhatIsDoneAndEndsOnRequest) {
  const voxel::Octree cube = voxel::Octree::full(tests::unit_universe(5));  // over 4096 cells at its boundary
  std::vector<double> reported;
  tetrahedra_of(cube, BoundaryCells::Voxels, {{}, [&](double fraction) { reported.push_back(fraction); }});
  ASSERT_GT(reported.size(), 1u);
  EXPECT_TRUE(std::is_sorted(reported.begin(), reported.end()));
  EXPECT_GE(reported.front(), 0.0);
  EXPECT_LE(reported.back(), 1.0);
  std::stop_source source;
  const auto stop_half_way = [&](double fraction) {
    if (fraction > 0.0) source.request_stop();
  };
  EXPECT_THROW(tetrahedra_of(cube, BoundaryCells::Voxels, {source.get_token(), stop_half_way}),
               voxel::Stopped);
}

}  // namespace
}  // namespace octotomy::convert
