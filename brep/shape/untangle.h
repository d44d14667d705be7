// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "brep/mesh/mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

struct Untangled {
  Triangles surface;
  std::vector<std::uint32_t> removed;  ///< triangles of the mesh that were removed, ascending
  std::size_t added = 0;               ///< triangles of the surface that are new
  bool is_done = false;                ///< no triangles intersect
};

/// A mesh without intersecting triangles. Intersecting ones and some around them are smoothed, or removed and
/// the hole closed. The genus is preserved if possible. If intersections remain, `is_done` is false and the
/// surface is the best found. Precondition: nothing is marked as deleted. Cost: n log n for the test; most
/// time goes into triangles that intersect. Source: CGAL's experimental remove_self_intersections().
Untangled untangle(const Mesh& mesh);

}  // namespace octotomy::brep
