// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cassert>
#include <compare>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>

#include "voxel/tree/logical_node.h"

namespace octotomy::voxel {

/// The path from the root to a node (thesis 3.4.1): one octal digit x + 2y + 4z per level, from the root's
/// children down. Codes are ordered in preorder: a node before those inside it, siblings by their digit.
class OctalCode {
 public:
  /// The root's code, without digits.
  OctalCode() = default;
  /// Precondition: `digits` is below 8^level; the deepest digit is the lowest.
  OctalCode(int level, std::uint64_t digits) : digits_(digits), level_(level) {
    assert(level >= 0 && level <= 21 && digits >> (3 * level) == 0);
  }

  int level() const { return level_; }
  std::uint64_t digits() const { return digits_; }
  /// The digit of a level. Precondition: the level is in 1..level().
  int element(int level) const {
    assert(level >= 1 && level <= level_);
    return static_cast<int>((digits_ >> (3 * (level_ - level))) & 7);
  }
  OctalCode child(int number) const { return {level_ + 1, 8 * digits_ + static_cast<std::uint64_t>(number)}; }
  /// The ancestor at a level, or this node itself. Precondition: the level is in 0..level().
  OctalCode ancestor(int level) const {
    assert(level >= 0 && level <= level_);
    return {level, digits_ >> (3 * (level_ - level))};
  }

  bool operator==(const OctalCode&) const = default;
  std::strong_ordering operator<=>(const OctalCode& other) const;

 private:
  std::uint64_t digits_ = 0;
  int level_ = 0;
};

/// The code of the node that contains a voxel on a level (equation 3.6), in a universe of the given depth.
/// Preconditions: the voxel is in the universe, the level is in 0..depth.
OctalCode octal_code_of(const glm::ivec3& voxel, int depth, int level);
/// The node's voxel with the smallest indices.
glm::ivec3 origin_voxel(const OctalCode& code, int depth);

/// The digits, or "root".
std::string to_string(const OctalCode& code);

}  // namespace octotomy::voxel
