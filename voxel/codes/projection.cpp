// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/projection.h"

#include <algorithm>
#include <utility>

namespace octotomy::voxel {
namespace {

/// The columns of voxels parallel to one direction.
class Columns {
 public:
  Columns(const Universe& universe, Direction from)
      : side_(universe.side()),
        axis_(static_cast<int>(from) / 2),
        from_high_(static_cast<int>(from) % 2 == 0) {
    result_.side = side_;
    result_.before.assign(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), -1);
  }

  int side() const { return side_; }
  int axis() const { return axis_; }
  bool from_high() const { return from_high_; }
  std::int32_t depth(const glm::ivec3& voxel) const {
    return from_high_ ? side_ - 1 - voxel[axis_] : voxel[axis_];
  }
  std::int32_t& before(const glm::ivec3& voxel) {
    const int i = voxel[axis_ == 0 ? 1 : 0], j = voxel[axis_ == 2 ? 1 : 2];
    return result_
        .before[static_cast<std::size_t>(i) + static_cast<std::size_t>(side_) * static_cast<std::size_t>(j)];
  }
  void paint(const glm::ivec3& voxel) { before(voxel) = depth(voxel); }
  void read(std::uint64_t count = 1) { result_.visited += count; }
  Projection result() && { return std::move(result_); }

 private:
  int side_, axis_;
  bool from_high_;
  Projection result_;
};

/// The unpainted parts of a picture's row: ascending intervals, both ends included.
class DynamicRow {
 public:
  explicit DynamicRow(int side) : open_{{0, side - 1}} {}

  bool is_painted() const { return open_.empty(); }
  /// Calls `paint(x)` for each unpainted x in first..last and marks it as painted.
  template <typename Paint>
  void take(int first, int last, const Paint& paint) {
    std::vector<std::pair<int, int>> left;
    for (const auto& [low, high] : open_) {
      for (int x = std::max(low, first); x <= std::min(high, last); ++x) paint(x);
      if (low < first) left.emplace_back(low, std::min(high, first - 1));
      if (high > last) left.emplace_back(std::max(low, last + 1), high);
    }
    open_ = std::move(left);
  }

 private:
  std::vector<std::pair<int, int>> open_;
};

}  // namespace

Projection projection(const CuberilleFaces& faces, Direction from) {
  Columns columns(faces.universe, from);
  for (const glm::ivec3& voxel : faces.lists[static_cast<std::size_t>(from)]) {
    columns.read();
    std::int32_t& before = columns.before(voxel);
    const std::int32_t depth = columns.depth(voxel);
    if (before < 0 || depth < before) before = depth;
  }
  return std::move(columns).result();
}

Projection projection(const BinaryArray& array, Direction from) {
  Columns columns(array.universe, from);
  const int side = columns.side();
  // Sorts back to front, by descending depth along the view's axis. The order along the other axes does not
  // matter.
  const auto at = [&](int axis, int i) {
    return axis == columns.axis() && !columns.from_high() ? side - 1 - i : i;
  };
  for (int k = 0; k < side; ++k)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const glm::ivec3 voxel(at(0, i), at(1, j), at(2, k));
        const std::size_t bit = static_cast<std::size_t>(voxel.x) +
                                static_cast<std::size_t>(side) *
                                    (static_cast<std::size_t>(voxel.y) +
                                     static_cast<std::size_t>(side) * static_cast<std::size_t>(voxel.z));
        columns.read();
        if (((array.bytes[bit / 8] >> (bit % 8)) & 1) != 0) columns.paint(voxel);
      }
  return std::move(columns).result();
}

Projection projection(const RunLength& code, Direction from) {
  Columns columns(code.universe, from);
  const auto side = static_cast<std::uint64_t>(columns.side());
  const auto paint = [&](std::uint64_t i) {
    columns.paint(
        {static_cast<int>(i % side), static_cast<int>(i / side % side), static_cast<int>(i / side / side)});
  };
  // A voxel's index grows with each of its coordinates, so the list or its reverse is sorted back to front.
  const auto draw = [&](const Run& run) {
    columns.read();
    for (std::uint64_t i = 0; i <= run.last - run.first; ++i)
      paint(columns.from_high() ? run.first + i : run.last - i);
  };
  if (columns.from_high())
    std::for_each(code.runs.begin(), code.runs.end(), draw);
  else
    std::for_each(code.runs.rbegin(), code.runs.rend(), draw);
  return std::move(columns).result();
}

Projection projection(const SegmentIndex& index, Direction from) {
  Columns columns(index.universe, from);
  const int side = columns.side();
  const auto row_of = [&](int y, int z) -> const SegmentIndex::Row* {
    const SegmentIndex::Slice& slice = index.slices[static_cast<std::size_t>(z)];
    return slice.empty() || slice[static_cast<std::size_t>(y)].empty() ? nullptr
                                                                       : &slice[static_cast<std::size_t>(y)];
  };
  for (int across = 0; across < side; ++across) {
    if (columns.axis() == 0) {
      // If the view is along the segments, only the nearest segment of each row is visible.
      for (int y = 0; y < side; ++y) {
        const SegmentIndex::Row* row = row_of(y, across);
        if (row == nullptr) continue;
        columns.read();
        columns.paint({columns.from_high() ? row->back().last : row->front().first, y, across});
      }
      continue;
    }
    DynamicRow screen(side);
    for (int d = 0; d < side && !screen.is_painted(); ++d) {
      const int along = columns.from_high() ? side - 1 - d : d;
      const int y = columns.axis() == 1 ? along : across, z = columns.axis() == 1 ? across : along;
      const SegmentIndex::Row* row = row_of(y, z);
      if (row == nullptr) continue;
      for (const Segment& segment : *row) {
        columns.read();
        screen.take(segment.first, segment.last, [&](int x) { columns.paint({x, y, z}); });
      }
    }
  }
  return std::move(columns).result();
}

}  // namespace octotomy::voxel
