// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/large_memory.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <map>
#include <mutex>
#include <new>
#include <string>
#include <sys/mman.h>
#include <sys/statfs.h>
#include <thread>
#include <unistd.h>

#include "voxel/space/memory_need.h"

namespace octotomy::voxel {
namespace {

/// Smaller blocks always stay in memory: a file costs more than they do.
constexpr std::size_t least_filed = std::size_t{64} << 20;
constexpr std::uint64_t unlimited_share = std::uint64_t{2} << 30;
constexpr std::uint64_t most_resident = std::uint64_t{256} << 20;

/// TMPDIR, or the folder for large temporary files; empty if a file in it would lie in memory.
std::filesystem::path scratch_folder() {
  const char* named = std::getenv("TMPDIR");
  const std::filesystem::path folder = named != nullptr && *named != '\0' ? named : "/var/tmp";
  struct statfs kind {};
  constexpr std::array<std::int64_t, 2> in_memory{0x01021994, 0x858458f6};  // tmpfs, ramfs
  if (::statfs(folder.c_str(), &kind) != 0) return {};
  const auto type = static_cast<std::int64_t>(kind.f_type) & 0xffffffff;
  return std::find(in_memory.begin(), in_memory.end(), type) == in_memory.end() ? folder
                                                                                : std::filesystem::path();
}

/// An open file without a name, all of whose bytes are reserved on the disk; -1 if there is none.
int unnamed_file(std::size_t bytes) {
  const std::filesystem::path folder = scratch_folder();
  if (folder.empty()) return -1;
  int file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file < 0) {
    std::string name = folder / ".octotomy-XXXXXX";
    file = ::mkostemp(name.data(), O_CLOEXEC);
    if (file < 0) return -1;
    ::unlink(name.c_str());
  }
  // Without the reservation a write to a full disk would end the process.
  if (::fallocate(file, 0, 0, static_cast<off_t>(bytes)) == 0) return file;
  ::close(file);
  return -1;
}

/// Blocks that lie in files. A thread removes their pages from the process while more than `most_resident`
/// bytes of files are resident. Their contents stay in the system's page cache or on the disk.
class FiledBlocks {
 public:
  /// Null if no disk has room.
  void* add(std::size_t bytes) {
    start_watch();
    const int file = unnamed_file(bytes);
    if (file < 0) return nullptr;
    void* const memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    ::close(file);
    if (memory == MAP_FAILED) return nullptr;
    const std::lock_guard lock(mutex_);
    bytes_at_[memory] = bytes;
    added_.notify_one();
    return memory;
  }
  bool remove(void* memory) noexcept {
    const std::lock_guard lock(mutex_);
    const auto found = bytes_at_.find(memory);
    if (found == bytes_at_.end()) return false;
    ::munmap(memory, found->second);
    bytes_at_.erase(found);
    return true;
  }

 private:
  /// Precedes everything that an exception would leave behind.
  void start_watch() {
    const std::lock_guard lock(mutex_);
    if (!is_watched_) std::thread([this] { watch(); }).detach();
    is_watched_ = true;
  }

  [[noreturn]] void watch() {
    for (std::unique_lock lock(mutex_);;) {
      added_.wait(lock, [&] { return !bytes_at_.empty(); });
      if (resident_file_bytes() > most_resident)
        for (const auto& [memory, bytes] : bytes_at_) ::madvise(memory, bytes, MADV_DONTNEED);
      lock.unlock();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      lock.lock();
    }
  }

  std::mutex mutex_;
  std::condition_variable added_;
  std::map<void*, std::size_t> bytes_at_;
  bool is_watched_ = false;
};

/// Never destroyed, because its thread runs until the process ends.
FiledBlocks& filed_blocks() {
  static FiledBlocks& blocks = *new FiledBlocks;
  return blocks;
}

/// Bytes of large blocks in memory.
std::atomic<std::uint64_t> in_memory{0};

}  // namespace

std::uint64_t memory_for_large_blocks() {
  const std::uint64_t limit = memory_limit();
  const std::uint64_t share = limit == no_memory_limit ? unlimited_share : limit / 2;
  return std::min(share, in_memory + free_memory() / 2);
}

void* allocate_large(std::size_t bytes) {
  if (bytes >= least_filed && in_memory + bytes > memory_for_large_blocks())
    if (void* const filed = filed_blocks().add(bytes)) return filed;
  void* const memory = ::operator new(bytes, std::align_val_t(huge_page));
  in_memory += bytes;
  // Advice only: a system that ignores it maps small pages.
  static_cast<void>(::madvise(memory, bytes, MADV_HUGEPAGE));
  return memory;
}

void free_large(void* memory, std::size_t bytes) noexcept {
  if (bytes >= least_filed && filed_blocks().remove(memory)) return;
  ::operator delete(memory, std::align_val_t(huge_page));
  in_memory -= bytes;
}

std::uint64_t room_for_large_blocks() {
  const std::filesystem::path folder = scratch_folder();
  std::error_code failed;
  const std::filesystem::space_info disk = std::filesystem::space(folder, failed);
  return folder.empty() || failed ? 0 : disk.available;
}

}  // namespace octotomy::voxel
