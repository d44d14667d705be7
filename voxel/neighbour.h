// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "voxel/cuberille_faces.h"
#include "voxel/logical_node.h"
#include "voxel/octal_code.h"

namespace octotomy::voxel {

/// A node with its code.
struct CodedNode {
  OctalCode code;
  Status status = Status::Empty;
};

/// The node of a code, or the homogeneous one that holds it: the point location problem (thesis 3.4.5).
/// Precondition: the code at most as deep as the universe.
CodedNode node_at(const Octree& octree, const OctalCode& code);

/// The path from the root to a current node, the thesis's ancestor array, with a count of the nodes that were
/// looked at: neighbours are found by walking up from the pivot, the deepest ancestor that node and neighbour
/// share, along the neighbour's code (thesis 3.4.5, theorem 3.1). The octree must outlive it.
class AncestorArray {
 public:
  explicit AncestorArray(const Octree& octree);

  /// Makes the node of a code current, or the homogeneous one that holds it, and walks there from the deepest
  /// ancestor already on the path. Precondition: the code at most as deep as the universe.
  void go_to(const OctalCode& code);
  CodedNode current() const { return {code_, path_[static_cast<std::size_t>(code_.level())].status()}; }

  /// The face neighbour of the current node: of its size, or the homogeneous node that holds that place.
  /// None beyond the universe's border, where no node is looked at. The current node stays.
  std::optional<CodedNode> neighbour(Direction direction);

  /// Nodes looked at by go_to() and neighbour() since the start: those walked to, not the pivots.
  std::uint64_t access_count() const { return access_count_; }

 private:
  std::array<LogicalNode, Universe::max_depth + 1> path_;  ///< by level, up to the current node's
  OctalCode code_;
  std::uint64_t access_count_ = 0;
};

/// The code of the node of the same size beside a node, by bitwise operations; none beyond the universe.
std::optional<OctalCode> neighbour_code(const OctalCode& code, Direction direction);

/// What finding a neighbour costs the usual way (thesis 3.4.5): a walk down from the node to the common
/// ancestor and back up in its reflection, counted in nodes. Precondition: `neighbour` was found from `node`.
int accesses_down_and_up(const OctalCode& node, const OctalCode& neighbour);

}  // namespace octotomy::voxel
