// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Triangles of each surface that have a point in common with one of the other, ascending.
struct IntersectingTriangles {
  std::vector<std::uint32_t> of_a, of_b;
};

/// Finds them exactly, touching ones too. Triangles without area count as meeting whatever their boxes
/// overlap. Precondition: all points are finite. The same on any number of threads. Cost: linear in the
/// triangles but for those in both surfaces' boxes, which are sorted; about 5 ms for 100k on two cores.
/// Source: trees over a Morton curve, after Lauterbach et al., "Fast BVH construction on GPUs", 2009,
/// descended together.
IntersectingTriangles intersecting_triangles(const Triangles& a, const Triangles& b);

}  // namespace octotomy::brep
