// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "voxel/space/error.h"
#include "voxel/space/text_cursor.h"
#include "voxel/tree/logical_build.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

// The common part of codes that store an object as slices of rows (marginal_index.h, segment_index.h). An
// `Index` has a universe, and a slice for each voxel of its side. A slice has one row for each voxel of the
// side, or no rows if it has no voxels. A row without voxels is an empty list, the thesis's null pointer.

/// Throws std::invalid_argument with the code's name, the slice and the reason.
[[noreturn]] inline void refuse_slice(const char* code, std::size_t slice, const std::string& why) {
  throw InvalidInput(std::string(code) + ", slice " + std::to_string(slice) + why);
}
[[noreturn]] inline void refuse_row(const char* code, std::size_t slice, std::size_t row,
                                    const std::string& why) {
  refuse_slice(code, slice, ", row " + std::to_string(row) + why);
}

/// Throws std::invalid_argument if the number of slices, or of a slice's rows, is not the universe's side, or
/// if all rows of a slice are empty. `check_row(row, z, y)` checks the rows themselves.
template <typename Index, typename CheckRow>
void check_slices(const char* code, const Index& index, const CheckRow& check_row) {
  check_depth(index.universe.depth);
  const auto side = static_cast<std::size_t>(index.universe.side());
  if (index.slices.size() != side)
    throw InvalidInput(std::string(code) + ": has " + std::to_string(index.slices.size()) +
                       " slices instead of the universe's " + std::to_string(side));
  for (std::size_t z = 0; z < side; ++z) {
    const auto& slice = index.slices[z];
    if (slice.empty()) continue;
    if (slice.size() != side)
      refuse_slice(code, z,
                   ": has " + std::to_string(slice.size()) + " rows instead of " + std::to_string(side));
    for (std::size_t y = 0; y < side; ++y) check_row(slice[y], z, y);
    if (std::all_of(slice.begin(), slice.end(), [](const auto& row) { return row.empty(); }))
      refuse_slice(code, z, ": holds no voxel, so it must be Null");
  }
}

/// One line per slice: its number, then text_of(row) for each row, with Null for an empty row or slice.
template <typename Index, typename TextOf>
std::string text_of_slices(const Index& index, const TextOf& text_of) {
  std::string result;
  for (std::size_t z = 0; z < index.slices.size(); ++z) {
    result += std::to_string(z);
    if (index.slices[z].empty()) result += " Null";
    for (const auto& row : index.slices[z]) result.append(" ").append(row.empty() ? "Null" : text_of(row));
    result += '\n';
  }
  return result;
}

/// The inverse of text_of_slices(). `read_row(cursor, row)` reads a row that is not Null. Throws
/// std::invalid_argument with the position of the wrong character.
template <typename Index, typename ReadRow>
Index parse_slices(const char* code, const Universe& universe, std::string_view text,
                   const ReadRow& read_row) {
  check_depth(universe.depth);
  const auto side = static_cast<std::size_t>(universe.side());
  Index index{universe, std::vector<typename Index::Slice>(side)};
  TextCursor cursor(code, text);
  for (std::size_t z = 0; z < side; ++z) {
    cursor.skip_spaces();
    cursor.expect(std::to_string(z) + " ");
    typename Index::Slice slice;
    for (cursor.skip_blanks(); !cursor.at_end() && cursor.peek() != '\n' && cursor.peek() != '\r';
         cursor.skip_blanks()) {
      if (slice.size() == side) cursor.refuse("more rows than the universe's " + std::to_string(side));
      slice.emplace_back();
      if (!cursor.accept("Null")) read_row(cursor, slice.back());
    }
    const bool is_null = slice.size() == 1 && slice.front().empty();
    if (is_null) continue;
    if (slice.size() != side)
      cursor.refuse("slice " + std::to_string(z) + " has " + std::to_string(slice.size()) +
                    " rows instead of " + std::to_string(side) + " or one Null");
    index.slices[z] = std::move(slice);
  }
  cursor.expect_end();
  return index;
}

}  // namespace octotomy::voxel
