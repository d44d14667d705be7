// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/surface/marching_cubes.h"

#include <algorithm>
#include <cassert>
#include <glm/glm.hpp>
#include <limits>

// Source: Lorensen and Cline, "Marching cubes", SIGGRAPH 1987. Departure: no printed table. Its holes come
// from reducing cases by complement, which joins ambiguous faces differently on either side. Here each case
// follows from one rule on faces, and cubes that share a face apply the same rule.
//
// 1 On every face, each maximal run of inside corners is cut off by one segment, so two inside corners across
//   a face's diagonal stay apart. Seen from outside the cube, the segment goes counter-clockwise with the run
//   from the edge that enters it to the edge that leaves it; then the surface lies on the segment's left when
//   seen from the outside corners.
// 2 A crossed edge has two faces, is entered by a segment of one and left by a segment of the other, so the
//   segments close to loops that pass each crossing once.
// 3 Each loop is triangulated without a diagonal in a face of the cube. A segment of a face then belongs to
//   exactly one triangle of each of the two cubes, and a diagonal to two triangles of one cube: each edge has
//   two triangles, in opposite directions, for any samples.

namespace octotomy::convert {
namespace {

int edge_between(int a, int b) {
  for (int edge = 0; edge < 12; ++edge) {
    const std::array<int, 2> ends = corners_of_edge(edge);
    if ((ends[0] == a && ends[1] == b) || (ends[0] == b && ends[1] == a)) return edge;
  }
  assert(false);
  return -1;
}

bool share_a_face(int edge_a, int edge_b) {
  for (int face = 0; face < 6; ++face) {
    const std::array<int, 4> edges = edges_of_face(face);
    if (std::ranges::find(edges, edge_a) != edges.end() && std::ranges::find(edges, edge_b) != edges.end())
      return true;
  }
  return false;
}

glm::dvec3 midpoint(int edge) {
  glm::dvec3 sum(0.0);
  for (const int corner : corners_of_edge(edge))
    sum += glm::dvec3(corner & 1, (corner >> 1) & 1, corner >> 2);
  return sum * 0.5;
}

/// The triangulation of a loop with the shortest diagonals (sum of squares between edge midpoints) among
/// those without a diagonal in a face; the first of several equal ones. Dynamic programme over the loop's
/// intervals.
class LoopTriangulation {
 public:
  explicit LoopTriangulation(const std::vector<int>& loop)
      : loop_(loop), count_(static_cast<int>(loop.size())) {
    cost_.assign(count_ * count_, 0.0);
    apex_.assign(count_ * count_, -1);
    for (int length = 2; length < count_; ++length)
      for (int first = 0; first + length < count_; ++first) choose_apex(first, first + length);
  }

  bool exists() const { return cost_[count_ - 1] < std::numeric_limits<double>::infinity(); }
  void append_to(std::vector<std::array<std::uint8_t, 3>>& triangles) const {
    append(0, count_ - 1, triangles);
  }

 private:
  int at(int first, int last) const { return first * count_ + last; }

  double diagonal_cost(int first, int last) const {
    if (last - first == 1 || last - first == count_ - 1) return 0.0;
    if (share_a_face(loop_[first], loop_[last])) return std::numeric_limits<double>::infinity();
    const glm::dvec3 along = midpoint(loop_[first]) - midpoint(loop_[last]);
    return glm::dot(along, along);
  }

  void choose_apex(int first, int last) {
    double best = std::numeric_limits<double>::infinity();
    for (int apex = first + 1; apex < last; ++apex) {
      const double cost = cost_[at(first, apex)] + cost_[at(apex, last)];
      if (cost < best) {
        best = cost;
        apex_[at(first, last)] = apex;
      }
    }
    cost_[at(first, last)] = best + diagonal_cost(first, last);
  }

  void append(int first, int last, std::vector<std::array<std::uint8_t, 3>>& triangles) const {
    if (last - first < 2) return;
    const int apex = apex_[at(first, last)];
    triangles.push_back({static_cast<std::uint8_t>(loop_[first]), static_cast<std::uint8_t>(loop_[apex]),
                         static_cast<std::uint8_t>(loop_[last])});
    append(first, apex, triangles);
    append(apex, last, triangles);
  }

  const std::vector<int>& loop_;
  int count_;
  std::vector<double> cost_;
  std::vector<int> apex_;
};

MarchingCubesCase derive(int inside_corners) {
  MarchingCubesCase derived;
  for (int edge = 0; edge < 12; ++edge) {
    const std::array<int, 2> ends = corners_of_edge(edge);
    if (((inside_corners >> ends[0]) & 1) != ((inside_corners >> ends[1]) & 1))
      derived.crossed = static_cast<std::uint16_t>(derived.crossed | (1 << edge));
  }

  std::array<int, 12> next{};
  next.fill(-1);
  for (int face = 0; face < 6; ++face)
    for (const FaceSegment& segment : segments_of_face(face, inside_corners)) {
      assert(next[segment.from] == -1);
      next[segment.from] = segment.to;
    }

  std::uint16_t left = derived.crossed;
  for (int first = 0; first < 12; ++first) {
    if (((left >> first) & 1) == 0) continue;
    std::vector<int> loop;
    for (int edge = first; ((left >> edge) & 1) != 0; edge = next[edge]) {
      loop.push_back(edge);
      left = static_cast<std::uint16_t>(left & ~(1 << edge));
    }
    const LoopTriangulation triangulation(loop);
    assert(triangulation.exists());
    triangulation.append_to(derived.triangles);
    derived.loops.push_back(std::move(loop));
  }
  return derived;
}

}  // namespace

std::array<int, 2> corners_of_edge(int edge) {
  const int axis = edge / 4;
  const int b = axis == 0 ? 1 : 0;
  const int c = axis == 2 ? 1 : 2;
  const int low = ((edge & 1) << b) | (((edge >> 1) & 1) << c);
  return {low, low | (1 << axis)};
}

std::array<int, 4> edges_of_face(int face) {
  const std::array<int, 4> corners = corners_of_face(face);
  std::array<int, 4> edges{};
  for (int i = 0; i < 4; ++i) edges[i] = edge_between(corners[i], corners[(i + 1) % 4]);
  return edges;
}

std::array<int, 4> corners_of_face(int face) {
  const int axis = face / 2;
  const int b = 1 << ((axis + 1) % 3);
  const int c = 1 << ((axis + 2) % 3);
  const int base = (face % 2) << axis;
  if (face % 2 == 1) return {base, base | b, base | b | c, base | c};
  return {base, base | c, base | b | c, base | b};
}

std::vector<FaceSegment> segments_of_face(int face, int inside_corners) {
  const std::array<int, 4> corners = corners_of_face(face);
  const std::array<int, 4> edges = edges_of_face(face);
  const auto inside = [&](int i) { return ((inside_corners >> corners[i % 4]) & 1) != 0; };
  std::vector<FaceSegment> segments;
  for (int first = 0; first < 4; ++first) {
    if (!inside(first) || inside(first + 3)) continue;
    int last = first;
    while (inside(last + 1)) ++last;
    // Edge i of a face joins its corners i and i + 1.
    segments.push_back({edges[(first + 3) % 4], edges[last % 4]});
  }
  return segments;
}

const MarchingCubesCase& marching_cubes_case(int inside_corners) {
  static const std::array<MarchingCubesCase, 256> cases = [] {
    std::array<MarchingCubesCase, 256> derived;
    for (int inside = 0; inside < 256; ++inside) derived[inside] = derive(inside);
    return derived;
  }();
  return cases[static_cast<std::size_t>(inside_corners)];
}

}  // namespace octotomy::convert
