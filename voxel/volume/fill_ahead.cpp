// SPDX-License-Identifier: AGPL-3.0-or-later
#define TBB_PREVIEW_ISOLATED_TASK_GROUP 1
#include "voxel/volume/fill_ahead.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <tbb/task_group.h>
#include <vector>

namespace octotomy::voxel {
namespace {

/// The smallest page size, by which memory is touched. In larger pages, touches after the first take almost
/// no time.
constexpr std::size_t page_bytes = 4096;
/// Twice the size of the largest page that the system uses without an explicit request.
constexpr std::size_t part_bytes = std::size_t{4} << 20;
constexpr std::size_t most_parts_ahead = 16;

/// The parts of the memory. Tasks touch the pages of parts in advance, unless the filling thread reaches a
/// part first.
class PartsAhead {
 public:
  PartsAhead(char* memory, std::size_t bytes)
      : memory_(memory), bytes_(bytes), places_((bytes + part_bytes - 1) / part_bytes) {}
  PartsAhead(const PartsAhead&) = delete;
  PartsAhead& operator=(const PartsAhead&) = delete;
  ~PartsAhead() {
    // Claims all parts, so that tasks that have not begun do nothing.
    for (std::size_t part = 0; part < asked_; ++part) own(part);
    tasks_.wait();
  }

  std::size_t count() const { return places_.size(); }
  char* begin(std::size_t part) const { return memory_ + part * part_bytes; }
  std::size_t size(std::size_t part) const { return std::min(part_bytes, bytes_ - part * part_bytes); }

  /// Claims a part for this thread and starts tasks that touch the parts after it.
  void take(std::size_t part) {
    for (; asked_ < std::min(part + most_parts_ahead, count()); ++asked_)
      tasks_.run([this, next = asked_] { touch(next); });
    own(part);
  }

 private:
  enum class PartState : std::uint32_t { New, Touching, Taken };

  void own(std::size_t part) {
    PartState expected = PartState::New;
    if (places_[part].compare_exchange_strong(expected, PartState::Taken)) return;
    places_[part].wait(PartState::Touching);
  }

  void touch(std::size_t part) {
    PartState expected = PartState::New;
    if (!places_[part].compare_exchange_strong(expected, PartState::Touching)) return;
    for (std::size_t at = 0; at < size(part); at += page_bytes) begin(part)[at] = 0;
    places_[part].store(PartState::Taken);
    places_[part].notify_all();
  }

  char* memory_;
  std::size_t bytes_;
  std::size_t asked_ = 0;
  std::vector<std::atomic<PartState>> places_;
  /// Isolated, so that a thread that waits for these tasks runs no other tasks.
  tbb::isolated_task_group tasks_;
};

}  // namespace

std::size_t fill_ahead(char* memory, std::size_t bytes,
                       const std::function<std::size_t(char* part, std::size_t bytes)>& fill) {
  PartsAhead parts(memory, bytes);
  std::size_t filled = 0;
  for (std::size_t part = 0; part < parts.count(); ++part) {
    parts.take(part);
    const std::size_t count = fill(parts.begin(part), parts.size(part));
    filled += count;
    if (count < parts.size(part)) break;
  }
  return filled;
}

}  // namespace octotomy::voxel
