// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "voxel/tree/logical_node.h"
#include "voxel/view/camera.h"
#include "voxel/view/column_map.h"
#include "voxel/view/counted_walk.h"

// The common part of the thesis's walks along an axis (appendix A.2). Quadtree child i is the projection of
// octree children front(i) and back(i) (table 4.3). The picture stores for every column the number of voxels
// in front of the object's first voxel.

namespace octotomy::voxel {

/// Entry i + side j (as in ColumnMap) is the number of voxels before the object's first voxel in column (i,
/// j); -1: an empty column.
using ColumnDepths = std::vector<std::int32_t>;

class AxisFrame {
 public:
  AxisFrame(const AxisView& axes, int depth) : axes_(axes), depth_(depth), side_(1 << depth) {}

  int depth() const { return depth_; }
  int side() const { return side_; }
  std::size_t column_count() const {
    return static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_);
  }
  std::size_t column(int p, int q) const {
    return static_cast<std::size_t>(p) + static_cast<std::size_t>(q) * static_cast<std::size_t>(side_);
  }
  /// The number x + 2y + 4z of the front or, with `behind`, the back octree child that projects onto quadtree
  /// child p + 2q.
  int child(int quadtree_child, bool behind) const {
    const bool far_half = behind != axes_.reversed[2];
    return ((quadtree_child & 1) << axes_.axis[0]) | ((quadtree_child >> 1) << axes_.axis[1]) |
           (static_cast<int>(far_half) << axes_.axis[2]);
  }
  /// The number of the child that contains column (p, q) at a depth of d voxels, for a node at `level`.
  int child_at(int level, int p, int q, int d) const {
    const int bit = depth_ - 1 - level;
    return child(((p >> bit) & 1) | (((q >> bit) & 1) << 1), ((d >> bit) & 1) != 0);
  }

  /// Sets the depth d in the square of columns that a node at `level` covers.
  void paint(ColumnDepths& columns, int p, int q, int level, int d) const {
    const int edge = side_ >> level;
    for (int row = q; row < q + edge; ++row)
      for (int at = p; at < p + edge; ++at) columns[column(at, row)] = d;
  }

 private:
  AxisView axes_;
  int depth_, side_;
};

/// Computes the column map of a view. `walk(frame, root, counter, columns)` fills the columns of one object,
/// with the node and the counter that walk_object() passes.
template <typename Walk>
ColumnMap walk_columns(const std::vector<DrawnObject>& objects, const AxisView& axes, Visits* visits,
                       const Walk& walk) {
  const AxisFrame frame(axes, objects.front().octree.universe().depth);
  std::vector<ColumnDepths> before;
  for (const DrawnObject& object : objects) {
    before.emplace_back(frame.column_count(), -1);
    walk_object(object, frame.column_count(), visits,
                [&](const auto& root, auto& counter) { walk(frame, root, counter, before.back()); });
  }
  return column_map(objects, axes, before);
}

}  // namespace octotomy::voxel
