// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/segment_index.h"

#include <algorithm>
#include <cassert>

#include "voxel/codes/row_index.h"
#include "voxel/tree/slice_build.h"

namespace octotomy::voxel {
namespace {

constexpr const char* code = "segment index";

void check_row(const SegmentIndex::Row& row, std::size_t z, std::size_t y, int side) {
  for (std::size_t i = 0; i < row.size(); ++i) {
    const Segment& segment = row[i];
    const auto refuse = [&](const std::string& why) {
      refuse_row(
          code, z, y,
          ", segment " + std::to_string(segment.first) + ":" + std::to_string(segment.last) + ": " + why);
    };
    if (segment.last < segment.first) refuse("ends before it begins");
    if (segment.last >= side) refuse("leaves the row of " + std::to_string(side) + " voxels");
    if (i > 0 && segment.first <= row[i - 1].last) refuse("does not come after its predecessor");
    if (i > 0 && segment.first == row[i - 1].last + 1)
      refuse("continues its predecessor: merge the two segments");
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
  check_slices(code, index, [&](const auto& row, std::size_t z, std::size_t y) {
    check_row(row, z, y, index.universe.side());
  });
  return octree_of_slices(index.universe, [&](int z, SliceBits& bits) {
    const SegmentIndex::Slice& slice = index.slices[static_cast<std::size_t>(z)];
    for (std::size_t y = 0; y < slice.size(); ++y)
      for (const Segment& segment : slice[y]) set_row(bits, static_cast<int>(y), segment.first, segment.last);
    return !slice.empty();
  });
}

bool contains(const SegmentIndex& index, const glm::ivec3& voxel) {
  assert(glm::all(glm::greaterThanEqual(voxel, glm::ivec3(0))) &&
         glm::all(glm::lessThan(voxel, glm::ivec3(index.universe.side()))));
  const SegmentIndex::Slice& slice = index.slices[static_cast<std::size_t>(voxel.z)];
  if (slice.empty()) return false;
  const SegmentIndex::Row& row = slice[static_cast<std::size_t>(voxel.y)];
  const auto after = std::upper_bound(row.begin(), row.end(), voxel.x,
                                      [](int x, const Segment& segment) { return x < segment.first; });
  return after != row.begin() && voxel.x <= std::prev(after)->last;
}

std::string text(const SegmentIndex& index) {
  return text_of_slices(index, [](const SegmentIndex::Row& row) {
    std::string segments;
    for (const Segment& segment : row)
      segments +=
          (segments.empty() ? "" : ",") + std::to_string(segment.first) + ":" + std::to_string(segment.last);
    return segments;
  });
}

SegmentIndex parse_segment_index(const Universe& universe, std::string_view text) {
  const auto side = static_cast<std::size_t>(universe.side());
  return parse_slices<SegmentIndex>(code, universe, text, [&](TextCursor& cursor, SegmentIndex::Row& row) {
    do {
      Segment segment;
      segment.first = static_cast<std::uint16_t>(cursor.number(side - 1));
      cursor.expect(":");
      segment.last = static_cast<std::uint16_t>(cursor.number(side - 1));
      row.push_back(segment);
    } while (cursor.accept(","));
  });
}

}  // namespace octotomy::voxel
