// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/surface/cuberille.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <tbb/global_control.h>

#include "brep/mesh/components.h"
#include "brep/mesh/health.h"
#include "convert/voxel/voxelise.h"
#include "tests/convert/surfaces.h"
#include "tests/unit_universe.h"
#include "voxel/codes/cuberille_faces.h"
#include "voxel/tree/build.h"

namespace octotomy::convert {
namespace {

using tests::unit_universe;

/// The octree of the voxels for which `inside` is true.
template <typename Inside>
voxel::Octree octree_where(const voxel::Universe& universe, const Inside& inside) {
  const int side = universe.side();
  return voxel::octree_of_blocks(universe, [&](const glm::ivec3& block) {
    std::array<std::uint64_t, 64> words{};
    for (int i = 0; i < 4096; ++i) {
      const glm::ivec3 in_block(i & 15, (i >> 4) & 15, i >> 8);
      const glm::ivec3 v = 16 * block + in_block;
      if (glm::any(glm::greaterThanEqual(v, glm::ivec3(side))) || !inside(v)) continue;
      const glm::ivec3 leaf = in_block / 4;
      const glm::ivec3 bit = in_block % 4;
      words[static_cast<std::size_t>(voxel::child_index(leaf.x, leaf.y, leaf.z))] |=
          std::uint64_t{1} << voxel::child_index(bit.x, bit.y, bit.z);
    }
    return voxel::make_leaf_block(0, voxel::all_children, words.data());
  });
}

voxel::Octree random_octree(int depth, unsigned seed, unsigned per_mille) {
  const int side = 1 << depth;
  std::mt19937 random(seed);
  std::vector<bool> inside(static_cast<std::size_t>(side * side * side));
  for (std::size_t i = 0; i < inside.size(); ++i) inside[i] = random() % 1000 < per_mille;
  return octree_where(unit_universe(depth), [&](const glm::ivec3& v) {
    return inside[static_cast<std::size_t>(v.x + side * (v.y + side * v.z))];
  });
}

using Whole = glm::vec<3, std::int64_t>;

Whole product(const Whole& a, const Whole& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

std::int64_t six_volumes_half(const LatticeSurface& surface) {
  std::int64_t six = 0;
  for (const auto& [a, b, c] : surface.faces) {
    const Whole across = product(surface.points_half[b], surface.points_half[c]);
    const Whole corner = surface.points_half[a];
    six += corner.x * across.x + corner.y * across.y + corner.z * across.z;
  }
  return six;
}

/// Twice the area. It is a whole number, because triangles lie in coordinate planes.
std::int64_t twice_area_half(const LatticeSurface& surface) {
  std::int64_t twice = 0;
  for (const auto& [a, b, c] : surface.faces) {
    const Whole normal = product(surface.points_half[b] - surface.points_half[a],
                                 surface.points_half[c] - surface.points_half[a]);
    twice += std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
  }
  return twice;
}

/// The reason why the surface is not the octree's boundary; empty if it is.
std::string fault_of(const voxel::Octree& octree, const LatticeSurface& surface) {
  const brep::Triangles triangles = triangles_of(surface);
  if (octree.is_empty()) return surface.faces.empty() ? "" : "triangles about nothing";
  if (const auto fault = tests::fault_in_closedness(triangles)) return *fault;
  const brep::Health health = brep::health(triangles, {.self_intersections = false});
  if (!health.closed || !health.manifold) return health.findings.front();
  if (health.degenerate_faces != 0) return "degenerate faces";
  if (six_volumes_half(surface) != 48 * static_cast<std::int64_t>(octree.voxel_count()))
    return "six volumes " + std::to_string(six_volumes_half(surface)) + " of " +
           std::to_string(octree.voxel_count()) + " voxels";
  const auto faces = static_cast<std::int64_t>(voxel::cuberille_faces(octree).face_count());
  if (twice_area_half(surface) != 8 * faces)
    return "twice the area " + std::to_string(twice_area_half(surface)) + " of " + std::to_string(faces) +
           " faces";
  if (!(voxelise(octree.universe(), brep::linked(triangles)) == octree)) return "another octree comes back";
  return "";
}

bool has_bent_edges(const LatticeSurface& surface) {
  return std::any_of(surface.points_half.begin(), surface.points_half.end(),
                     [](const glm::ivec3& p) { return (p.x | p.y | p.z) & 1; });
}

TEST(Cuberille, OfOneVoxelIsACubeOfTwelveTriangles) {
  const LatticeSurface surface =
      cuberille(octree_where(unit_universe(2), [](const glm::ivec3& v) { return v == glm::ivec3(3, 0, 1); }));
  EXPECT_EQ(surface.faces.size(), 12U);
  EXPECT_EQ(surface.points_half.size(), 8U);
  EXPECT_EQ(six_volumes_half(surface), 48);
}

TEST(Cuberille, OfFiveHundredRandomSetsOfEveryDensityIsClosedManifoldAndExactAndComesBack) {
  int bent = 0;
  for (unsigned seed = 0; seed < 500; ++seed) {
    const voxel::Octree octree =
        random_octree(seed % 10 == 0 ? 4 : 2 + static_cast<int>(seed % 2), seed, 2 * seed + 1);
    for (const Touching touching : {Touching::Apart, Touching::Together}) {
      const LatticeSurface surface = cuberille(octree, touching);
      EXPECT_EQ(fault_of(octree, surface), "")
          << "seed " << seed << (touching == Touching::Apart ? " apart" : " together");
      bent += has_bent_edges(surface);
    }
  }
  EXPECT_GT(bent, 50);  // the hard case came up
}

TEST(Cuberille, TheProofsSeeAFlippedTriangleAndAMovedPoint) {
  const voxel::Octree octree = random_octree(3, 5, 400);
  LatticeSurface surface = cuberille(octree);
  std::swap(surface.faces[3][0], surface.faces[3][1]);
  EXPECT_NE(fault_of(octree, surface), "");
  surface = cuberille(octree);
  surface.points_half[7].x += 2;
  EXPECT_NE(fault_of(octree, surface), "");
}

TEST(Cuberille, VoxelsThatMeetAtAnEdgeArePartedOrJoinedAsAskedAndThoseAtACornerParted) {
  const auto shells = [](const glm::ivec3& other, Touching touching) {
    const voxel::Octree octree = octree_where(
        unit_universe(2), [&](const glm::ivec3& v) { return v == glm::ivec3(1, 1, 1) || v == other; });
    return brep::health(triangles_of(cuberille(octree, touching)), {.self_intersections = false}).shells;
  };
  for (const glm::ivec3& other : {glm::ivec3(2, 2, 1), glm::ivec3(0, 1, 2), glm::ivec3(1, 0, 0)}) {
    EXPECT_EQ(shells(other, Touching::Apart), 2U);
    EXPECT_EQ(shells(other, Touching::Together), 1U);
  }
  for (const Touching touching : {Touching::Apart, Touching::Together})
    EXPECT_EQ(shells({2, 2, 2}, touching), 2U);
}

TEST(Cuberille, AcrossWordsAndAtTheUniversesEndIsClosedToo) {
  for (const int depth : {6, 7}) {
    const voxel::Octree octree = random_octree(depth, 11, 500);
    const LatticeSurface surface = cuberille(octree);
    EXPECT_EQ(tests::fault_in_closedness(triangles_of(surface)), std::nullopt);
    EXPECT_EQ(six_volumes_half(surface), 48 * static_cast<std::int64_t>(octree.voxel_count()));
  }
  const voxel::Octree full = voxel::Octree::full(unit_universe(6));
  EXPECT_EQ(fault_of(full, cuberille(full)), "");
  EXPECT_TRUE(cuberille(voxel::Octree::empty(unit_universe(4))).faces.empty());
}

TEST(Cuberille, InAMirroredUniverseStillTurnsOutward) {
  voxel::Universe universe = unit_universe(3);
  universe.lps_from_voxel[0][0] = -0.5;
  const voxel::Octree octree = octree_where(universe, [](const glm::ivec3& v) { return v.x < 3 && v.y > 4; });
  EXPECT_NEAR(tests::volume_mm3(triangles_of(cuberille(octree))), 0.5 * 3 * 3 * 8, 1e-12);
}

TEST(Cuberille, GivesTheSameSurfaceOnOneThreadAndMany) {
  const voxel::Octree octree = random_octree(5, 3, 300);
  const LatticeSurface many = cuberille(octree);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const LatticeSurface single = cuberille(octree);
  EXPECT_EQ(single.points_half, many.points_half);
  EXPECT_EQ(single.faces, many.faces);
}

}  // namespace
}  // namespace octotomy::convert
