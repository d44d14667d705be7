// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>

#include "brep/mesh/mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Whether any triangle is without area, exactly. Precondition: all points are finite. Cost: linear.
bool has_flat_triangles(const Triangles& triangles);

/// What take_out_flat_triangles() did.
struct FlatTriangles {
  std::size_t flips = 0;      ///< sides exchanged
  std::size_t collapses = 0;  ///< sides between points at one place, taken out with their two triangles
  std::size_t left = 0;       ///< triangles without area that neither could take out
  std::size_t taken() const { return flips + collapses; }
};

/// Gives triangles without area another diagonal, or takes them out where two of their points stand at one
/// place: the surface stays where it is, to the last bit, but is cut into triangles otherwise. What is left
/// would have torn or doubled the surface. Ends, and gives the same bits, for any mesh; deleted items are
/// collected. Precondition: all points are finite. Cost: linear, and a few steps a triangle without area.
FlatTriangles take_out_flat_triangles(Mesh& mesh);

}  // namespace octotomy::brep
