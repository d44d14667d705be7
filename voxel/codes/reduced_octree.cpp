// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/reduced_octree.h"

#include <stdexcept>
#include <string>
#include <vector>

#include "voxel/tree/logical_build.h"

namespace octotomy::voxel {
namespace {

std::uint64_t voxels_of(const LogicalNode& node) {
  if (node.status() == Status::Empty) return 0;
  if (node.status() == Status::Full) return std::uint64_t{1} << (3 * node.side_log2());
  std::uint64_t count = 0;
  for (int k = 0; k < 8; ++k) count += voxels_of(node.child(k));
  return count;
}

bool becomes_full(const LogicalNode& node, const Reduction& reduction) {
  if (node.status() != Status::Partial) return node.status() == Status::Full;
  if (reduction.of == Reduction::Of::Voxels) {
    const auto all = static_cast<double>(std::uint64_t{1} << (3 * node.side_log2()));
    return static_cast<double>(voxels_of(node)) > reduction.share * all;
  }
  int full = 0;
  for (int k = 0; k < 8; ++k) full += becomes_full(node.child(k), reduction);
  return full > 8.0 * reduction.share;
}

/// Passes the statuses of the reduced octree's nodes in preorder. LogicalBuild condenses nodes that became
/// homogeneous.
class ReducedSource {
 public:
  ReducedSource(const Octree& octree, int levels, const Reduction& reduction) {
    add(LogicalNode::root(octree), levels, reduction);
  }
  Status open(int /*level*/) { return statuses_[next_++]; }
  void close(bool /*homogeneous*/) {}

 private:
  void add(const LogicalNode& node, int voxel_log2, const Reduction& reduction) {
    if (node.side_log2() == voxel_log2) {
      statuses_.push_back(becomes_full(node, reduction) ? Status::Full : Status::Empty);
      return;
    }
    statuses_.push_back(node.status());
    if (node.status() != Status::Partial) return;
    for (int k = 0; k < 8; ++k) add(node.child(k), voxel_log2, reduction);
  }

  std::vector<Status> statuses_;
  std::size_t next_ = 0;
};

}  // namespace

Octree reduced(const Octree& octree, int levels, const Reduction& reduction) {
  Universe universe = octree.universe();
  universe.depth -= levels;
  if (levels < 0 || universe.depth < 2)
    throw std::invalid_argument("reduced octree: " + std::to_string(levels) + " of " +
                                std::to_string(octree.universe().depth) + " levels leave fewer than two");
  if (!(reduction.share >= 0.0 && reduction.share <= 1.0))
    throw std::invalid_argument("reduced octree: the share must lie in 0..1");
  // Both universes share their low corner. Along each axis the first large voxel's centre therefore lies
  // behind the first small voxel's centre, by half the difference of their edges.
  const double edge = 1 << levels;
  const glm::dvec4 first = universe.lps_from_voxel * glm::dvec4(glm::dvec3(0.5 * (edge - 1.0)), 1.0);
  for (int axis = 0; axis < 3; ++axis) universe.lps_from_voxel[axis] *= edge;
  universe.lps_from_voxel[3] = first;
  ReducedSource source(octree, levels, reduction);
  return LogicalBuild(universe, source).octree();
}

}  // namespace octotomy::voxel
