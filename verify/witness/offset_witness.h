// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/solid.h"
#include "verify/witness/reading.h"
#include "voxel/tree/octree.h"

namespace octotomy::verify {

/// An object whose surface is moved, as each kernel represents it, and its own witness.
struct OffsetOperand {
  Witness witness;
  voxel::Octree voxels;
  brep::Solid mesh;
  /// The voxel kernel has only whole voxels of the object, not the position of its surface between them.
  bool is_whole_voxels = false;
};

/// The distance by which the surface moves, and the resolution of the mesh kernel's search for it.
struct WitnessedOffset {
  double by_mm = 1.0;    ///< outward; below 0 inward; not 0
  double cell_mm = 1.0;  ///< edge of the mesh kernel's cells; 0 if it makes no triangles at this distance
};

/// The points within by_mm of the operand or, for by_mm below 0, deeper than |by_mm| inside it. The operand's
/// own witness places the operand's surface on the edges between voxels' centres at which one of the kernels
/// has that surface. If that witness cannot decide the side, a place counts as inside only if both kernels
/// have a voxel there. Where walls or gaps of the operand's mesh pass between voxels' centres, the operand's
/// witness is read beside the mesh's triangles. There the mesh's side is that of the moved wall, and the
/// voxels' side is `untold`, because resampling lost the wall. Distances are compared with every such place
/// within reach, on a grid of this source's own. The answers that each kernel may have beside the moved
/// surface are derived in offset_witness.cpp. They are coarse, so totals decide about errors below a voxel.
/// Empty where the operand has no witness, or both answers are empty. Cost: some ten readings of the operand
/// for each face of its voxels. Cost of one reading: one of the operand, and a search among the places
/// nearby.
Witness witness_of_offset(const OffsetOperand& operand, const WitnessedOffset& asked);

/// The mean distance that two right answers to an offset may have over a surface of `area_mm2`, in addition
/// to the error of digitisation: the mean errors of both kernels' distances. Derived in
/// offset_witness.cpp. Computed from the operand, not from the answers under test. Cost: linear in the
/// operand's triangles.
double offset_allowance_mm(const OffsetOperand& operand, const WitnessedOffset& asked, double area_mm2);

}  // namespace octotomy::verify
