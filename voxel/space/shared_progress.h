// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstddef>
#include <thread>

#include "voxel/space/progress.h"

namespace octotomy::voxel {

/// The progress of one part of the work: its fractions 0 to 1 are reported as `from` to `to` of the whole
/// work.
inline Progress part_of(const Progress& whole, double from, double to) {
  if (!whole.report) return {whole.stop, {}};
  return {whole.stop,
          [report = whole.report, from, to](double fraction) { report(from + (to - from) * fraction); }};
}

/// The progress of work in equal pieces on several threads. Only the thread that constructed the object
/// reports.
class SharedProgress {
 public:
  SharedProgress(const Progress& progress, std::size_t pieces) : progress_(progress), pieces_(pieces) {}

  /// Counts a piece as done, on any thread. Throws Stopped if the stop token is set.
  void one_more() {
    const double done = static_cast<double>(++done_) / static_cast<double>(pieces_);
    if (std::this_thread::get_id() == owner_)
      progress_.at(done);
    else
      Progress{progress_.stop, {}}.at(done);
  }

 private:
  const Progress& progress_;
  std::size_t pieces_;
  std::atomic<std::size_t> done_ = 0;
  std::thread::id owner_ = std::this_thread::get_id();
};

}  // namespace octotomy::voxel
