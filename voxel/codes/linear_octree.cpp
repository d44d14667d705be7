// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/linear_octree.h"

#include <algorithm>
#include <cassert>
#include <stdexcept>

#include "voxel/space/error.h"
#include "voxel/space/text_cursor.h"
#include "voxel/tree/logical_build.h"

namespace octotomy::voxel {
namespace {

void append(const LogicalNode& node, const OctalCode& code, std::vector<OctalCode>& full) {
  const Status status = node.status();
  if (status == Status::Full) full.push_back(code);
  if (status != Status::Partial) return;
  for (int k = 0; k < 8; ++k) append(node.child(k), code.child(k), full);
}

// Returns the statuses of nodes in preorder. The next code of the list is compared with each node.
class LinearSource {
 public:
  explicit LinearSource(const LinearOctree& linear) : codes_(linear.full) { path_.push_back(OctalCode()); }

  Status open(int level) {
    while (path_.back().level() > level) path_.pop_back();
    // In preorder a node is the first child of a Partial node, or the next sibling of the node that was read
    // before it on its level.
    if (path_.back().level() == level && level > 0)
      path_.back() = OctalCode(level, path_.back().digits() + 1);
    else if (level > 0)
      path_.push_back(path_.back().child(0));
    const OctalCode node = path_.back();
    if (next_ == codes_.size()) return Status::Empty;
    const OctalCode& next = codes_[next_];
    if (next.level() < level || next.ancestor(level) != node) return Status::Empty;
    if (next.level() > level) return Status::Partial;
    ++next_;
    return Status::Full;
  }
  void close(bool homogeneous) const {
    if (homogeneous)
      refuse(next_ - 1, "is the last of eight full children: write their parent's code instead");
  }
  [[noreturn]] void refuse(std::size_t index, const std::string& why) const {
    throw InvalidInput("linear octree, code " + std::to_string(index + 1) + ", " + to_string(codes_[index]) +
                       ": " + why);
  }

 private:
  const std::vector<OctalCode>& codes_;
  std::vector<OctalCode> path_;  ///< the node that was opened last and its ancestors
  std::size_t next_ = 0;
};

}  // namespace

LinearOctree linear_octree(const Octree& octree) {
  LinearOctree linear{octree.universe(), {}};
  append(LogicalNode::root(octree), OctalCode(), linear.full);
  return linear;
}

Octree octree_of(const LinearOctree& linear) {
  LinearSource source(linear);
  for (std::size_t i = 0; i < linear.full.size(); ++i) {
    const OctalCode& code = linear.full[i];
    if (code.level() > linear.universe.depth)
      source.refuse(i, "is deeper than the universe's " + std::to_string(linear.universe.depth) + " levels");
    if (i == 0) continue;
    const OctalCode& before = linear.full[i - 1];
    if (code <= before) source.refuse(i, "does not come after " + to_string(before));
    if (code.level() > before.level() && code.ancestor(before.level()) == before)
      source.refuse(i, "lies inside " + to_string(before) + ", which is Full");
  }
  return LogicalBuild(linear.universe, source).octree();
}

std::string text(const LinearOctree& linear) {
  std::string result;
  for (const OctalCode& code : linear.full) {
    if (!result.empty()) result += ", ";
    result += to_string(code);
  }
  return result;
}

LinearOctree parse_linear_octree(const Universe& universe, std::string_view text) {
  LinearOctree linear{universe, {}};
  TextCursor cursor("linear octree", text);
  for (cursor.skip_spaces(); !cursor.at_end(); cursor.skip_spaces()) {
    if (!linear.full.empty()) {
      cursor.expect(",");
      cursor.skip_spaces();
    }
    if (cursor.accept("root")) {
      linear.full.emplace_back();
      continue;
    }
    OctalCode code;
    const std::size_t start = cursor.position();
    while (cursor.peek() >= '0' && cursor.peek() <= '7') {
      if (code.level() == universe.depth)
        cursor.refuse_at(start, "the code has more digits than the universe has levels, " +
                                    std::to_string(universe.depth));
      code = code.child(cursor.peek() - '0');
      cursor.advance();
    }
    if (code.level() == 0) cursor.refuse_unexpected("an octal code");
    linear.full.push_back(code);
  }
  return linear;
}

bool contains(const LinearOctree& linear, const glm::ivec3& voxel) {
  assert(glm::all(glm::greaterThanEqual(voxel, glm::ivec3(0))) &&
         glm::all(glm::lessThan(voxel, glm::ivec3(linear.universe.side()))));
  const int depth = linear.universe.depth;
  const OctalCode code = octal_code_of(voxel, depth, depth);
  // Only the last Full node whose code does not come after the voxel's code can contain the voxel.
  const auto after = std::upper_bound(linear.full.begin(), linear.full.end(), code);
  return after != linear.full.begin() && code.ancestor(std::prev(after)->level()) == *std::prev(after);
}

}  // namespace octotomy::voxel
