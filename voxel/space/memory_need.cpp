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
#include "voxel/space/large_memory.h"
#include "voxel/space/rounded.h"

namespace octotomy::voxel {
namespace {

std::atomic<std::uint64_t> limit_bytes{no_memory_limit};

void set_data_limit(std::uint64_t bytes) noexcept {
  rlimit limit{};
  getrlimit(RLIMIT_DATA, &limit);
  limit.rlim_cur = std::min<rlim_t>(bytes, limit.rlim_max);
  setrlimit(RLIMIT_DATA, &limit);
}

/// Resident bytes; zeros if /proc is missing.
struct Resident {
  std::uint64_t all = 0, of_files = 0;
};
Resident resident() noexcept {
  const int file = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  if (file < 0) return {};
  std::array<char, 128> text{};
  const ssize_t length = ::read(file, text.data(), text.size() - 1);
  ::close(file);
  unsigned long long mapped = 0, all = 0, of_files = 0;
  if (length <= 0 || std::sscanf(text.data(), "%llu %llu %llu", &mapped, &all, &of_files) != 3) return {};
  const auto page_bytes = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  return {all * page_bytes, of_files * page_bytes};
}

/// Resident bytes that no file backs.
std::uint64_t held_bytes() noexcept {
  const Resident now = resident();
  return now.all - now.of_files;
}

std::uint64_t available_bytes() {
  std::ifstream in("/proc/meminfo");
  for (std::string word; in >> word;)
    if (std::uint64_t kilobytes = 0; word == "MemAvailable:" && in >> kilobytes) return kilobytes << 10;
  return no_memory_limit;
}

std::string gigabytes(std::uint64_t bytes) {
  return rounded(static_cast<double>(bytes) / 1e9) + " GB";
}

std::uint64_t bytes_of(const std::filesystem::path& path, std::uint64_t sample_count,
                       std::uint64_t sample_bytes) {
  if (sample_count > 0 && sample_bytes > std::numeric_limits<std::uint64_t>::max() / sample_count)
    refuse(path, "states more samples than any memory holds");
  return sample_count * sample_bytes;
}

}  // namespace

void limit_memory(std::uint64_t bytes) {
  limit_bytes = bytes;
  // Additional address space for threads' stacks and for memory that is reserved but never touched.
  const std::uint64_t slack = (std::uint64_t{256} << 20) + bytes / 4;
  set_data_limit(bytes < no_memory_limit - slack ? bytes + slack : no_memory_limit);
}

std::uint64_t memory_limit() noexcept {
  return limit_bytes;
}

void lift_memory_limit() noexcept {
  set_data_limit(no_memory_limit);
}

bool is_memory_over() noexcept {
  return limit_bytes != no_memory_limit && held_bytes() > limit_bytes;
}

std::uint64_t resident_file_bytes() noexcept {
  return resident().of_files;
}

std::uint64_t free_memory() {
  const std::uint64_t limit = limit_bytes;
  const std::uint64_t held = limit == no_memory_limit ? 0 : held_bytes();
  return std::min(available_bytes(), limit - std::min(limit, held));
}

void need_memory(const std::filesystem::path& path, std::uint64_t sample_count, std::uint64_t sample_bytes,
                 const std::string& what) {
  const std::uint64_t needed = bytes_of(path, sample_count, sample_bytes), free = free_memory();
  if (needed <= free) return;
  refuse(path,
         what + " take " + gigabytes(needed) + " of memory, " + gigabytes(free) +
             " are free: crop it, choose wider spacings or larger voxels, or raise --memory",
         ErrorCode::Resource);
}

void need_room(const std::filesystem::path& path, std::uint64_t sample_count, std::uint64_t sample_bytes) {
  const std::uint64_t needed = bytes_of(path, sample_count, sample_bytes), free = free_memory();
  if (needed <= free) return;
  const std::uint64_t room = room_for_large_blocks();
  if (needed <= room) return;
  refuse(path,
         "its samples take " + gigabytes(needed) + ", " + gigabytes(free) + " of memory and " +
             gigabytes(room) +
             " of disk for temporary files are free: crop it or take wider spacings, or raise --memory, or "
             "name a folder with more room in TMPDIR",
         ErrorCode::Resource);
}

}  // namespace octotomy::voxel
