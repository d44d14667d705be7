// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/run_length.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "voxel/space/error.h"
#include "voxel/space/text_cursor.h"
#include "voxel/tree/logical_build.h"
#include "voxel/tree/slice_build.h"

namespace octotomy::voxel {
namespace {

void check(const RunLength& code) {
  check_depth(code.universe.depth);
  const std::uint64_t voxels = std::uint64_t{1} << (3 * code.universe.depth);
  for (std::size_t i = 0; i < code.runs.size(); ++i) {
    const Run& run = code.runs[i];
    const auto refuse = [&](const std::string& why) {
      throw InvalidInput("run length, run " + std::to_string(i + 1) + ", " + std::to_string(run.first) + ":" +
                         std::to_string(run.last) + ": " + why);
    };
    if (run.last < run.first) refuse("ends before it begins");
    if (run.last >= voxels) refuse("leaves the universe of " + std::to_string(voxels) + " voxels");
    if (i == 0) continue;
    if (run.first <= code.runs[i - 1].last) refuse("does not come after its predecessor");
    if (run.first == code.runs[i - 1].last + 1) refuse("continues its predecessor: merge the two runs");
  }
}

}  // namespace

RunLength run_length(const Octree& octree) {
  RunLength code{octree.universe(), {}};
  const auto side = static_cast<std::uint64_t>(octree.universe().side());
  for_each_slice(octree, [&](int z, const SliceBits& slice) {
    for (int y = 0; y < slice.side; ++y) {
      const std::uint64_t row = side * (static_cast<std::uint64_t>(y) + side * static_cast<std::uint64_t>(z));
      int first = 0;
      int last = -1;
      while (next_run(slice, y, last + 1, first, last)) {
        const Run run{row + static_cast<std::uint64_t>(first), row + static_cast<std::uint64_t>(last)};
        if (!code.runs.empty() && code.runs.back().last + 1 == run.first)
          code.runs.back().last = run.last;
        else
          code.runs.push_back(run);
      }
    }
  });
  return code;
}

Octree octree_of(const RunLength& code) {
  check(code);
  const auto side = static_cast<std::uint64_t>(code.universe.side());
  auto run = code.runs.begin();
  return octree_of_slices(code.universe, [&](int z, SliceBits& slice) {
    const std::uint64_t begin = side * side * static_cast<std::uint64_t>(z);
    const std::uint64_t end = begin + side * side;
    bool any = false;
    for (; run != code.runs.end() && run->first < end; ++run) {
      any = true;
      const std::uint64_t stop = std::min(run->last + 1, end);
      for (std::uint64_t first = std::max(run->first, begin); first < stop;) {
        const std::uint64_t row = first / side;
        const std::uint64_t last = std::min(stop, (row + 1) * side) - 1;
        set_row(slice, static_cast<int>(row % side), static_cast<int>(first % side),
                static_cast<int>(last % side));
        first = last + 1;
      }
      if (run->last >= end) break;  // the run continues in the next slice
    }
    return any;
  });
}

std::string text(const RunLength& code) {
  std::string result;
  for (const Run& run : code.runs) {
    if (!result.empty()) result += ' ';
    result += std::to_string(run.first) + ":" + std::to_string(run.last);
  }
  return result;
}

RunLength parse_run_length(const Universe& universe, std::string_view text) {
  RunLength code{universe, {}};
  TextCursor cursor("run length", text);
  constexpr std::uint64_t largest = std::numeric_limits<std::uint64_t>::max();
  for (cursor.skip_spaces(); !cursor.at_end(); cursor.skip_spaces()) {
    Run run;
    run.first = cursor.number(largest);
    cursor.expect(":");
    run.last = cursor.number(largest);
    const char next = cursor.peek();
    if (!cursor.at_end() && next != ' ' && next != '\t' && next != '\n' && next != '\r')
      cursor.refuse_unexpected("a space");
    code.runs.push_back(run);
  }
  return code;
}

}  // namespace octotomy::voxel
