// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/solid.h"
#include "verify/witness/reading.h"
#include "voxel/tree/octree.h"

namespace octotomy::verify {

/// The operand of an offset, as each kernel represents it, and the operand's witness.
struct OffsetOperand {
  Witness witness;
  voxel::Octree voxels;
  brep::Solid mesh;
  /// The voxel kernel has whole voxels only and not the position of the surface between them.
  bool is_whole_voxels = false;
};

/// The distance by which the surface moves, and the resolution of the mesh kernel's search for the moved
/// surface.
struct WitnessedOffset {
  double by_mm = 1.0;    ///< outward; negative: inward; not 0
  double cell_mm = 1.0;  ///< edge of the mesh kernel's cells; 0 if that kernel makes no mesh
};

/// A witness of the points within by_mm of the operand or, for negative by_mm, deeper than |by_mm| inside it.
/// The operand's witness determines where the operand's surface crosses the edges between voxels' centres at
/// which one of the kernels has that surface. If the operand's witness cannot decide the side, a place counts
/// as inside only if both kernels have a voxel there. Where walls or gaps of the operand's mesh pass between
/// voxels' centres, the operand's witness is read beside the mesh's triangles. There the mesh's side is that
/// of the moved wall, and the voxels' side is `untold`, because resampling lost the wall. Distances are
/// computed to all these places within reach, by a grid of this source. offset_witness.cpp derives which
/// sides each kernel may have beside the moved surface. They are coarse, so totals decide about errors below
/// a voxel. Empty if the operand has no witness or no surface. Cost: some ten readings of the operand for
/// each face of its voxels. Cost of one reading: one of the operand, and a search among the places nearby.
Witness witness_of_offset(const OffsetOperand& operand, const WitnessedOffset& asked);

/// The mean distance between two right answers to an offset, over a surface of `area_mm2`, in addition to the
/// error of digitisation: the mean errors of the distances that each kernel computes. It depends on the
/// operand only and not on the answers under test. offset_witness.cpp has the derivation. Cost: linear in the
/// operand's triangles.
double offset_allowance_mm(const OffsetOperand& operand, const WitnessedOffset& asked, double area_mm2);

}  // namespace octotomy::verify
