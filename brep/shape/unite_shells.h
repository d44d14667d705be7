// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

struct UnitedShells {
  Triangles surface;                  ///< surface of the union; health() has not been called on it
  std::size_t bodies = 0;             ///< number of outward shells that were united
  std::vector<std::string> findings;  ///< findings of the Booleans, see booleans()
};

/// The union of a surface's shells, which are triangles connected across edges: each outward shell is a body.
/// Each inward shell is a cavity of the body that contains most of its points; if several bodies contain
/// equally many, of the smallest of them. Bodies whose boxes are disjoint are not cut. Precondition:
/// mesh_of() accepts the triangles. None if Booleans find no union: a shell is open, intersects itself or has
/// no volume, a cavity has no body, or boolean() fails. Throws Stopped. Deterministic. Cost: health() of each
/// shell, and boolean() of bodies in pairs.
std::optional<UnitedShells> united_shells(const Triangles& surface, const std::stop_token& stop = {});

}  // namespace octotomy::brep
