// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/code_translation.h"

#include <algorithm>
#include <stdexcept>

namespace octotomy::voxel {
namespace {

/// Moves slices along z and rows along y. `of_row` shifts a row that is not null along x.
template <typename Index, typename OfRow>
Index translated_rows(const Index& index, const glm::ivec3& by, const OfRow& of_row) {
  const int side = index.universe.side();
  Index result{index.universe, std::vector<typename Index::Slice>(static_cast<std::size_t>(side))};
  for (int z = std::max(0, by.z); z < std::min(side, side + by.z); ++z) {
    const typename Index::Slice& from = index.slices[static_cast<std::size_t>(z - by.z)];
    if (from.empty()) continue;
    typename Index::Slice slice(static_cast<std::size_t>(side));
    bool any = false;
    for (int y = std::max(0, by.y); y < std::min(side, side + by.y); ++y) {
      const typename Index::Row& row = from[static_cast<std::size_t>(y - by.y)];
      if (!row.empty()) slice[static_cast<std::size_t>(y)] = of_row(row);
      any = any || !slice[static_cast<std::size_t>(y)].empty();
    }
    if (any) result.slices[static_cast<std::size_t>(z)] = std::move(slice);
  }
  return result;
}

}  // namespace

CuberilleFaces translated(const CuberilleFaces& faces, const glm::ivec3& by) {
  CuberilleFaces result = faces;
  for (auto& list : result.lists)
    for (glm::ivec3& voxel : list) {
      voxel += by;
      if (glm::any(glm::lessThan(voxel, glm::ivec3(0))) ||
          glm::any(glm::greaterThanEqual(voxel, glm::ivec3(faces.universe.side()))))
        throw std::invalid_argument(
            "cuberille: the translation moves a face out of the universe: cut the object first");
    }
  return result;
}

MarginalIndex translated(const MarginalIndex& index, const glm::ivec3& by) {
  const int side = index.universe.side();
  return translated_rows(index, by, [&](const MarginalIndex::Row& row) {
    MarginalIndex::Row shifted(row.size(), 0);
    bool any = false;
    for (int x = std::max(0, by.x); x < std::min(side, side + by.x); ++x) {
      const auto from = static_cast<std::size_t>(x - by.x), to = static_cast<std::size_t>(x);
      const std::uint64_t voxel = (row[from / 64] >> (from % 64)) & 1;
      shifted[to / 64] |= voxel << (to % 64);
      any = any || voxel != 0;
    }
    return any ? shifted : MarginalIndex::Row();
  });
}

SegmentIndex translated(const SegmentIndex& index, const glm::ivec3& by) {
  const int side = index.universe.side();
  return translated_rows(index, by, [&](const SegmentIndex::Row& row) {
    SegmentIndex::Row shifted;
    for (const Segment& segment : row) {
      const int first = std::max(0, segment.first + by.x), last = std::min(side - 1, segment.last + by.x);
      if (first <= last)
        shifted.push_back({static_cast<std::uint16_t>(first), static_cast<std::uint16_t>(last)});
    }
    return shifted;
  });
}

RunLength translated(const RunLength& code, const glm::ivec3& by) {
  const auto side = static_cast<std::int64_t>(code.universe.side());
  RunLength result{code.universe, {}};
  for (const Run& run : code.runs)
    for (auto first = static_cast<std::int64_t>(run.first); first <= static_cast<std::int64_t>(run.last);) {
      // The part of the run that lies in one row.
      const std::int64_t row = first / side;
      const std::int64_t last = std::min(static_cast<std::int64_t>(run.last), (row + 1) * side - 1);
      const std::int64_t x = std::max<std::int64_t>(0, first % side + by.x);
      const std::int64_t end = std::min(side - 1, last % side + by.x);
      const std::int64_t y = row % side + by.y, z = row / side + by.z;
      first = last + 1;
      if (x > end || y < 0 || y >= side || z < 0 || z >= side) continue;
      const std::int64_t start = side * (y + side * z);
      const Run moved{static_cast<std::uint64_t>(start + x), static_cast<std::uint64_t>(start + end)};
      if (!result.runs.empty() && result.runs.back().last + 1 == moved.first)
        result.runs.back().last = moved.last;
      else
        result.runs.push_back(moved);
    }
  return result;
}

}  // namespace octotomy::voxel
