// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace octotomy::convert {

// The cases of marching cubes, for the isosurface's source and its proofs.
//
// Corner number of a cube = x + 2y + 4z, as octants are numbered. Edge number: along x 0..3 = y + 2z, along y
// 4..7 = 4 + x + 2z, along z 8..11 = 8 + x + 2y. Face number = 2 axis + side.

/// The two corners of an edge, the lower coordinate first.
std::array<int, 2> corners_of_edge(int edge);
/// The edges of a face, counter-clockwise seen from outside the cube.
std::array<int, 4> edges_of_face(int face);

/// The corners of a face, counter-clockwise seen from outside the cube. Edge i of edges_of_face() joins corners
/// i and i + 1.
std::array<int, 4> corners_of_face(int face);

/// A line on a face from one crossed edge to another, which cuts off a run of inside corners. The run lies on
/// its right seen from outside the cube.
struct FaceSegment {
  int from = 0;
  int to = 0;
};
std::vector<FaceSegment> segments_of_face(int face, int inside_corners);

/// Triangles for one pattern of inside corners.
struct MarchingCubesCase {
  std::uint16_t crossed = 0;  ///< bit e: edge e joins an inside corner to an outside one
  /// Closed lines through the crossings, counter-clockwise seen from outside. Each crossed edge is in exactly
  /// one loop.
  std::vector<std::vector<int>> loops;
  /// Edge numbers, counter-clockwise seen from the outside corners.
  std::vector<std::array<std::uint8_t, 3>> triangles;
};

/// The case of the inside corners, bit c for corner c. Derived once, on first use.
const MarchingCubesCase& marching_cubes_case(int inside_corners);

}  // namespace octotomy::convert
