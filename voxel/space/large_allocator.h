// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>
#include <utility>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace octotomy::voxel {

/// An allocator for arrays of many megabytes. Elements constructed without a value remain uninitialised, so
/// that the threads that fill an array are the first to touch it. Requests huge pages: a page fault per 4 KiB
/// takes longer than filling the page, and for scattered reads the address translation of small pages takes
/// longer than the read.
template <typename Value>
struct LargeAllocator {
  using value_type = Value;

  LargeAllocator() = default;
  template <typename Other>
  LargeAllocator(const LargeAllocator<Other>&) {}

  Value* allocate(std::size_t count) {
    constexpr std::size_t page = std::size_t{2} << 20;
    if (count > std::size_t(-1) / 2 / sizeof(Value)) throw std::bad_alloc();
    const std::size_t bytes = count * sizeof(Value);
    if (bytes < 2 * page) return static_cast<Value*>(::operator new(bytes, std::align_val_t(alignment)));
    const std::size_t whole = (bytes + page - 1) / page * page;
    void* const memory = ::operator new(whole, std::align_val_t(page));
#if defined(__linux__)
    // This is only advice; a system that ignores it maps small pages.
    static_cast<void>(::madvise(memory, whole, MADV_HUGEPAGE));
#endif
    return static_cast<Value*>(memory);
  }
  void deallocate(Value* memory, std::size_t count) {
    constexpr std::size_t page = std::size_t{2} << 20;
    ::operator delete(memory, std::align_val_t(count * sizeof(Value) < 2 * page ? alignment : page));
  }
  template <typename Other>
  void construct(Other* at) {
    ::new (static_cast<void*>(at)) Other;  // without parentheses, so that the element remains uninitialised
  }
  template <typename Other, typename... Arguments>
  void construct(Other* at, Arguments&&... arguments) {
    ::new (static_cast<void*>(at)) Other(std::forward<Arguments>(arguments)...);
  }
  template <typename Other>
  bool operator==(const LargeAllocator<Other>&) const {
    return true;
  }

 private:
  static constexpr std::size_t alignment = 64;
};

}  // namespace octotomy::voxel
