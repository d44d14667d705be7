// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/surface_tracking.h"

#include <gtest/gtest.h>
#include <set>
#include <tuple>

#include "tests/voxel/code_subjects.h"

namespace octotomy::voxel {
namespace {

using Key = std::tuple<int, int, int, int>;

Key key_of(const glm::ivec3& voxel, int direction) {
  return {voxel.z, voxel.y, voxel.x, direction};
}

std::set<Key> faces_of(const CuberilleFaces& faces) {
  std::set<Key> all;
  for (int direction = 0; direction < direction_count; ++direction)
    for (const glm::ivec3& voxel : faces.lists[static_cast<std::size_t>(direction)])
      all.insert(key_of(voxel, direction));
  return all;
}

/// The faces joined to a seed by the relation "share an edge, and one voxel, or voxels joined across it", over
/// edges in all four directions: the surface without the order of circuits.
std::set<Key> flooded(const Octree& octree, const SurfaceFace& seed, Joined joined) {
  const int side = octree.universe().side();
  const auto is_in = [&](const glm::ivec3& v) {
    return glm::all(glm::greaterThanEqual(v, glm::ivec3(0))) &&
           glm::all(glm::lessThan(v, glm::ivec3(side))) && octree.contains(v);
  };
  std::set<Key> met{key_of(seed.voxel, static_cast<int>(seed.direction))};
  std::vector<SurfaceFace> open{seed};
  while (!open.empty()) {
    const SurfaceFace face = open.back();
    open.pop_back();
    const glm::ivec3 n = step(face.direction);
    for (int ahead = 0; ahead < direction_count; ++ahead) {
      if (ahead / 2 == static_cast<int>(face.direction) / 2) continue;
      const glm::ivec3 a = step(static_cast<Direction>(ahead));
      SurfaceFace next{face.voxel, static_cast<Direction>(ahead)};
      const bool level = is_in(face.voxel + a), above = is_in(face.voxel + a + n);
      if (above && (level || joined == Joined::ByEdges))
        next = {face.voxel + a + n, static_cast<Direction>(ahead ^ 1)};
      else if (level)
        next = {face.voxel + a, face.direction};
      if (met.insert(key_of(next.voxel, static_cast<int>(next.direction))).second) open.push_back(next);
    }
  }
  return met;
}

Octree of_voxels(int depth, const std::vector<glm::ivec3>& voxels) {
  tests::Dense dense(1 << depth);
  for (const glm::ivec3& voxel : voxels) dense.at(voxel) = 1;
  return tests::octree_of(tests::universe_of(depth), dense);
}

TEST(SurfaceTracking, OfFigure31HasTheTwoPartsThatFacesJoin) {
  const Octree figure = tests::figure_3_1();
  const TrackedSurface alone = track_surface(figure, {{3, 1, 1}, Direction::PlusX});
  EXPECT_EQ(alone.faces.face_count(), 6u);
  EXPECT_EQ(alone.enclosed_voxels, 1);
  const TrackedSurface rest = track_surface(figure, {{1, 2, 0}, Direction::PlusX});
  EXPECT_EQ(rest.faces.face_count() + 6u, cuberille_faces(figure).face_count());
  EXPECT_EQ(rest.enclosed_voxels, 12);
  // The voxel (3,1,1) shares an edge with (2,2,1): joined by edges, the surface is one.
  EXPECT_EQ(track_surface(figure, {{3, 1, 1}, Direction::PlusX}, Joined::ByEdges).faces.lists,
            cuberille_faces(figure).lists);
}

TEST(SurfaceTracking, AnOuterSurfaceEnclosesItsCavityWhoseWallIsASurfaceOfItsOwn) {
  tests::Dense dense(8);
  dense.for_each([&](const glm::ivec3& v) {
    const bool is_shell =
        glm::all(glm::greaterThan(v, glm::ivec3(0))) && glm::all(glm::lessThan(v, glm::ivec3(6)));
    dense.at(v) = is_shell && v != glm::ivec3(3);
  });
  const Octree shell = tests::octree_of(tests::universe_of(3), dense);
  const TrackedSurface outside = track_surface(shell, {{1, 1, 1}, Direction::MinusX});
  EXPECT_EQ(outside.faces.face_count(), 150u);
  EXPECT_EQ(outside.enclosed_voxels, 125);
  EXPECT_EQ(octree_of(outside.faces).voxel_count(), 125u) << "the surface alone bounds the filled object";
  const TrackedSurface wall = track_surface(shell, {{2, 3, 3}, Direction::PlusX});
  EXPECT_EQ(wall.faces.face_count(), 6u);
  EXPECT_EQ(wall.enclosed_voxels, -1);
}

TEST(SurfaceTracking, ReachesWhatAFloodOverAllEdgesReachesAndPartsTheBoundary) {
  int surfaces = 0;
  tests::for_each_subject([&](const tests::Dense& dense, const Octree& octree) {
    if (dense.side > 16) return;
    for (const Joined joined : {Joined::ByFaces, Joined::ByEdges}) {
      std::set<Key> open = faces_of(cuberille_faces(octree));
      std::int64_t enclosed = 0;
      while (!open.empty() && surfaces < 4000) {
        const auto [z, y, x, direction] = *open.begin();
        const SurfaceFace seed{{x, y, z}, static_cast<Direction>(direction)};
        const TrackedSurface tracked = track_surface(octree, seed, joined);
        const std::set<Key> faces = faces_of(tracked.faces);
        ASSERT_EQ(faces.size(), tracked.faces.face_count()) << "a face twice";
        ASSERT_EQ(faces, flooded(octree, seed, joined));
        for (const Key& face : faces) ASSERT_EQ(open.erase(face), 1u) << "a face of two surfaces";
        enclosed += tracked.enclosed_voxels;
        ++surfaces;
      }
      if (open.empty()) {
        ASSERT_EQ(enclosed, static_cast<std::int64_t>(octree.voxel_count()));
      }
    }
  });
  EXPECT_GT(surfaces, 50);
}

TEST(SurfaceTracking, ASeedIsTheNearestFaceAndNoneFarAway) {
  const Octree octree = of_voxels(3, {{2, 3, 4}});
  EXPECT_EQ(nearest_face(octree, {2.5, 3.0, 4.0}, 1.5), (SurfaceFace{{2, 3, 4}, Direction::PlusX}));
  EXPECT_EQ(nearest_face(octree, {2.1, 3.1, 3.2}, 1.5), (SurfaceFace{{2, 3, 4}, Direction::MinusZ}));
  EXPECT_FALSE(nearest_face(octree, {6.0, 3.0, 4.0}, 1.5));
  EXPECT_FALSE(nearest_face(octree, {-1e30, 1e30, 0.0}, 1.5));
}

TEST(SurfaceTracking, RefusesASeedThatIsNoFaceOfTheBoundary) {
  const Octree octree = of_voxels(3, {{2, 3, 4}, {3, 3, 4}});
  EXPECT_THROW(track_surface(octree, {{2, 3, 4}, Direction::PlusX}), std::invalid_argument);
  EXPECT_THROW(track_surface(octree, {{0, 0, 0}, Direction::PlusX}), std::invalid_argument);
  EXPECT_THROW(track_surface(octree, {{-1, 0, 0}, Direction::PlusX}), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
