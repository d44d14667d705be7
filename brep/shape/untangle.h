// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "brep/mesh/mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

struct Untangled {
  Triangles surface;
  std::vector<std::uint32_t> removed;  ///< triangles of the mesh that are no more, ascending
  std::size_t added = 0;               ///< triangles of the surface that are new
  bool is_done = false;                ///< none intersect any more
};

/// A mesh without triangles that intersect: those that do and some about them are smoothed, or taken out and
/// the hole closed, with the genus kept where that will do. Where nothing helps, `is_done` is false and the
/// surface as far as it came. Precondition: nothing is marked as deleted. Cost: the test's n log n, and most
/// for triangles that intersect. Source: CGAL's experimental remove_self_intersections().
Untangled untangle(const Mesh& mesh);

}  // namespace octotomy::brep
