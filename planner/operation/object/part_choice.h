// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "brep/mesh/solid.h"
#include "planner/operation/table/object.h"
#include "verify/witness/reading.h"
#include "voxel/tree/octree.h"

// Decides once, for both kernels, which parts of an object are selected by their size.
namespace octotomy::planner {

/// An object that parts are selected from. Both functions are called only where the kernels selected
/// different parts.
struct WholeObject {
  std::function<voxel::Octree()> voxels;
  std::function<brep::Solid()> mesh;
  verify::Witness witness;
  std::size_t count = 1;  ///< number of the largest parts that were requested; not read with a least volume
};

/// Replaces the mesh's parts by the voxels' parts if the kernels selected different parts and each kernel
/// selected correctly among its own parts. Of two parts of nearly the same volume, the kernels may disagree
/// on which is larger; of a part near `least_mm3`, on whether it reaches it; and of the largest parts, a neck
/// that one kernel alone has may change the order. Without `least_mm3` the largest parts were selected.
///
/// The largest parts: the voxels' selection must consist of whole parts, none smaller than the last of the
/// `count` largest, and leave out no larger one; the mesh's selection likewise. Where an object lacks voxels
/// of a part of the other one, the witness must allow that. Parts by a least volume: both objects must contain
/// each other's parts (verify::certify_bounded). A caveat then names the parts, and `shared_values` the
/// decision. Otherwise nothing changes and the certificate fails. Cost: digitising the mesh; where the
/// selections differ, also the parts that meet the differing ones. Throws as its functions.
void settle_choice(const WholeObject& whole, const voxel::Universe& universe,
                   const std::optional<double>& least_mm3, Object& made);

}  // namespace octotomy::planner
