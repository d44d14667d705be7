// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "brep/mesh.h"

namespace octotomy::brep {

enum class Operation { Union, Intersection, Difference };

struct BooleanResult {
  Mesh mesh;
  /// (|A| + |B|) - (|A u B| + |A n B|), relative to |A| + |B|, where all were computed; see boolean().
  double residual = 0.0;
  std::vector<std::string> findings;  ///< doubts: parts set apart, slivers removed
};

/// Boolean of two solids by corefinement on OpenMesh. The result is a solid, or has no faces where the set is
/// empty. Preconditions are the caller's to know from health(): both closed, oriented, without
/// self-intersection. Throws std::invalid_argument where an operand is open, std::runtime_error where the
/// result cannot be represented as a manifold surface, saying so: never a silent empty.
/// Union and intersection are both computed, as the residual proves them against each other.
/// Source: CGAL's Polygon Mesh Processing, corefinement (Loriot et al.), EPICK predicates.
BooleanResult boolean(const Mesh& a, Operation operation, const Mesh& b);

}  // namespace octotomy::brep
