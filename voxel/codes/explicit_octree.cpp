// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/explicit_octree.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "voxel/codes/octal_code.h"
#include "voxel/space/error.h"
#include "voxel/space/text_cursor.h"
#include "voxel/tree/logical_build.h"

namespace octotomy::voxel {
namespace {

constexpr std::array status_characters{'E', 'F', 'P'};
constexpr char absent = '.';

constexpr std::size_t entry_count(int level) {
  return std::size_t{1} << (3 * level);
}

void check_room(int depth) {
  check_depth(depth);
  if (depth > ExplicitOctree::max_depth)
    throw TooLarge("an explicit octree of depth " + std::to_string(depth) + " takes 8^" +
                   std::to_string(depth) + " entries: at most depth " +
                   std::to_string(ExplicitOctree::max_depth) + " is supported; use a treecode instead");
}

void fill(const LogicalNode& node, int level, std::size_t entry, std::vector<std::string>& levels) {
  const Status status = node.status();
  levels[static_cast<std::size_t>(level)][entry] = status_characters[static_cast<std::size_t>(status)];
  if (status != Status::Partial) return;
  for (int k = 0; k < 8; ++k) fill(node.child(k), level + 1, 8 * entry + static_cast<std::size_t>(k), levels);
}

// Reads and writes entries in preorder, in which the entries of each level ascend. next_ stores each level's
// next entry.
class ExplicitSource {
 public:
  explicit ExplicitSource(const ExplicitOctree& explicit_levels)
      : levels_(explicit_levels.levels), next_(levels_.size(), 0) {}

  Status open(int level) {
    const auto at = static_cast<std::size_t>(level);
    // The children of the last open Partial node, one level above, begin at eight times its entry.
    if (level > 0 && next_[at] % 8 == 0) skip_to(at, 8 * (next_[at - 1] - 1));
    const std::size_t entry = next_[at]++;
    const char c = levels_[at][entry];
    for (std::size_t status = 0; status < status_characters.size(); ++status)
      if (c == status_characters[status]) {
        if (c == 'P' && at + 1 == levels_.size()) refuse(at, entry, "a voxel cannot be Partial");
        open_.resize(at);
        open_.push_back(entry);
        return static_cast<Status>(status);
      }
    refuse(at, entry, c == absent ? "a child of a Partial node is missing" : "use only E, F, P and '.'");
  }
  void close(bool homogeneous) const {
    if (homogeneous)
      refuse(open_.size() - 1, open_.back(),
             "it and its seven siblings have the same status, so their parent cannot be Partial");
  }
  // After the last Partial node's children every entry must be absent.
  void expect_end() {
    for (std::size_t at = 0; at < levels_.size(); ++at) skip_to(at, levels_[at].size());
  }

 private:
  void skip_to(std::size_t level, std::size_t entry) {
    for (; next_[level] < entry; ++next_[level])
      if (levels_[level][next_[level]] != absent) refuse(level, next_[level], "its parent has no children");
  }
  [[noreturn]] void refuse(std::size_t level, std::size_t entry, const std::string& why) const {
    throw InvalidInput("explicit octree, level " + std::to_string(level) + ", entry " +
                       to_string(OctalCode(static_cast<int>(level), entry)) + ": " + why);
  }

  const std::vector<std::string>& levels_;
  std::vector<std::size_t> next_;
  std::vector<std::size_t> open_;  ///< entries of the node that was opened last and of its ancestors
};

}  // namespace

ExplicitOctree explicit_octree(const Octree& octree) {
  const int depth = octree.universe().depth;
  check_room(depth);
  ExplicitOctree result{octree.universe(), {}};
  for (int level = 0; level <= depth; ++level) result.levels.emplace_back(entry_count(level), absent);
  fill(LogicalNode::root(octree), 0, 0, result.levels);
  return result;
}

Octree octree_of(const ExplicitOctree& levels) {
  const int depth = levels.universe.depth;
  check_room(depth);
  if (levels.levels.size() != static_cast<std::size_t>(depth) + 1)
    throw InvalidInput("explicit octree: depth " + std::to_string(depth) + " takes " +
                       std::to_string(depth + 1) + " levels, here are " +
                       std::to_string(levels.levels.size()));
  for (int level = 0; level <= depth; ++level)
    if (levels.levels[static_cast<std::size_t>(level)].size() != entry_count(level))
      throw InvalidInput("explicit octree, level " + std::to_string(level) + ": takes " +
                         std::to_string(entry_count(level)) + " entries, here are " +
                         std::to_string(levels.levels[static_cast<std::size_t>(level)].size()));
  ExplicitSource source(levels);
  Octree octree = LogicalBuild(levels.universe, source).octree();
  source.expect_end();
  return octree;
}

std::string text(const ExplicitOctree& levels) {
  std::string result;
  for (std::size_t level = 0; level < levels.levels.size(); ++level)
    result += std::to_string(level) + " " + levels.levels[level] + "\n";
  return result;
}

ExplicitOctree parse_explicit_octree(const Universe& universe, std::string_view text) {
  check_room(universe.depth);
  ExplicitOctree result{universe, {}};
  TextCursor cursor("explicit octree", text);
  for (int level = 0; level <= universe.depth; ++level) {
    cursor.skip_spaces();
    cursor.expect(std::to_string(level) + " ");
    const std::size_t start = cursor.position();
    while (cursor.peek() == absent || cursor.peek() == 'E' || cursor.peek() == 'F' || cursor.peek() == 'P')
      cursor.advance();
    const std::size_t count = cursor.position() - start;
    if (count != entry_count(level))
      cursor.refuse("level " + std::to_string(level) + " takes " + std::to_string(entry_count(level)) +
                    " characters E, F, P or '.' instead of " + std::to_string(count));
    result.levels.emplace_back(text.substr(start, count));
  }
  cursor.expect_end();
  return result;
}

}  // namespace octotomy::voxel
