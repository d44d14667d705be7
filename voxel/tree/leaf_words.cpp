// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/leaf_words.h"

#include <cassert>

namespace octotomy::voxel {
namespace {

// For each axis and shift, a mask of the bits of a shifted word that come from the first of two neighbouring
// leaves.
constexpr std::array<std::array<std::uint64_t, 4>, 3> staying{{
    {all_children, 0x7777777777777777, 0x3333333333333333, 0x1111111111111111},
    {all_children, 0x0fff0fff0fff0fff, 0x00ff00ff00ff00ff, 0x000f000f000f000f},
    {all_children, 0x0000ffffffffffff, 0x00000000ffffffff, 0x000000000000ffff},
}};

// The word of 4 x 4 x 4 voxels that begin `shift` voxels into leaf `low` along an axis and end in the next
// leaf, `high`.
std::uint64_t joined_words(std::uint64_t low, std::uint64_t high, int axis, int shift) {
  assert(axis >= 0 && axis < 3 && shift >= 0 && shift < 4);
  if (shift == 0) return low;
  const std::uint64_t stay = staying[static_cast<std::size_t>(axis)][static_cast<std::size_t>(shift)];
  const int stride = 1 << (2 * axis);
  return ((low >> (stride * shift)) & stay) | ((high << (stride * (4 - shift))) & ~stay);
}

}  // namespace

// Copies the words of all leaves in the box. `words_of(block)` returns whether the block is empty, and a
// function that returns the word of a child number.
template <typename Words>
void LeafWords::fill(const glm::ivec3& first, const glm::ivec3& last, const Words& words_of) {
  assert(glm::all(glm::lessThan(last - first, glm::ivec3(side))));
  words_.fill(0);
  any_ = 0;
  every_ = all_children;
  const glm::ivec3 first_block = first >> 2;
  const glm::ivec3 last_block = last >> 2;
  for (int bz = first_block.z; bz <= last_block.z; ++bz)
    for (int by = first_block.y; by <= last_block.y; ++by)
      for (int bx = first_block.x; bx <= last_block.x; ++bx) {
        const auto [is_empty, word_at] = words_of(glm::ivec3(bx, by, bz));
        if (is_empty) {
          every_ = 0;
          continue;
        }
        const glm::ivec3 origin = 4 * glm::ivec3(bx, by, bz);
        const glm::ivec3 low = glm::max(first, origin);
        const glm::ivec3 high = glm::min(last, origin + 3);
        for (int z = low.z; z <= high.z; ++z)
          for (int y = low.y; y <= high.y; ++y)
            for (int x = low.x; x <= high.x; ++x) {
              const std::uint64_t word = word_at(child_index(x & 3, y & 3, z & 3));
              any_ |= word;
              every_ &= word;
              words_[static_cast<std::size_t>((x - first.x) +
                                              side * ((y - first.y) + side * (z - first.z)))] = word;
            }
      }
}

void LeafWords::read(const Octree& octree, const glm::ivec3& first, const glm::ivec3& last) {
  fill(first, last, [&](const glm::ivec3& at) {
    const BlockRef block = octree.leaf_block(at);
    return std::pair(block.is_empty(), [block](int child) { return block.word(child); });
  });
}

void LeafWords::read(const GreyOctree& grey, Window16 window, const glm::ivec3& first,
                     const glm::ivec3& last) {
  const int blocks = (grey.universe().side() + 15) / 16;
  const auto status_in = [window](const MinMax& range) {
    return window_status(range, window.low, window.high);
  };
  fill(first, last, [&](const glm::ivec3& at) {
    const bool outside =
        glm::any(glm::lessThan(at, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(at, glm::ivec3(blocks)));
    const Status status =
        status_in(outside ? MinMax{grey.background(), grey.background()} : grey.range(2, at));
    const GreyBrick* const brick = status == Status::Partial ? &grey.brick(at) : nullptr;
    return std::pair(status == Status::Empty, [=](int child) -> std::uint64_t {
      if (brick == nullptr) return all_children;
      const auto leaf = static_cast<std::size_t>(child);
      const Status within = status_in(brick->leaf_range[leaf]);
      if (within == Status::Partial) return window_bits64(brick->samples[leaf].data(), window);
      return within == Status::Full ? all_children : 0;
    });
  });
}

// The shift is separable: 5 x 5 x 5 leaves are joined along x to 4 x 5 x 5, then along y, then along z.
void LeafWords::shifted(const glm::ivec3& shift, std::uint64_t* words) const {
  std::array<std::uint64_t, 4 * 5 * 5> along_x;
  for (int z = 0; z < 5; ++z)
    for (int y = 0; y < 5; ++y)
      for (int x = 0; x < 4; ++x)
        along_x[static_cast<std::size_t>(x + 4 * (y + 5 * z))] =
            joined_words(word(x, y, z), word(x + 1, y, z), 0, shift.x);
  std::array<std::uint64_t, 4 * 4 * 5> along_y;
  for (std::size_t z = 0; z < 5; ++z)
    for (std::size_t i = 0; i < 16; ++i)
      along_y[i + 16 * z] = joined_words(along_x[i + 20 * z], along_x[i + 4 + 20 * z], 1, shift.y);
  for (std::size_t i = 0; i < 64; ++i) words[i] = joined_words(along_y[i], along_y[i + 16], 2, shift.z);
}

}  // namespace octotomy::voxel
