// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/segment_index.h"

#include <algorithm>
#include <stdexcept>

#include "voxel/logical_build.h"
#include "voxel/slice_build.h"
#include "voxel/text_cursor.h"

namespace octotomy::voxel {
namespace {

[[noreturn]] void refuse(std::size_t slice, const std::string& where, const std::string& why) {
  throw std::invalid_argument("segment index, slice " + std::to_string(slice) + where + ": " + why);
}

void check_row(const SegmentIndex::Row& row, std::size_t z, std::size_t y, int side) {
  for (std::size_t i = 0; i < row.size(); ++i) {
    const Segment& segment = row[i];
    const std::string where = ", row " + std::to_string(y) + ", segment " + std::to_string(segment.first) +
                              ":" + std::to_string(segment.last);
    if (segment.last < segment.first) refuse(z, where, "ends before it begins");
    if (segment.last >= side) refuse(z, where, "leaves the row of " + std::to_string(side) + " voxels");
    if (i > 0 && segment.first <= row[i - 1].last) refuse(z, where, "does not come after its predecessor");
    if (i > 0 && segment.first == row[i - 1].last + 1)
      refuse(z, where, "goes on where its predecessor ends: they are one segment");
  }
}

void check(const SegmentIndex& index) {
  check_depth(index.universe.depth);
  const int side = index.universe.side();
  const auto count = static_cast<std::size_t>(side);
  if (index.slices.size() != count)
    throw std::invalid_argument("segment index: the universe has " + std::to_string(side) +
                                " slices, here are " + std::to_string(index.slices.size()));
  for (std::size_t z = 0; z < count; ++z) {
    const SegmentIndex::Slice& slice = index.slices[z];
    if (slice.empty()) continue;
    if (slice.size() != count)
      refuse(z, "", "has " + std::to_string(slice.size()) + " rows instead of " + std::to_string(side));
    for (std::size_t y = 0; y < count; ++y) check_row(slice[y], z, y, side);
    if (std::all_of(slice.begin(), slice.end(), [](const auto& row) { return row.empty(); }))
      refuse(z, "", "holds nothing: it must be Null");
  }
}

}  // namespace

SegmentIndex segment_index(const Octree& octree) {
  const auto side = static_cast<std::size_t>(octree.universe().side());
  SegmentIndex index{octree.universe(), std::vector<SegmentIndex::Slice>(side)};
  for_each_slice(octree, [&](int z, const SliceBits& bits) {
    SegmentIndex::Slice& slice = index.slices[static_cast<std::size_t>(z)];
    slice.resize(side);
    for (int y = 0; y < bits.side; ++y) {
      int first = 0;
      int last = -1;
      while (next_run(bits, y, last + 1, first, last))
        slice[static_cast<std::size_t>(y)].push_back(
            {static_cast<std::uint16_t>(first), static_cast<std::uint16_t>(last)});
    }
  });
  return index;
}

Octree octree_of(const SegmentIndex& index) {
  check(index);
  return octree_of_slices(index.universe, [&](int z, SliceBits& bits) {
    const SegmentIndex::Slice& slice = index.slices[static_cast<std::size_t>(z)];
    for (std::size_t y = 0; y < slice.size(); ++y)
      for (const Segment& segment : slice[y]) set_row(bits, static_cast<int>(y), segment.first, segment.last);
    return !slice.empty();
  });
}

bool contains(const SegmentIndex& index, const glm::ivec3& voxel) {
  const SegmentIndex::Slice& slice = index.slices[static_cast<std::size_t>(voxel.z)];
  if (slice.empty()) return false;
  const SegmentIndex::Row& row = slice[static_cast<std::size_t>(voxel.y)];
  const auto after = std::upper_bound(row.begin(), row.end(), voxel.x,
                                      [](int x, const Segment& segment) { return x < segment.first; });
  return after != row.begin() && voxel.x <= std::prev(after)->last;
}

std::string text(const SegmentIndex& index) {
  std::string result;
  for (std::size_t z = 0; z < index.slices.size(); ++z) {
    result += std::to_string(z);
    if (index.slices[z].empty()) result += " Null";
    for (const SegmentIndex::Row& row : index.slices[z]) {
      if (row.empty()) result += " Null";
      for (std::size_t i = 0; i < row.size(); ++i)
        result += (i == 0 ? ' ' : ',') + std::to_string(row[i].first) + ":" + std::to_string(row[i].last);
    }
    result += '\n';
  }
  return result;
}

SegmentIndex parse_segment_index(const Universe& universe, std::string_view text) {
  check_depth(universe.depth);
  const auto side = static_cast<std::size_t>(universe.side());
  SegmentIndex index{universe, std::vector<SegmentIndex::Slice>(side)};
  TextCursor cursor("segment index", text);
  for (std::size_t z = 0; z < side; ++z) {
    cursor.skip_spaces();
    cursor.expect(std::to_string(z) + " ");
    SegmentIndex::Slice slice;
    for (cursor.skip_blanks(); !cursor.at_end() && cursor.peek() != '\n' && cursor.peek() != '\r';
         cursor.skip_blanks()) {
      if (slice.size() == side) cursor.refuse("more rows than the universe's " + std::to_string(side));
      slice.emplace_back();
      if (cursor.accept("Null")) continue;
      do {
        Segment segment;
        segment.first = static_cast<std::uint16_t>(cursor.number(side - 1));
        cursor.expect(":");
        segment.last = static_cast<std::uint16_t>(cursor.number(side - 1));
        slice.back().push_back(segment);
      } while (cursor.accept(","));
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
