// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "brep/mesh/morton_tree.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// A surface of shells, which are triangles connected across edges. Precondition: every shell is closed and
/// consistently wound.
struct ShelledSurface {
  const Triangles& triangles;
  const std::vector<std::uint32_t>& first;  ///< by point, the first point in use at its position
  const std::vector<std::uint32_t>& shell;  ///< by triangle, the lowest triangle of its shell
};

/// A shell among the other shells of a surface.
struct ShellPlace {
  std::uint32_t shell = 0;  ///< its lowest triangle
  double volume_mm3 = 0.0;  ///< negative if it faces inward
  int winding = 0;          ///< winding number of the other shells around its point of largest x
};

/// The places of all shells, by their lowest triangles. `tree` holds all triangles and may be null for a
/// single shell. A point that several shells share is used only if a shell has no other point. Parallel, with
/// the same result on any number of threads. Cost: n log n, and for each shell the triangles along a ray from
/// its point to the end of the shells whose boxes contain that point.
std::vector<ShellPlace> shell_places(const ShelledSurface& surface, const MortonTree* tree);

}  // namespace octotomy::brep
