// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/octal_code.h"

#include <algorithm>
#include <cassert>

namespace octotomy::voxel {

std::strong_ordering OctalCode::operator<=>(const OctalCode& other) const {
  const int common = std::min(level_, other.level_);
  const auto by_digits = ancestor(common).digits_ <=> other.ancestor(common).digits_;
  return by_digits != std::strong_ordering::equal ? by_digits : level_ <=> other.level_;
}

OctalCode octal_code_of(const glm::ivec3& voxel, int depth, int level) {
  assert(level >= 0 && level <= depth);
  std::uint64_t digits = 0;
  for (int bit = depth - 1; bit >= depth - level; --bit) {
    const glm::ivec3 bits = (voxel >> bit) & 1;
    digits = 8 * digits + static_cast<std::uint64_t>(bits.x + 2 * bits.y + 4 * bits.z);
  }
  return {level, digits};
}

glm::ivec3 origin_voxel(const OctalCode& code, int depth) {
  glm::ivec3 origin(0);
  for (int level = 1; level <= code.level(); ++level) {
    const int k = code.element(level);
    origin += glm::ivec3(k & 1, (k >> 1) & 1, k >> 2) << (depth - level);
  }
  return origin;
}

std::string to_string(const OctalCode& code) {
  if (code.level() == 0) return "root";
  std::string text;
  for (int level = 1; level <= code.level(); ++level) text += static_cast<char>('0' + code.element(level));
  return text;
}

}  // namespace octotomy::voxel
