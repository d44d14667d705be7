// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/treecode.h"

#include "voxel/space/text_cursor.h"
#include "voxel/tree/logical_build.h"

namespace octotomy::voxel {
namespace {

void append(const LogicalNode& node, std::string& text) {
  const Status status = node.status();
  text += status == Status::Empty ? 'E' : status == Status::Full ? 'F' : 'P';
  if (status != Status::Partial) return;
  text += '(';
  for (int k = 0; k < 8; ++k) append(node.child(k), text);
  text += ')';
}

class TreecodeSource {
 public:
  TreecodeSource(int depth, std::string_view text) : cursor_("treecode", text), depth_(depth) {}

  Status open(int level) {
    cursor_.skip_spaces();
    const std::size_t start = cursor_.position();
    if (cursor_.accept("E")) return Status::Empty;
    if (cursor_.accept("F")) return Status::Full;
    if (!cursor_.accept("P")) cursor_.refuse_unexpected("a node, E, F or P");
    if (level == depth_)
      cursor_.refuse_at(start, "a node of level " + std::to_string(level) +
                                   " is a voxel and cannot be Partial: choose a deeper universe");
    cursor_.skip_spaces();
    cursor_.expect("(");
    return Status::Partial;
  }
  void close(bool homogeneous) {
    cursor_.skip_spaces();
    if (homogeneous)
      cursor_.refuse("the eight children before it are all Full or all Empty: write their parent as F or E");
    cursor_.expect(")");
  }
  void expect_end() { cursor_.expect_end(); }

 private:
  TextCursor cursor_;
  int depth_;
};

}  // namespace

std::string treecode(const Octree& octree) {
  std::string text;
  append(LogicalNode::root(octree), text);
  return text;
}

Octree octree_of_treecode(const Universe& universe, std::string_view text) {
  TreecodeSource source(universe.depth, text);
  Octree octree = LogicalBuild(universe, source).octree();
  source.expect_end();
  return octree;
}

}  // namespace octotomy::voxel
