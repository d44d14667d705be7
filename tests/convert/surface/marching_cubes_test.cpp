// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/surface/marching_cubes.h"

#include <algorithm>
#include <glm/glm.hpp>
#include <gtest/gtest.h>
#include <map>
#include <set>
#include <utility>

namespace octotomy::convert {
namespace {

using DirectedEdge = std::pair<int, int>;

bool edge_in_face(int edge, int face) {
  const std::array<int, 4> edges = edges_of_face(face);
  return std::find(edges.begin(), edges.end(), edge) != edges.end();
}

/// The segments that a case's triangles have in a face of the cube.
std::set<DirectedEdge> segments_in_face(const MarchingCubesCase& cell, int face) {
  std::set<DirectedEdge> segments;
  for (const auto& t : cell.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const int from = t.at(i);
      const int to = t.at((i + 1) % 3);
      if (edge_in_face(from, face) && edge_in_face(to, face)) segments.insert({from, to});
    }
  return segments;
}

glm::dvec3 corner_position(int corner) {
  return {corner & 1, (corner >> 1) & 1, corner >> 2};
}

glm::dvec3 midpoint(int edge) {
  const auto [low, high] = corners_of_edge(edge);
  return (corner_position(low) + corner_position(high)) * 0.5;
}

/// The edge of the neighbour beyond face 2 axis + 1 that is this edge of the cube.
int edge_seen_by_neighbour(int edge, int axis) {
  for (int other = 0; other < 12; ++other) {
    glm::dvec3 shifted = midpoint(other);
    shifted[axis] += 1.0;
    if (shifted == midpoint(edge)) return other;
  }
  return -1;
}

TEST(MarchingCubes, EveryCrossedEdgeOfAll256CasesIsInExactlyOneLoop) {
  for (int inside = 0; inside < 256; ++inside) {
    const MarchingCubesCase& cell = marching_cubes_case(inside);
    std::multiset<int> in_loops;
    for (const std::vector<int>& loop : cell.loops) in_loops.insert(loop.begin(), loop.end());
    for (int edge = 0; edge < 12; ++edge) {
      const auto [low, high] = corners_of_edge(edge);
      const bool crossed = ((inside >> low) & 1) != ((inside >> high) & 1);
      EXPECT_EQ((cell.crossed >> edge) & 1, crossed) << "case " << inside << " edge " << edge;
      EXPECT_EQ(in_loops.count(edge), crossed ? 1U : 0U) << "case " << inside << " edge " << edge;
    }
  }
}

TEST(MarchingCubes, InAll256CasesTrianglesMeetInPairsInsideTheCubeAndOnceOnItsFaces) {
  int longest = 0;
  for (int inside = 0; inside < 256; ++inside) {
    const MarchingCubesCase& cell = marching_cubes_case(inside);
    std::map<DirectedEdge, int> uses;
    for (const auto& t : cell.triangles)
      for (std::size_t i = 0; i < 3; ++i) ++uses[{t.at(i), t.at((i + 1) % 3)}];
    std::size_t triangles = 0;
    std::set<DirectedEdge> segments;
    for (const std::vector<int>& loop : cell.loops) {
      longest = std::max(longest, static_cast<int>(loop.size()));
      triangles += loop.size() - 2;
      for (std::size_t i = 0; i < loop.size(); ++i) segments.insert({loop[i], loop[(i + 1) % loop.size()]});
    }
    EXPECT_EQ(cell.triangles.size(), triangles) << "case " << inside;
    for (const auto& [edge, count] : uses) {
      EXPECT_EQ(count, 1) << "case " << inside << ": " << edge.first << " -> " << edge.second;
      const bool is_segment = segments.contains(edge);
      bool in_a_face = false;
      for (int face = 0; face < 6; ++face)
        in_a_face = in_a_face || (edge_in_face(edge.first, face) && edge_in_face(edge.second, face));
      EXPECT_EQ(in_a_face, is_segment) << "case " << inside << ": a diagonal lies in a face";
      EXPECT_EQ(uses.contains({edge.second, edge.first}), !is_segment) << "case " << inside;
    }
    for (const DirectedEdge& segment : segments) EXPECT_TRUE(uses.contains(segment)) << "case " << inside;
  }
  EXPECT_EQ(longest, 7) << "the long loops, where diagonals are hard to place, were met";
}

TEST(MarchingCubes, AllNeighbouringPairsHaveOppositeSegmentsInTheFaceTheyShare) {
  int pairs = 0;
  int ambiguous = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int left = 0; left < 256; ++left)
      for (int right = 0; right < 256; ++right) {
        bool consistent = true;
        for (int corner = 0; corner < 8; ++corner)
          if (((corner >> axis) & 1) == 1)
            consistent = consistent && ((left >> corner) & 1) == ((right >> (corner ^ (1 << axis))) & 1);
        if (!consistent) continue;
        ++pairs;
        const auto ours = segments_in_face(marching_cubes_case(left), 2 * axis + 1);
        const auto theirs = segments_in_face(marching_cubes_case(right), 2 * axis);
        if (ours.size() == 2) ++ambiguous;
        ASSERT_EQ(ours.size(), theirs.size()) << "axis " << axis << ": " << left << " beside " << right;
        for (const auto& [from, to] : ours)
          ASSERT_TRUE(theirs.contains({edge_seen_by_neighbour(to, axis), edge_seen_by_neighbour(from, axis)}))
              << "axis " << axis << ": " << left << " beside " << right;
      }
  EXPECT_EQ(pairs, 3 * 16 * 256);
  EXPECT_EQ(ambiguous, 3 * 2 * 256);
}

TEST(MarchingCubes, InsideCornersAcrossAFacesDiagonalStayApart) {
  // Corners 0 and 3 share the face z = 0.
  const MarchingCubesCase& cell = marching_cubes_case((1 << 0) | (1 << 3));
  EXPECT_EQ(cell.loops.size(), 2U);
  // The outside ones are joined.
  EXPECT_EQ(marching_cubes_case(255 ^ ((1 << 0) | (1 << 3))).loops.size(), 1U);
}

TEST(MarchingCubes, TrianglesTurnTheirFrontToTheOutsideCornersInAllCases) {
  for (int inside = 1; inside < 255; ++inside) {
    const MarchingCubesCase& cell = marching_cubes_case(inside);
    for (const std::vector<int>& loop : cell.loops) {
      // A loop's area vector points along its edges from inside to outside, on the whole.
      glm::dvec3 area(0.0);
      glm::dvec3 outward(0.0);
      for (std::size_t i = 0; i < loop.size(); ++i) {
        area += glm::cross(midpoint(loop[i]), midpoint(loop[(i + 1) % loop.size()]));
        const auto [low, high] = corners_of_edge(loop[i]);
        const glm::dvec3 along = corner_position(high) - corner_position(low);
        outward += ((inside >> low) & 1) ? along : -along;
      }
      EXPECT_GT(glm::dot(area, outward), 0.0) << "case " << inside;
    }
  }
}

}  // namespace
}  // namespace octotomy::convert
