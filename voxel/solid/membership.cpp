// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/membership.h"

#include "voxel/solid/target_expression.h"

namespace octotomy::voxel {

// The target lattice is the patient frame itself, with voxels of 1 mm. Its depth is 0, so that it differs
// from every scan's universe and windows are interpolated.
struct Membership::Known {
  Known(const Universe& universe, Expression asked)
      : expression(std::move(asked)),
        target(postfix_of(expression, universe), Universe{0, glm::dmat4(1.0)}) {}
  Expression expression;
  TargetExpression target;
};

Membership::Membership(const Universe& universe, Expression expression)
    : known_(std::make_shared<const Known>(universe, std::move(expression))) {}

bool Membership::operator()(const glm::dvec3& p_mm) const {
  return known_->target.contains(p_mm);
}

}  // namespace octotomy::voxel
