// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/bi_tree.h"

#include <array>
#include <limits>
#include <stdexcept>
#include <vector>

#include "voxel/space/text_cursor.h"
#include "voxel/tree/logical_build.h"
#include "voxel/tree/slice_build.h"

// Dynamic programming over all boxes that halving can reach. Srihari leaves the choice of axes open because
// of its cost; with at most 2^7 voxels a side the exact optimum is affordable.

namespace octotomy::voxel {
namespace {

/// A box of 2^log2[axis] voxels along each axis, at position `at[axis]` in units of its own edge.
struct HalvedBox {
  glm::ivec3 log2{0};
  glm::ivec3 at{0};

  HalvedBox half(int axis, int which) const {
    HalvedBox box = *this;
    --box.log2[axis];
    box.at[axis] = 2 * box.at[axis] + which;
    return box;
  }
  glm::ivec3 first() const { return {at.x << log2.x, at.y << log2.y, at.z << log2.z}; }
  glm::ivec3 end() const { return {(at.x + 1) << log2.x, (at.y + 1) << log2.y, (at.z + 1) << log2.z}; }
  std::uint64_t voxel_count() const { return std::uint64_t{1} << (log2.x + log2.y + log2.z); }
};

class LeastBiTree {
 public:
  explicit LeastBiTree(const Octree& octree)
      : depth_(octree.universe().depth),
        side_(octree.universe().side()),
        sums_(entry({side_, side_, side_}) + 1, 0) {
    for_each_slice(octree, [&](int z, const SliceBits& slice) {
      for (int y = 0; y < side_; ++y)
        for (int x = 0; x < side_; ++x)
          sums_[entry({x + 1, y + 1, z + 1})] = (slice.row(y)[x / 64] >> (x % 64)) & 1;
    });
    // For each corner the number of object voxels below it along all axes, summed along one axis after the
    // other.
    for (int axis = 0; axis < 3; ++axis)
      for (int z = 1; z <= side_; ++z)
        for (int y = 1; y <= side_; ++y)
          for (int x = 1; x <= side_; ++x) {
            glm::ivec3 before(x, y, z);
            --before[axis];
            sums_[entry({x, y, z})] += sums_[entry(before)];
          }
    const std::size_t boxes = static_cast<std::size_t>(2 * side_ - 1);
    least_.assign(boxes * boxes * boxes, 0);
    axes_.assign(least_.size(), 0);
  }

  std::string nodes() {
    const HalvedBox whole{glm::ivec3(depth_), glm::ivec3(0)};
    node_count(whole);
    std::string nodes;
    append(whole, nodes);
    return nodes;
  }

 private:
  std::size_t entry(const glm::ivec3& corner) const {
    const auto edge = static_cast<std::size_t>(side_) + 1;
    return static_cast<std::size_t>(corner.x) +
           edge * (static_cast<std::size_t>(corner.y) + edge * static_cast<std::size_t>(corner.z));
  }
  /// Along an axis, boxes of 2^k voxels are numbered after all boxes with more voxels.
  std::size_t number(const HalvedBox& box) const {
    std::size_t number = 0;
    for (int axis = 2; axis >= 0; --axis) {
      const int of_size = (1 << (depth_ - box.log2[axis])) - 1 + box.at[axis];
      number = number * static_cast<std::size_t>(2 * side_ - 1) + static_cast<std::size_t>(of_size);
    }
    return number;
  }
  Status status(const HalvedBox& box) const {
    const std::array<glm::ivec3, 2> corners{box.first(), box.end()};
    std::uint32_t full = 0;
    for (int k = 0; k < 8; ++k) {
      const glm::ivec3 corner(corners[static_cast<std::size_t>(k & 1)].x,
                              corners[static_cast<std::size_t>((k >> 1) & 1)].y,
                              corners[static_cast<std::size_t>(k >> 2)].z);
      const bool is_added = ((k & 1) + ((k >> 1) & 1) + (k >> 2)) % 2 == 1;
      full = is_added ? full + sums_[entry(corner)] : full - sums_[entry(corner)];
    }
    return full == 0 ? Status::Empty : full == box.voxel_count() ? Status::Full : Status::Partial;
  }
  std::uint32_t node_count(const HalvedBox& box) {
    const std::size_t i = number(box);
    if (least_[i] != 0) return least_[i];
    if (status(box) != Status::Partial) return least_[i] = 1;
    std::uint32_t best = std::numeric_limits<std::uint32_t>::max();
    for (int axis = 0; axis < 3; ++axis) {
      if (box.log2[axis] == 0) continue;
      const std::uint32_t count = 1 + node_count(box.half(axis, 0)) + node_count(box.half(axis, 1));
      if (count >= best) continue;
      best = count;
      axes_[i] = static_cast<std::uint8_t>(axis);
    }
    return least_[i] = best;
  }
  void append(const HalvedBox& box, std::string& nodes) const {
    const Status found = status(box);
    if (found != Status::Partial) {
      nodes += found == Status::Full ? 'F' : 'E';
      return;
    }
    const int axis = axes_[number(box)];
    nodes += "xyz"[axis];
    append(box.half(axis, 0), nodes);
    append(box.half(axis, 1), nodes);
  }

