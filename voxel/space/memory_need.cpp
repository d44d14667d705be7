// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/memory_need.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>
#include <sys/resource.h>

#include "voxel/space/file_text.h"
#include "voxel/space/rounded.h"

namespace octotomy::voxel {
namespace {

/// The kilobytes that a file of /proc states after `key`, in bytes.
std::uint64_t stated(const char* file, const std::string& key, std::uint64_t otherwise) {
  std::ifstream in(file);
  for (std::string word; in >> word;)
    if (std::uint64_t kilobytes = 0; word == key && in >> kilobytes) return kilobytes << 10;
  return otherwise;
}

std::string gigabytes(std::uint64_t bytes) {
  return rounded(static_cast<double>(bytes) / 1e9) + " GB";
}

}  // namespace

void limit_memory(std::uint64_t bytes) {
  rlimit limit{};
  getrlimit(RLIMIT_DATA, &limit);
  limit.rlim_cur = std::min<rlim_t>(bytes, limit.rlim_max);
  setrlimit(RLIMIT_DATA, &limit);
}

std::uint64_t free_memory() {
  constexpr std::uint64_t unknown = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t free = stated("/proc/meminfo", "MemAvailable:", unknown);
  rlimit limit{};
  if (getrlimit(RLIMIT_DATA, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
    const std::uint64_t held = stated("/proc/self/status", "VmData:", 0);
    free = std::min<std::uint64_t>(free, limit.rlim_cur - std::min<std::uint64_t>(limit.rlim_cur, held));
  }
  return free;
}

void need_memory(const std::filesystem::path& path, std::uint64_t sample_count, std::uint64_t sample_bytes) {
  const std::uint64_t free = free_memory();
  if (sample_count > 0 && sample_bytes > std::numeric_limits<std::uint64_t>::max() / sample_count)
    refuse(path, "states more samples than any memory holds");
  const std::uint64_t needed = sample_count * sample_bytes;
  if (needed <= free) return;
  refuse(path,
         "reading it takes " + gigabytes(needed) + " of memory, " + gigabytes(free) +
             " are free: crop or resample it elsewhere, or raise --memory",
         ErrorCode::Resource);
}

}  // namespace octotomy::voxel
