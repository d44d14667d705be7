// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/operand.h"
#include "voxel/solid/operand_frame.h"

namespace octotomy::voxel {

namespace {

/// A small shift that moves positions off borders that run through voxel centres. The shift exceeds the
/// rounding of coordinates and is smaller than the precision of any border. A centre on a border is then
/// inside if the region continues towards growing u, v or position, so that it belongs to exactly one of two
/// regions that share the border.
constexpr double off_border_mm = 0x1p-20;

}  // namespace

SliceMaskOperand::SliceMaskOperand(const SliceMask& mask, const glm::dmat4& still_from_target)
    : distance_(mask),
      u_(along(still_from_target, mask.view.right, -off_border_mm)),
      v_(along(still_from_target, mask.view.up, -off_border_mm)),
      w_(along(still_from_target, mask.view.look, -off_border_mm)) {}

Meets SliceMaskOperand::meets(const Cube& cube) const {
  const double in_plane_mm = glm::length(glm::dvec2(reach(u_, cube.half), reach(v_, cube.half)));
  const SliceDistance::Bounds bounds =
      distance_({u_(cube.centre), v_(cube.centre)}, w_(cube.centre), in_plane_mm, reach(w_, cube.half));
  return {bounds.low <= 0.0, bounds.high > 0.0, bounds.high <= 0.0, bounds.low > 0.0};
}

bool SliceMaskOperand::contains(const glm::dvec3& p_voxel) const {
  return distance_({u_(p_voxel), v_(p_voxel)}, w_(p_voxel), 0.0, 0.0).high <= 0.0;
}

}  // namespace octotomy::voxel
