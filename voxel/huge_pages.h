// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <limits>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace octotomy::voxel {

/// Allocates what is large on pages of 2 MB where the system has them: samples are met all over a scan, and
/// with pages of 4 KB finding the page costs more than the sample.
template <typename Value>
struct HugePageAllocator {
  using value_type = Value;
  static constexpr std::size_t page = std::size_t{2} << 20;

  HugePageAllocator() = default;
  template <typename Other>
  HugePageAllocator(const HugePageAllocator<Other>&) {}

  Value* allocate(std::size_t count) {
    if (count > std::numeric_limits<std::size_t>::max() / sizeof(Value)) throw std::bad_array_new_length();
    const std::size_t bytes = count * sizeof(Value);
    void* memory = ::operator new(bytes, alignment(bytes));
#if defined(__linux__)
    // Advice only: where it is not taken, the pages are small ones.
    if (bytes >= page) static_cast<void>(madvise(memory, bytes / page * page, MADV_HUGEPAGE));
#endif
    return static_cast<Value*>(memory);
  }
  void deallocate(Value* memory, std::size_t count) noexcept {
    ::operator delete(memory, alignment(count * sizeof(Value)));
  }
  bool operator==(const HugePageAllocator&) const = default;

 private:
  static std::align_val_t alignment(std::size_t bytes) {
    return std::align_val_t{bytes >= page ? page : alignof(std::max_align_t)};
  }
};

}  // namespace octotomy::voxel
