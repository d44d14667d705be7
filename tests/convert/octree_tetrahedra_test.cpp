// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/octree_tetrahedra.h"

#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <random>

#include "convert/deck.h"
#include "tests/unit_universe.h"
#include "voxel/build.h"
#include "voxel/combine.h"
#include "voxel/cuberille_faces.h"

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

/// Why the elements do not fill the voxels exactly and share whole faces, or nothing.
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

TEST(OctreeTetrahedra, NothingIsRefused) {
  EXPECT_THROW(tetrahedra_of(voxel::Octree::empty(unit_universe(4))), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::convert
