// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/neighbour.h"

#include <algorithm>
#include <utility>

namespace octotomy::voxel {
namespace {

template <std::size_t... level>
std::array<LogicalNode, sizeof...(level)> filled(const LogicalNode& node, std::index_sequence<level...>) {
  return {(static_cast<void>(level), node)...};
}

// The level of the deepest node that two codes share.
int common_level(const OctalCode& a, const OctalCode& b) {
  int level = std::min(a.level(), b.level());
  while (a.ancestor(level) != b.ancestor(level)) --level;
  return level;
}

}  // namespace

CodedNode node_at(const Octree& octree, const OctalCode& code) {
  LogicalNode node = LogicalNode::root(octree);
  int level = 0;
  for (; level < code.level() && node.status() == Status::Partial; ++level)
    node = node.child(code.element(level + 1));
  return {code.ancestor(level), node.status()};
}

AncestorArray::AncestorArray(const Octree& octree)
    : path_(filled(LogicalNode::root(octree), std::make_index_sequence<Universe::max_depth + 1>())) {}

void AncestorArray::go_to(const OctalCode& code) {
  int level = common_level(code_, code);
  auto at = static_cast<std::size_t>(level);
  for (; level < code.level() && path_[at].status() == Status::Partial; ++level, ++at) {
    path_[at + 1] = path_[at].child(code.element(level + 1));
    ++access_count_;
  }
  code_ = code.ancestor(level);
}

std::optional<CodedNode> AncestorArray::neighbour(Direction direction) {
  const std::optional<OctalCode> code = neighbour_code(code_, direction);
  if (!code) return std::nullopt;
  // The pivot is Partial, as the current node lies inside it.
  int level = common_level(code_, *code);
  LogicalNode node = path_[static_cast<std::size_t>(level)];
  while (level < code->level() && node.status() == Status::Partial) {
    node = node.child(code->element(++level));
    ++access_count_;
  }
  return CodedNode{code->ancestor(level), node.status()};
}

std::optional<OctalCode> neighbour_code(const OctalCode& code, Direction direction) {
  const int number = static_cast<int>(direction);
  const std::uint64_t axis_bit = std::uint64_t{1} << (number / 2);
  const bool up = number % 2 == 0;
  // Adding one to an index carries through the digits whose bit is set, subtracting through the others.
  std::uint64_t digits = code.digits();
  for (int level = code.level(); level > 0; --level) {
    const std::uint64_t bit = axis_bit << (3 * (code.level() - level));
    digits ^= bit;
    if (((code.digits() & bit) == 0) == up) return OctalCode(code.level(), digits);
  }
  return std::nullopt;
}

int accesses_down_and_up(const OctalCode& node, const OctalCode& neighbour) {
  const int pivot = common_level(node, neighbour);
  return node.level() - pivot + neighbour.level() - pivot;
}

}  // namespace octotomy::voxel
