// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/grey_runs.h"

#include <limits>
#include <stdexcept>

#include "voxel/codes/run_length.h"
#include "voxel/space/text_cursor.h"

namespace octotomy::voxel {

GreyRuns grey_runs(std::span<const std::int16_t> samples) {
  GreyRuns runs;
  for (const std::int16_t sample : samples) {
    if (runs.empty() || runs.back().value != sample) runs.push_back({sample, 0});
    ++runs.back().count;
  }
  return runs;
}

GreyRuns grey_runs(const Octree& octree) {
  GreyRuns runs;
  const std::uint64_t voxels = std::uint64_t{1} << (3 * octree.universe().depth);
  std::uint64_t end = 0;
  for (const Run& run : run_length(octree).runs) {
    if (run.first > end) runs.push_back({0, run.first - end});
    runs.push_back({1, run.last - run.first + 1});
    end = run.last + 1;
  }
  if (end < voxels) runs.push_back({0, voxels - end});
  return runs;
}

std::vector<std::int16_t> samples_of(const GreyRuns& runs, std::uint64_t most) {
  std::vector<std::int16_t> samples;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const auto refuse = [&](const std::string& why) {
      throw std::invalid_argument("grey runs, run " + std::to_string(i + 1) + ", (" +
                                  std::to_string(runs[i].value) + ":" + std::to_string(runs[i].count) +
                                  "): " + why);
    };
    if (runs[i].count == 0) refuse("is empty");
    if (i > 0 && runs[i].value == runs[i - 1].value) refuse("continues its predecessor: merge the two runs");
    if (runs[i].count > most - samples.size())
      throw std::length_error("grey runs: more than " + std::to_string(most) + " samples");
    samples.insert(samples.end(), runs[i].count, runs[i].value);
  }
  return samples;
}

std::string text(const GreyRuns& runs) {
  std::string result;
  for (const GreyRun& run : runs)
    result.append(result.empty() ? "(" : ", (")
        .append(std::to_string(run.value))
        .append(":")
        .append(std::to_string(run.count))
        .append(")");
  return result;
}

GreyRuns parse_grey_runs(std::string_view text) {
  GreyRuns runs;
  TextCursor cursor("grey runs", text);
  for (cursor.skip_spaces(); !cursor.at_end(); cursor.skip_spaces()) {
    if (!runs.empty()) {
      cursor.expect(",");
      cursor.skip_spaces();
    }
    cursor.expect("(");
    const bool is_negative = cursor.accept("-");
    const auto size = static_cast<std::int32_t>(cursor.number(is_negative ? 32768 : 32767));
    cursor.expect(":");
    const std::uint64_t count = cursor.number(std::numeric_limits<std::uint64_t>::max());
    cursor.expect(")");
    runs.push_back({static_cast<std::int16_t>(is_negative ? -size : size), count});
  }
  return runs;
}

}  // namespace octotomy::voxel
