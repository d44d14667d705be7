// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "brep/mesh/triangles.h"
#include "convert/tet/tetrahedra.h"

namespace octotomy::convert {

/// The face of an element opposite one of its corners; it faces outward if it is on the surface.
struct ElementFace {
  std::uint32_t tet = 0;
  std::uint8_t opposite = 0;  ///< 0..3
};

/// The faces that belong to only one element, in the elements' order. Cost: n log n, and one pass over all
/// elements for each million of them; memory 80 MB and 4 bytes a node beside the result.
std::vector<ElementFace> surface_faces(const Tetrahedra& tetrahedra);
/// The surface faces as triangles, outward. The points are all nodes, inner ones included.
brep::Triangles surface_of(const Tetrahedra& tetrahedra);

/// The faces between two regions, those of the first region's elements, outward.
struct Interface {
  std::uint32_t from = 0, to = 0;  ///< regions, from < to
  std::vector<ElementFace> faces;
  std::vector<ElementFace> opposite;  ///< the same faces, seen from the second region's elements, in the same
                                      ///< order
};
/// All interfaces, in the order of their regions; faces in the elements' order. Cost: that of
/// surface_faces(); none if there is one region.
std::vector<Interface> interfaces(const Tetrahedra& tetrahedra);
/// Corners of a face, counter-clockwise seen from outside its element.
std::array<std::uint32_t, 3> corners_of(const Tetrahedra& tetrahedra, const ElementFace& face);
/// The nodes in the middle of a face's sides, from its first corner on. Precondition: there are such nodes.
std::array<std::uint32_t, 3> middles_of(const Tetrahedra& tetrahedra, const ElementFace& face);

}  // namespace octotomy::convert
