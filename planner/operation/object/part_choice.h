// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "brep/mesh/solid.h"
#include "planner/operation/table/object.h"
#include "verify/witness/reading.h"
#include "voxel/tree/octree.h"

// Decides, once for both kernels, which parts of an object are selected by size.
namespace octotomy::planner {

/// An object from which parts are selected. Both functions are called only if the kernels selected different
/// parts.
struct WholeObject {
  std::function<voxel::Octree()> voxels;
  std::function<brep::Solid()> mesh;
  verify::Witness witness;
  std::size_t count = 1;  ///< number of largest parts that were requested; ignored if there is a least volume
};

/// Replaces the mesh's parts by the voxels' parts if the kernels selected different parts and each kernel
/// selected correctly among its own parts. The kernels may disagree on which of two nearly equal parts is
/// larger, or on whether a part reaches `least_mm3`. A neck that only one kernel has may also change the
/// order of parts. Without `least_mm3` the largest parts were selected.
///
/// For the largest parts, each kernel's selection must consist of whole parts, and must contain no part
/// smaller than the last of the `count` largest and leave out no larger one. If one object lacks voxels of a
/// part of the other, the witness must allow this. For a least volume, both objects must contain each other's
/// parts (verify::certify_bounded). If these conditions hold, a caveat names the parts, and `shared_values`
/// the decision. Otherwise nothing changes and the certificate fails. Cost: digitising the mesh; if the
/// selections differ, also the parts that meet the differing ones. Throws as the functions of `whole`.
void settle_choice(const WholeObject& whole, const voxel::Universe& universe,
                   const std::optional<double>& least_mm3, Object& made);

}  // namespace octotomy::planner
