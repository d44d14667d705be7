// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <memory>

#include "voxel/solid/expression.h"

namespace octotomy::voxel {

/// Tells which points an expression contains: a window is its interpolated samples, an octree its whole
/// voxels. Copies share what they know; any number of threads may ask one.
class Membership {
 public:
  /// `universe` is where the expression is evaluated: a window at rest on its lattice ends where its samples
  /// do, any other one with its scan (postfix_expression.h).
  Membership(const Universe& universe, Expression expression);
  bool operator()(const glm::dvec3& p_mm) const;

 private:
  struct Known;
  std::shared_ptr<const Known> known_;
};

}  // namespace octotomy::voxel
