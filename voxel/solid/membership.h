// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <memory>

#include "voxel/solid/expression.h"

namespace octotomy::voxel {

/// Whether an expression contains a point. A window contains the points whose interpolated sample lies in it;
/// an octree contains all points of its voxels. Copies share their data; any number of threads may call one
/// object.
class Membership {
 public:
  /// A window ends where its samples leave it, and where its scan ends (postfix_expression.h). The scan's end
  /// does not limit a window that excludes the background and is at rest on the lattice of `universe`.
  Membership(const Universe& universe, Expression expression);
  bool operator()(const glm::dvec3& p_mm) const;

 private:
  struct Known;
  std::shared_ptr<const Known> known_;
};

}  // namespace octotomy::voxel
