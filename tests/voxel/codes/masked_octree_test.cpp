// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/masked_octree.h"

#include <bit>
#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"

namespace octotomy::voxel {
namespace {

using tests::Dense;

bool is_inside(const Dense& dense, const glm::ivec3& v) {
  return glm::all(glm::greaterThanEqual(v, glm::ivec3(0))) &&
         glm::all(glm::lessThan(v, glm::ivec3(dense.side))) && dense.at(v) != 0;
}

/// The faces of a cube of voxels behind which every voxel is inside, one by one.
FaceSet covered_in(const Dense& dense, const glm::ivec3& origin, int edge) {
  FaceSet faces = 0;
  for (int number = 0; number < direction_count; ++number) {
    const auto direction = static_cast<Direction>(number);
    bool is_covered = true;
    for (int b = 0; b < edge; ++b)
      for (int a = 0; a < edge; ++a) {
        glm::ivec3 v = origin;
        v[(number / 2 + 1) % 3] += a;
        v[(number / 2 + 2) % 3] += b;
        v[number / 2] += number % 2 == 0 ? edge : -1;
        is_covered = is_covered && is_inside(dense, v);
      }
    if (is_covered) faces = static_cast<FaceSet>(faces | face_bit(direction));
  }
  return faces;
}

/// Calls `with` for every node of a masked octree.
template <typename With>
void for_each_node(const MaskedOctree& masked, const With& with, std::size_t number = 0,
                   const glm::ivec3& origin = glm::ivec3(0), int side_log2 = -1) {
  if (side_log2 < 0) side_log2 = masked.universe.depth;
  const MaskedNode& node = masked.nodes[number];
  with(node, origin, 1 << side_log2);
  if (node.status != Status::Partial) return;
  std::size_t child = number + 1;
  for (int k = 0; k < 8; ++k, child += masked.nodes[child].size)
    for_each_node(masked, with, child, origin + (glm::ivec3(k & 1, (k >> 1) & 1, k >> 2) << (side_log2 - 1)),
                  side_log2 - 1);
}

TEST(MaskedOctree, CoversTheFacesThatAPlainArrayCovers) {
  tests::for_each_subject([](const Dense& dense, const Octree& octree) {
    const MaskedOctree masked = masked_octree(octree);
    for_each_node(masked, [&](const MaskedNode& node, const glm::ivec3& origin, int edge) {
      ASSERT_EQ(node.covered, covered_in(dense, origin, edge))
          << origin.x << " " << origin.y << " " << origin.z << ", edge " << edge;
    });
    ASSERT_TRUE(octree_of(masked) == octree);
  });
}

TEST(MaskedOctree, KeepsItsMasksUnderIntersectionButNotUnderComplement) {
  int of_union = 0, of_complement = 0;
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    const Dense a = tests::random_dense(8, seed + 100), b = tests::random_dense(8, seed + 200);
    Dense both(8), either(8), not_a(8);
    for (std::size_t i = 0; i < a.voxels.size(); ++i) {
      both.voxels[i] = a.voxels[i] & b.voxels[i];
      either.voxels[i] = a.voxels[i] | b.voxels[i];
      not_a.voxels[i] = 1 - a.voxels[i];
    }
    for (int edge = 1; edge <= 4; edge *= 2)
      a.for_each([&](const glm::ivec3& v) {
        if (v % edge != glm::ivec3(0)) return;
        const FaceSet of_a = covered_in(a, v, edge), of_b = covered_in(b, v, edge);
        ASSERT_EQ(covered_in(both, v, edge), of_a & of_b);
        ASSERT_EQ(covered_in(either, v, edge) & (of_a | of_b), of_a | of_b);
        of_union += covered_in(either, v, edge) != (of_a | of_b);
        of_complement += covered_in(not_a, v, edge) != static_cast<FaceSet>(~of_a & 63);
      });
  }
  EXPECT_GT(of_union, 0);
  EXPECT_GT(of_complement, 0);
}

/// Faces drawn and nodes visited below a node that is opened, from the plain array.
void draw(const Dense& dense, const MaskedOctree& masked, FaceSet seen, std::size_t number,
          const glm::ivec3& origin, int edge, std::uint64_t& faces, std::uint64_t& visits) {
  const MaskedNode& node = masked.nodes[number];
  const auto shown = static_cast<unsigned>(seen & ~covered_in(dense, origin, edge));
  ++visits;
  if (shown == 0 || node.status == Status::Empty) return;
  if (node.status == Status::Full) {
    faces += static_cast<std::uint64_t>(std::popcount(shown));
    return;
  }
  std::size_t child = number + 1;
  for (int k = 0; k < 8; ++k, child += masked.nodes[child].size)
    draw(dense, masked, seen, child, origin + glm::ivec3(k & 1, (k >> 1) & 1, k >> 2) * (edge / 2), edge / 2,
         faces, visits);
}

TEST(MaskedOctree, IsDrawnWithoutWhatItsMasksHide) {
  int hidden = 0;
  tests::for_each_subject([&](const Dense& dense, const Octree& octree) {
    if (octree.universe().depth > 4) return;
    const MaskedOctree masked = masked_octree(octree);
    const auto sum = [](const MaskedDrawing& drawing) {
      std::uint64_t visits = 0;
      for (const LevelCount& level : drawing.visits) visits += level.partial + level.full + level.empty;
      return visits;
    };
    for (int octant = 0; octant < 8; ++octant) {
      std::uint64_t faces = 0, visits = 0;
      draw(dense, masked, view_code(octant), 0, glm::ivec3(0), dense.side, faces, visits);
      const MaskedDrawing drawing = draw_back_to_front(masked, view_code(octant));
      ASSERT_EQ(drawing.drawn_faces, faces);
      ASSERT_EQ(sum(drawing), visits - 1);  // the root is at level 0
      // Without masks every node is visited once.
      ASSERT_EQ(sum(draw_back_to_front(masked, view_code(octant), false)), masked.nodes.size() - 1);
      hidden += visits < masked.nodes.size();
    }
  });
  EXPECT_GT(hidden, 50);
}

TEST(MaskedOctree, FaceSetsAreTheThesiss) {
  EXPECT_EQ(face_text(view_code(0)), "F E F E F E");
  EXPECT_EQ(face_text(view_code(5)), "E F F E E F");
  const char* masks[] = {"172105", "174212", "630423", "631054", "747400", "740360"};
  for (int i = 0; i < direction_count; ++i)
    EXPECT_EQ(neighbour_mask(static_cast<Direction>(i)), std::strtoul(masks[i], nullptr, 8)) << i;
  // A voxel with one neighbour, to the north-east.
  Dense two(4);
  two.at({1, 1, 1}) = 1;
  two.at({2, 2, 1}) = 1;
  EXPECT_EQ(neighbour_code(tests::octree_of(tests::universe_of(2), two), {1, 1, 1}), 1U);
  EXPECT_EQ(neighbour_code(tests::octree_of(tests::universe_of(2), two), {2, 2, 1}), 1U << 3);
}

}  // namespace
}  // namespace octotomy::voxel
