// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "brep/mesh.h"

namespace octotomy::brep {

/// What a mesh is fit for, checked in this order; an empty `findings` means a solid.
struct Health {
  std::size_t vertices = 0;
  std::size_t faces = 0;
  std::size_t boundary_edges = 0;
  std::size_t degenerate_faces = 0;           ///< area zero in exact arithmetic
  std::vector<std::pair<int, int>> crossing;  ///< first pairs of triangles that intersect, at most 100
  std::size_t self_intersections = 0;         ///< number of such pairs
  std::size_t components = 0;
  long euler = 0;  ///< V - E + F
  bool closed = false;
  bool manifold = false;
  bool oriented =
      false;  ///< every closed component's outside is where its neighbours say; total volume positive
  std::vector<std::string> findings;

  bool solid() const { return findings.empty(); }
};

/// Cost: n log n; the intersection test dominates (about 1 s for 300k triangles).
Health health(const Mesh& mesh);

}  // namespace octotomy::brep
