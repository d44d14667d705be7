// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/triangles.h"
#include "convert/tet/tetrahedra.h"
#include "voxel/space/progress.h"

namespace octotomy::convert {

/// Lower bound in degrees of the dihedral angles of the tetrahedra that stuff() makes, as Labelle and
/// Shewchuk (2007) prove.
constexpr double stuffed_dihedral_deg() {
  return 10.7;
}

struct StuffingOptions {
  double cell_mm = 1.0;        ///< edge of the lattice's cubes, above 0; thinner parts may be lost or joined
  voxel::Progress progress{};  ///< reports the share that is done
};

/// Fills a closed surface with the tetrahedra of a body-centred cubic lattice, cut where the surface crosses
/// their sides. All elements have about the same size. Nodes on the boundary lie on the given surface, and
/// chords between them cut its edges off within a cell. Guaranteed, however bad the triangles are: all
/// volumes are positive and every dihedral angle is above stuffed_dihedral_deg(). The volume differs from the
/// surface's only by edges cut off and parts missed within a cell. Parts thinner than a cell may be lost,
/// joined or connected by a single node or side. `method` is "isosurface stuffing". In LPS millimetres. Empty
/// where no lattice point is inside. Precondition: closed and not empty; where triangles cross, points that
/// are inside an odd number of times count as inside. Throws std::invalid_argument if the cell is not above 0
/// or the surface has no triangles; voxel::Error (Resource) if the surface's box has more than 2^29 lattice
/// points; voxel::Stopped. Deterministic. Cost: n log n and the lattice points of the box; about 12 elements
/// a cube. Source: Labelle, Shewchuk, "Isosurface stuffing: fast tetrahedral meshes with good dihedral
/// angles", ACM TOG 26(3), 2007, uniform lattice.
Tetrahedra stuff(const brep::Triangles& surface, const StuffingOptions& options);

/// The edge of the lattice's cubes with which about this number of elements fills a volume. A cube has two
/// lattice points and twelve tetrahedra.
double cell_of_elements_mm(double volume_mm3, double elements);

}  // namespace octotomy::convert
