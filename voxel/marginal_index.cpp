// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/marginal_index.h"

#include <algorithm>
#include <stdexcept>

#include "voxel/logical_build.h"
#include "voxel/slice_build.h"
#include "voxel/text_cursor.h"

namespace octotomy::voxel {
namespace {

[[noreturn]] void refuse(std::size_t slice, const std::string& where, const std::string& why) {
  throw std::invalid_argument("marginal index, slice " + std::to_string(slice) + where + ": " + why);
}

bool any_bit(const std::uint64_t* words, std::size_t count) {
  return std::any_of(words, words + count, [](std::uint64_t word) { return word != 0; });
}

void check_row(const MarginalIndex::Row& row, std::size_t z, std::size_t y, int side) {
  const std::string where = ", row " + std::to_string(y);
  const auto words = static_cast<std::size_t>((side + 63) / 64);
  if (row.size() != words)
    refuse(z, where, "has " + std::to_string(row.size()) + " words instead of " + std::to_string(words));
  if (!any_bit(row.data(), row.size())) refuse(z, where, "holds nothing: it must be Null");
  if (side < 64 && (row.front() >> side) != 0) refuse(z, where, "has bits beyond the universe");
}

void check(const MarginalIndex& index) {
  check_depth(index.universe.depth);
  const int side = index.universe.side();
  const auto count = static_cast<std::size_t>(side);
  if (index.slices.size() != count)
    throw std::invalid_argument("marginal index: the universe has " + std::to_string(side) +
                                " slices, here are " + std::to_string(index.slices.size()));
  for (std::size_t z = 0; z < count; ++z) {
    const MarginalIndex::Slice& slice = index.slices[z];
    if (slice.empty()) continue;
    if (slice.size() != count)
      refuse(z, "", "has " + std::to_string(slice.size()) + " rows instead of " + std::to_string(side));
    for (std::size_t y = 0; y < count; ++y)
      if (!slice[y].empty()) check_row(slice[y], z, y, side);
    if (std::all_of(slice.begin(), slice.end(), [](const auto& row) { return row.empty(); }))
      refuse(z, "", "holds nothing: it must be Null");
  }
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
  check(index);
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
  const MarginalIndex::Slice& slice = index.slices[static_cast<std::size_t>(voxel.z)];
  if (slice.empty()) return false;
  const MarginalIndex::Row& row = slice[static_cast<std::size_t>(voxel.y)];
  return !row.empty() && ((row[static_cast<std::size_t>(voxel.x / 64)] >> (voxel.x % 64)) & 1) != 0;
}

std::string text(const MarginalIndex& index) {
  const int side = index.universe.side();
  std::string result;
  for (std::size_t z = 0; z < index.slices.size(); ++z) {
    result += std::to_string(z);
    if (index.slices[z].empty()) result += " Null";
    for (const MarginalIndex::Row& row : index.slices[z]) {
      result += ' ';
      if (row.empty()) result += "Null";
      for (int x = 0; x < (row.empty() ? 0 : side); ++x)
        result += static_cast<char>('0' + ((row[static_cast<std::size_t>(x / 64)] >> (x % 64)) & 1));
    }
    result += '\n';
  }
  return result;
}

MarginalIndex parse_marginal_index(const Universe& universe, std::string_view text) {
  check_depth(universe.depth);
  const auto side = static_cast<std::size_t>(universe.side());
  MarginalIndex index{universe, std::vector<MarginalIndex::Slice>(side)};
  TextCursor cursor("marginal index", text);
  for (std::size_t z = 0; z < side; ++z) {
    cursor.skip_spaces();
    cursor.expect(std::to_string(z) + " ");
    MarginalIndex::Slice slice;
    for (cursor.skip_blanks(); !cursor.at_end() && cursor.peek() != '\n' && cursor.peek() != '\r';
         cursor.skip_blanks()) {
      if (slice.size() == side) cursor.refuse("more rows than the universe's " + std::to_string(side));
      slice.emplace_back();
      if (cursor.accept("Null")) continue;
      slice.back().assign((side + 63) / 64, 0);
      for (std::size_t x = 0; x < side; ++x) {
        if (cursor.accept("1"))
          slice.back()[x / 64] |= std::uint64_t{1} << (x % 64);
        else
          cursor.expect("0");
      }
    }
    const bool is_null = slice.size() == 1 && slice.front().empty();
    if (is_null) continue;
    if (slice.size() != side)
      cursor.refuse("slice " + std::to_string(z) + " takes " + std::to_string(side) +
                    " rows, or one Null; here are " + std::to_string(slice.size()));
    index.slices[z] = std::move(slice);
  }
  cursor.expect_end();
  return index;
}

}  // namespace octotomy::voxel