  int depth_, side_;
  std::vector<std::uint32_t> sums_;
  std::vector<std::uint32_t> least_;  ///< number of nodes of each box's smallest tree; 0: not computed yet
  std::vector<std::uint8_t> axes_;    ///< the axis along which each box's smallest tree halves it
};

class BiTreeReader {
 public:
  BiTreeReader(const BiTree& tree, std::vector<HalvedBox>& full)
      : cursor_("bi-tree", tree.nodes), full_(full) {}

  Status read(const HalvedBox& box) {
    const std::size_t start = cursor_.position();
    const char node = cursor_.peek();
    if (node == 'E' || node == 'F') {
      cursor_.advance();
      if (node == 'F') full_.push_back(box);
      return node == 'F' ? Status::Full : Status::Empty;
    }
    if (node < 'x' || node > 'z') cursor_.refuse_unexpected("a node, E, F, x, y or z");
    const int axis = node - 'x';
    if (box.log2[axis] == 0)
      cursor_.refuse("the node has one voxel along that axis: choose a deeper universe");
    cursor_.advance();
    const Status low = read(box.half(axis, 0)), high = read(box.half(axis, 1));
    if (low == high && low != Status::Partial)
      cursor_.refuse_at(
          start, "its halves are both Full or both Empty: write one Full or Empty node in their place");
    return Status::Partial;
  }
  void expect_end() { cursor_.expect_end(); }

 private:
  TextCursor cursor_;
  std::vector<HalvedBox>& full_;
};

void check_bi_depth(int depth) {
  check_depth(depth);
  if (depth > BiTree::max_depth)
    throw std::length_error("bi-tree: a universe of " + std::to_string(depth) + " levels, at most " +
                            std::to_string(BiTree::max_depth));
}

}  // namespace

BiTree bi_tree(const Octree& octree) {
  check_bi_depth(octree.universe().depth);
  return {octree.universe(), LeastBiTree(octree).nodes()};
}

Octree octree_of(const BiTree& tree) {
  check_bi_depth(tree.universe.depth);
  std::vector<HalvedBox> full;
  BiTreeReader reader(tree, full);
  reader.read({glm::ivec3(tree.universe.depth), glm::ivec3(0)});
  reader.expect_end();
  return octree_of_slices(tree.universe, [&](int z, SliceBits& slice) {
    bool any = false;
    for (const HalvedBox& box : full) {
      const glm::ivec3 first = box.first(), end = box.end();
      if (z < first.z || z >= end.z) continue;
      any = true;
      for (int y = first.y; y < end.y; ++y) set_row(slice, y, first.x, end.x - 1);
    }
    return any;
  });
}

std::string text(const BiTree& tree) {
  return tree.nodes;
}

BiTree parse_bi_tree(const Universe& universe, std::string_view text) {
  check_bi_depth(universe.depth);
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r' || text.back() == ' '))
    text.remove_suffix(1);
  return {universe, std::string(text)};
}

}  // namespace octotomy::voxel
