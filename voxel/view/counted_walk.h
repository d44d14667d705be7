// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <limits>

#include "voxel/tree/grey_node.h"
#include "voxel/tree/logical_node.h"
#include "voxel/tree/partial_octree.h"
#include "voxel/view/drawn_object.h"
#include "voxel/view/visits.h"

namespace octotomy::voxel {

/// A node of an object digitised by partial volume, with the status that the thesis assigns to it when
/// counting.
class PartialVolumeNode {
 public:
  PartialVolumeNode() = default;
  PartialVolumeNode(const LogicalNode& inside, const LogicalNode& touching)
      : inside_(inside), touching_(touching) {}

  Status status() const {
    if (inside_.status() == Status::Full) return Status::Full;
    const Status touched = touching_.status();
    if (touched == Status::Empty) return Status::Empty;
    return side_log2() == 0 ? Status::Full : Status::Partial;
  }
  int side_log2() const { return touching_.side_log2(); }
  PartialVolumeNode child(int number) const { return {inside_.child(number), touching_.child(number)}; }

 private:
  LogicalNode inside_, touching_;
};

/// Calls `walk(root, counter)` for an object. Without `visits` the counter compiles to nothing. Otherwise the
/// counts are added to `visits`, and `root` is the root of the tree in which the object's visits are counted.
template <typename Walk>
void walk_object(const DrawnObject& object, std::uint64_t pixel_count, Visits* visits, const Walk& walk) {
  if (visits == nullptr) {
    NoVisits none;
    walk(LogicalNode::root(object.octree), none);
    return;
  }
  const auto window = object.grey ? window16(object.grey->in_steps(object.threshold),
                                             static_cast<double>(std::numeric_limits<std::int16_t>::max()))
                                  : std::nullopt;
  if (object.counted_in_grey && window) {
    VisitCounter counter(level_counts(*object.grey, *window), pixel_count);
    walk(GreyNode::root(*object.grey, *window), counter);
    visits->add(counter.visits());
  } else if (object.inside) {
    VisitCounter counter(level_counts(PartialOctree{*object.inside, object.octree, {}}), pixel_count);
    walk(PartialVolumeNode(LogicalNode::root(*object.inside), LogicalNode::root(object.octree)), counter);
    visits->add(counter.visits());
  } else {
    VisitCounter counter(level_counts(object.octree), pixel_count);
    walk(LogicalNode::root(object.octree), counter);
    visits->add(counter.visits());
  }
}

}  // namespace octotomy::voxel
