// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "brep/mesh/distance.h"
#include "convert/tet/tetrahedra.h"

namespace octotomy::convert {

/// The surface whose edges are restored, with its search tree.
struct KeptSurface {
  const brep::Triangles& triangles;
  const brep::SurfaceTree& tree;
};

/// Restores corners and sharp edges of the given surface that the elements' surface cuts off. If a side of an
/// element goes from one face to another across a sharp edge, its nearer end moves onto that edge. If neither end
/// can move, a new element between the side and two nodes on the edge fills the notch, or else a node on the edge
/// splits the side. Edges are sharp from 40 degrees on,
/// between two flat parts of the surface that are several elements large. No element's smallest dihedral
/// angle falls below `least_deg`, or below its old value if that was smaller; sides that could not be put on
/// edges within this bound stay. Precondition: all elements are one region. Returns the nodes that were moved
/// or made, ascending; those made also become boundary nodes. Deterministic. Cost: about n log n.
std::vector<std::uint32_t> put_on_sharp_edges(Tetrahedra& tetrahedra, const KeptSurface& given,
                                              double least_deg);

}  // namespace octotomy::convert
