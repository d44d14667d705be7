// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/binary_array.h"

#include <stdexcept>

#include "voxel/space/error.h"
#include "voxel/space/text_cursor.h"
#include "voxel/tree/logical_build.h"
#include "voxel/tree/slice_build.h"

namespace octotomy::voxel {
namespace {

constexpr int max_text_depth = 9;

void check_room(int depth, int max_depth) {
  check_depth(depth);
  if (depth > max_depth)
    throw TooLarge("a binary array of depth " + std::to_string(depth) + " has 8^" + std::to_string(depth) +
                   " voxels: at most depth " + std::to_string(max_depth) +
                   " is supported; use a treecode instead");
}

std::size_t byte_count(int depth) {
  return std::size_t{1} << (3 * depth - 3);
}

bool bit(const BinaryArray& array, std::size_t i) {
  return ((array.bytes[i / 8] >> (i % 8)) & 1) != 0;
}

}  // namespace

BinaryArray binary_array(const Octree& octree) {
  check_room(octree.universe().depth, BinaryArray::max_depth);
  BinaryArray array{octree.universe(), std::vector<std::uint8_t>(byte_count(octree.universe().depth), 0)};
  for_each_slice(octree, [&](int z, const SliceBits& slice) {
    const auto side = static_cast<std::size_t>(slice.side);
    for (int y = 0; y < slice.side; ++y) {
      const std::size_t first = side * (static_cast<std::size_t>(y) + side * static_cast<std::size_t>(z));
      // With four voxels a row, two rows share a byte. Longer rows begin at the start of a byte.
      for (std::size_t x = 0; x < side; x += 8)
        array.bytes[(first + x) / 8] |=
            static_cast<std::uint8_t>((slice.row(y)[x / 64] >> (x % 64)) << (first % 8));
    }
  });
  return array;
}

Octree octree_of(const BinaryArray& array) {
  check_room(array.universe.depth, BinaryArray::max_depth);
  if (array.bytes.size() != byte_count(array.universe.depth))
    throw InvalidInput("binary array: a universe of depth " + std::to_string(array.universe.depth) +
                       " takes " + std::to_string(byte_count(array.universe.depth)) + " bytes, here are " +
                       std::to_string(array.bytes.size()));
  return octree_of_slices(array.universe, [&](int z, SliceBits& slice) {
    const auto side = static_cast<std::size_t>(slice.side);
    const std::uint64_t row_bits = side < 8 ? (1U << side) - 1 : 0xff;
    std::uint64_t any = 0;
    for (std::size_t y = 0; y < side; ++y) {
      const std::size_t first = side * (y + side * static_cast<std::size_t>(z));
      std::uint64_t* row = slice.words.data() + y * static_cast<std::size_t>(slice.words_per_row);
      for (std::size_t x = 0; x < side; x += 8) {
        const std::uint64_t bits = (array.bytes[(first + x) / 8] >> (first % 8)) & row_bits;
        any |= bits;
        row[x / 64] |= bits << (x % 64);
      }
    }
    return any != 0;
  });
}

std::string text(const BinaryArray& array) {
  check_room(array.universe.depth, max_text_depth);
  const auto side = static_cast<std::size_t>(array.universe.side());
  std::string result;
  result.reserve(2 * side * side * side + 16 * side);
  std::size_t i = 0;
  for (std::size_t z = 0; z < side; ++z) {
    result += "Slice " + std::to_string(z) + " :\n";
    for (std::size_t y = 0; y < side; ++y)
      for (std::size_t x = 0; x < side; ++x, ++i) {
        result += bit(array, i) ? '1' : '0';
        result += x + 1 == side ? '\n' : ' ';
      }
  }
  return result;
}

BinaryArray parse_binary_array(const Universe& universe, std::string_view text) {
  check_room(universe.depth, max_text_depth);
  const auto side = static_cast<std::size_t>(universe.side());
  TextCursor cursor("binary array", text);
  if (text.size() < side * side * side)
    cursor.refuse_at(text.size(),
                     "the text ends before its " + std::to_string(side * side * side) + " voxels");
  BinaryArray array{universe, std::vector<std::uint8_t>(byte_count(universe.depth), 0)};
  std::size_t i = 0;
  for (std::size_t z = 0; z < side; ++z) {
    cursor.skip_spaces();
    cursor.expect("Slice " + std::to_string(z) + " :");
    for (std::size_t voxel = 0; voxel < side * side; ++voxel, ++i) {
      cursor.skip_spaces();
      if (cursor.accept("1"))
        array.bytes[i / 8] |= static_cast<std::uint8_t>(1U << (i % 8));
      else
        cursor.expect("0");
    }
  }
  cursor.expect_end();
  return array;
}

}  // namespace octotomy::voxel
