// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/memory_need.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <fcntl.h>
#include <fstream>
#include <limits>
#include <string>
#include <sys/resource.h>
#include <unistd.h>

#include "voxel/space/file_text.h"
#include "voxel/space/rounded.h"

namespace octotomy::voxel {
namespace {

constexpr std::uint64_t no_limit = std::numeric_limits<std::uint64_t>::max();

std::atomic<std::uint64_t> limit_bytes{no_limit};

void set_data_limit(std::uint64_t bytes) noexcept {
  rlimit limit{};
  getrlimit(RLIMIT_DATA, &limit);
  limit.rlim_cur = std::min<rlim_t>(bytes, limit.rlim_max);
  setrlimit(RLIMIT_DATA, &limit);
}

/// The resident bytes of this process that no file backs; 0 if /proc is missing.
std::uint64_t held_bytes() noexcept {
  const int file = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  std::array<char, 128> text{};
  const ssize_t length = ::read(file, text.data(), text.size() - 1);
  ::close(file);
  unsigned long long all = 0, resident = 0, shared = 0;
  if (length <= 0 || std::sscanf(text.data(), "%llu %llu %llu", &all, &resident, &shared) != 3) return 0;
  return (resident - shared) * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

std::uint64_t available_bytes() {
  std::ifstream in("/proc/meminfo");
  for (std::string word; in >> word;)
    if (std::uint64_t kilobytes = 0; word == "MemAvailable:" && in >> kilobytes) return kilobytes << 10;
  return no_limit;
}

std::string gigabytes(std::uint64_t bytes) {
  return rounded(static_cast<double>(bytes) / 1e9) + " GB";
}

}  // namespace

void limit_memory(std::uint64_t bytes) {
  limit_bytes = bytes;
  // Additional address space for threads' stacks and for memory that is reserved but never touched.
  const std::uint64_t slack = (std::uint64_t{256} << 20) + bytes / 4;
  set_data_limit(bytes < no_limit - slack ? bytes + slack : no_limit);
}

void lift_memory_limit() noexcept {
  set_data_limit(no_limit);
}

bool is_memory_over() noexcept {
  return limit_bytes != no_limit && held_bytes() > limit_bytes;
}

std::uint64_t free_memory() {
  const std::uint64_t limit = limit_bytes;
  const std::uint64_t held = limit == no_limit ? 0 : held_bytes();
  return std::min(available_bytes(), limit - std::min(limit, held));
}

void need_memory(const std::filesystem::path& path, std::uint64_t sample_count, std::uint64_t sample_bytes,
                 const std::string& what) {
  const std::uint64_t free = free_memory();
  if (sample_count > 0 && sample_bytes > std::numeric_limits<std::uint64_t>::max() / sample_count)
    refuse(path, "states more samples than any memory holds");
  const std::uint64_t needed = sample_count * sample_bytes;
  if (needed <= free) return;
  refuse(path,
         what + " take " + gigabytes(needed) + " of memory, " + gigabytes(free) +
             " are free: crop it, choose wider spacings or larger voxels, or raise --memory",
         ErrorCode::Resource);
}

}  // namespace octotomy::voxel
