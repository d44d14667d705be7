// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "brep/mesh/distance.h"
#include "brep/mesh/mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// A connected piece of a solid: one outer shell and the shells of the cavities in it.
struct Component {
  std::vector<std::uint32_t> faces;  ///< faces of the mesh, ascending
  double volume_mm3 = 0.0;           ///< volume without cavities; negative for a shell that is inside out
  double area_mm2 = 0.0;
  std::size_t cavities = 0;
};

/// The pieces of a closed mesh, largest volume first, pieces of equal volume by their first face. Shells are
/// connected across edges. A shell of negative volume is a cavity of the smallest shell around it; without
/// such a shell it is a separate component with negative volume. Throws std::invalid_argument if the mesh is
/// open. Cost: n log n, one ray per shell.
std::vector<Component> components(const Mesh& mesh);

/// The components of linked triangles. `tree` returns the triangles' search tree and is called only if there
/// are cavities. Cost: linear, one ray per cavity.
std::vector<Component> components(const Linked& linked, const std::function<const SurfaceTree&()>& tree);

/// A mesh of the given faces of a mesh, in the given order, without vertices of other faces.
Mesh part_of(const Mesh& mesh, const std::vector<std::uint32_t>& faces);

}  // namespace octotomy::brep
