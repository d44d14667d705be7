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
  Triangles surface;                  ///< of the union; health() has not been called on it
  std::size_t bodies = 0;             ///< shells turned outward that the union was made of
  std::vector<std::string> findings;  ///< of the Booleans, see booleans()
};

/// The union of a surface's shells, triangles connected across edges: each shell turned outward is a body,
/// and each turned inward is a cavity of the body that holds most of its points, of equal ones the smallest.
/// Bodies whose boxes are apart are not cut. Precondition: mesh_of() takes the triangles. Returns nothing
/// where the shells have no union by Booleans: a shell is open, meets itself or holds no volume, a cavity has
/// no body, or boolean() finds no answer. Throws Stopped. Deterministic. Cost: health() of each shell, and
/// boolean()'s of bodies in pairs.
std::optional<UnitedShells> united_shells(const Triangles& surface, const std::stop_token& stop = {});

}  // namespace octotomy::brep
