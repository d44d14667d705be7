// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>

#include "brep/mesh/mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Whether any triangle has an area of exactly 0. Precondition: all points are finite. Cost: linear.
bool has_flat_triangles(const Triangles& triangles);

/// The changes made by take_out_flat_triangles().
struct FlatTriangles {
  std::size_t flips = 0;      ///< diagonals exchanged
  std::size_t collapses = 0;  ///< sides between coinciding points, removed with their two triangles
  std::size_t left = 0;       ///< triangles without area that could not be removed
  std::size_t taken() const { return flips + collapses; }
};

/// Removes triangles without area by exchanging a diagonal, or by merging two of their points if these
/// coincide. The surface itself is unchanged, to the last bit; only its triangulation changes. Triangles stay
/// if removing them would tear or double the surface. Terminates and is deterministic for any mesh; deleted
/// items are collected. Precondition: all points are finite. Cost: linear, and a few steps per triangle
/// without area.
FlatTriangles take_out_flat_triangles(Mesh& mesh);

}  // namespace octotomy::brep
