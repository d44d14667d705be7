// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/operand.h"
#include "voxel/solid/operand_frame.h"

namespace octotomy::voxel {

SliceMaskOperand::SliceMaskOperand(const SliceMask& mask, const glm::dmat4& still_from_target)
    : distance_(mask),
      u_(along(still_from_target, mask.view.right, 0.0)),
      v_(along(still_from_target, mask.view.up, 0.0)),
      w_(along(still_from_target, mask.view.look, 0.0)) {}

Cover SliceMaskOperand::cover(const TargetBlock& block) const {
  const double in_plane_mm =
      glm::length(glm::dvec2(reach(u_, block.child_side), reach(v_, block.child_side)));
  const double across_mm = reach(w_, block.child_side);
  return cover_of_children(block, [&](const glm::dvec3& centre) {
    const SliceDistance::Bounds bounds =
        distance_({u_(centre), v_(centre)}, w_(centre), in_plane_mm, across_mm);
    if (bounds.high <= 0.0) return Status::Full;
    return bounds.low > 0.0 ? Status::Empty : Status::Partial;
  });
}

void SliceMaskOperand::words(const WantedLeaves& leaves) const {
  for_each_wanted_voxel(leaves, [&](const glm::dvec3& voxel) {
    return distance_({u_(voxel), v_(voxel)}, w_(voxel), 0.0, 0.0).high <= 0.0;
  });
}

}  // namespace octotomy::voxel
