// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/marginal_index.h"

#include <algorithm>
#include <cassert>

#include "voxel/codes/row_index.h"
#include "voxel/tree/slice_build.h"

namespace octotomy::voxel {
namespace {

constexpr const char* code = "marginal index";

bool any_bit(const std::uint64_t* words, std::size_t count) {
  return std::any_of(words, words + count, [](std::uint64_t word) { return word != 0; });
}

void check_row(const MarginalIndex::Row& row, std::size_t z, std::size_t y, int side) {
  if (row.empty()) return;
  const auto words = static_cast<std::size_t>((side + 63) / 64);
  if (row.size() != words)
    refuse_row(code, z, y,
               ": has " + std::to_string(row.size()) + " words instead of " + std::to_string(words));
  if (!any_bit(row.data(), row.size())) refuse_row(code, z, y, ": holds no voxel, so it must be Null");
  if (side < 64 && (row.front() >> side) != 0) refuse_row(code, z, y, ": has bits beyond the universe");
}

}  // namespace

MarginalIndex marginal_index(const Octree& octree) {
  const auto side = static_cast<std::size_t>(octree.universe().side());
  MarginalIndex index{octree.universe(), std::vector<MarginalIndex::Slice>(side)};
  for_each_slice(octree, [&](int z, const SliceBits& bits) {
    MarginalIndex::Slice& slice = index.slices[static_cast<std::size_t>(z)];
    slice.resize(side);
    for (int y = 0; y < bits.side; ++y) {
      const std::uint64_t* row = bits.row(y);
      if (any_bit(row, static_cast<std::size_t>(bits.words_per_row)))
        slice[static_cast<std::size_t>(y)].assign(row, row + bits.words_per_row);
    }
  });
  return index;
}

Octree octree_of(const MarginalIndex& index) {
  check_slices(code, index, [&](const auto& row, std::size_t z, std::size_t y) {
    check_row(row, z, y, index.universe.side());
  });
  return octree_of_slices(index.universe, [&](int z, SliceBits& bits) {
    const MarginalIndex::Slice& slice = index.slices[static_cast<std::size_t>(z)];
    for (std::size_t y = 0; y < slice.size(); ++y)
      std::copy(
          slice[y].begin(), slice[y].end(),
          bits.words.begin() + static_cast<std::ptrdiff_t>(y * static_cast<std::size_t>(bits.words_per_row)));
    return !slice.empty();
  });
}

bool contains(const MarginalIndex& index, const glm::ivec3& voxel) {
  assert(glm::all(glm::greaterThanEqual(voxel, glm::ivec3(0))) &&
         glm::all(glm::lessThan(voxel, glm::ivec3(index.universe.side()))));
  const MarginalIndex::Slice& slice = index.slices[static_cast<std::size_t>(voxel.z)];
  if (slice.empty()) return false;
  const MarginalIndex::Row& row = slice[static_cast<std::size_t>(voxel.y)];
  return !row.empty() && ((row[static_cast<std::size_t>(voxel.x / 64)] >> (voxel.x % 64)) & 1) != 0;
}

std::string text(const MarginalIndex& index) {
  const auto side = static_cast<std::size_t>(index.universe.side());
  return text_of_slices(index, [&](const MarginalIndex::Row& row) {
    std::string bits;
    for (std::size_t x = 0; x < side; ++x) bits += static_cast<char>('0' + ((row[x / 64] >> (x % 64)) & 1));
    return bits;
  });
}

MarginalIndex parse_marginal_index(const Universe& universe, std::string_view text) {
  const auto side = static_cast<std::size_t>(universe.side());
  return parse_slices<MarginalIndex>(code, universe, text, [&](TextCursor& cursor, MarginalIndex::Row& row) {
    row.assign((side + 63) / 64, 0);
    for (std::size_t x = 0; x < side; ++x) {
      if (cursor.accept("1"))
        row[x / 64] |= std::uint64_t{1} << (x % 64);
      else
        cursor.expect("0");
    }
  });
}

}  // namespace octotomy::voxel
