// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/multivalued_octree.h"

#include <algorithm>
#include <stdexcept>

#include "voxel/space/text_cursor.h"
#include "voxel/tree/logical_build.h"

namespace octotomy::voxel {
namespace {

class MultivaluedWalk {
 public:
  explicit MultivaluedWalk(std::vector<std::uint8_t>& nodes) : nodes_(nodes) {}

  void walk(const std::vector<LogicalNode>& at) {
    // The first object that is not Empty here decides the node: if it is Full, all voxels have its number; if
    // it is Partial, only some voxels have its number, so the node is not homogeneous.
    const auto first = std::find_if(at.begin(), at.end(),
                                    [](const LogicalNode& node) { return node.status() != Status::Empty; });
    if (first == at.end()) return nodes_.push_back(0);
    if (first->status() == Status::Full)
      return nodes_.push_back(static_cast<std::uint8_t>(first - at.begin() + 1));
    nodes_.push_back(MultivaluedOctree::partial);
    for (int k = 0; k < 8; ++k) {
      std::vector<LogicalNode> children;
      for (const LogicalNode& node : at) children.push_back(node.child(k));
      walk(children);
    }
  }

 private:
  std::vector<std::uint8_t>& nodes_;
};

class NumberSource {
 public:
  NumberSource(const MultivaluedOctree& tree, int number) : tree_(tree), number_(number) {}

  Status open(int level) {
    if (next_ == tree_.nodes.size()) refuse("is missing");
    const std::uint8_t node = tree_.nodes[next_++];
    if (node != MultivaluedOctree::partial) return node == number_ ? Status::Full : Status::Empty;
    if (level == tree_.universe.depth) refuse("is a voxel and cannot be Partial");
    opened_.push_back(next_);
    return Status::Partial;
  }
  void close(bool /*homogeneous*/) {
    const std::size_t first = opened_.back();
    opened_.pop_back();
    const std::uint8_t node = tree_.nodes[first];
    if (next_ - first == 8 && node != MultivaluedOctree::partial &&
        std::all_of(tree_.nodes.begin() + static_cast<std::ptrdiff_t>(first),
                    tree_.nodes.begin() + static_cast<std::ptrdiff_t>(next_),
                    [&](std::uint8_t n) { return n == node; }))
      refuse("is the last of eight children with one number: write their parent with this number");
  }
  void expect_end() {
    if (next_ == tree_.nodes.size()) return;
    ++next_;
    refuse("comes after the last");
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw std::invalid_argument("multivalued octree, node " + std::to_string(next_) + ": " + why);
  }

  const MultivaluedOctree& tree_;
  int number_;
  std::size_t next_ = 0;
  std::vector<std::size_t> opened_;
};

void append(const std::vector<std::uint8_t>& nodes, std::size_t& next, std::string& text) {
  const std::uint8_t node = nodes[next++];
  if (node != MultivaluedOctree::partial) {
    text += std::to_string(node);
    return;
  }
  text += "P(";
  for (int k = 0; k < 8; ++k) {
    if (k > 0) text += ' ';
    append(nodes, next, text);
  }
  text += ')';
}

void read(TextCursor& cursor, int level, int depth, std::vector<std::uint8_t>& nodes) {
  cursor.skip_spaces();
  const std::size_t start = cursor.position();
  if (!cursor.accept("P")) {
    nodes.push_back(static_cast<std::uint8_t>(cursor.number(MultivaluedOctree::partial - 1)));
    return;
  }
  if (level == depth) cursor.refuse_at(start, "a voxel cannot be Partial: choose a deeper universe");
  cursor.expect("(");
  nodes.push_back(MultivaluedOctree::partial);
  for (int k = 0; k < 8; ++k) read(cursor, level + 1, depth, nodes);
  cursor.skip_spaces();
  cursor.expect(")");
}

}  // namespace

MultivaluedOctree multivalued_octree(const std::vector<Octree>& objects) {
  if (objects.empty() || objects.size() >= MultivaluedOctree::partial)
    throw std::invalid_argument("multivalued octree: " + std::to_string(objects.size()) +
                                " objects instead of 1 to 254");
  MultivaluedOctree tree{objects.front().universe(), {}};
  std::vector<LogicalNode> roots;
  for (const Octree& object : objects) {
    if (!(object.universe() == tree.universe))
      throw std::invalid_argument("multivalued octree: the objects have different universes");
    roots.push_back(LogicalNode::root(object));
  }
  MultivaluedWalk(tree.nodes).walk(roots);
  return tree;
}

Octree object_of(const MultivaluedOctree& tree, int number) {
  NumberSource source(tree, number);
  Octree octree = LogicalBuild(tree.universe, source).octree();
  source.expect_end();
  return octree;
}

std::string text(const MultivaluedOctree& tree) {
  std::string result;
  std::size_t next = 0;
  append(tree.nodes, next, result);
  return result;
}

MultivaluedOctree parse_multivalued_octree(const Universe& universe, std::string_view text) {
  check_depth(universe.depth);
  MultivaluedOctree tree{universe, {}};
  TextCursor cursor("multivalued octree", text);
  read(cursor, 0, universe.depth, tree.nodes);
  cursor.expect_end();
  return tree;
}

}  // namespace octotomy::voxel
