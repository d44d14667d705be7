// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>
#include <utility>

#if defined(__linux__)
#include "voxel/space/large_memory.h"
#endif

namespace octotomy::voxel {

/// An allocator for arrays of many megabytes. Elements constructed without a value remain uninitialised, so
/// that the threads that fill an array are the first to touch it. Requests huge pages: a page fault per 4 KiB
/// takes longer than filling the page, and for scattered reads the address translation of small pages takes
/// longer than the read. Arrays that do not fit into memory lie in files, see allocate_large().
template <typename Value>
struct LargeAllocator {
  using value_type = Value;

  LargeAllocator() = default;
  template <typename Other>
  LargeAllocator(const LargeAllocator<Other>&) {}

  Value* allocate(std::size_t count) {
    if (count > std::size_t(-1) / 2 / sizeof(Value)) throw std::bad_alloc();
    const std::size_t bytes = count * sizeof(Value);
#if defined(__linux__)
    if (bytes >= 2 * huge_page) return static_cast<Value*>(allocate_large(whole_pages(bytes)));
#endif
    return static_cast<Value*>(::operator new(bytes, std::align_val_t(alignment)));
  }
  void deallocate(Value* memory, std::size_t count) {
#if defined(__linux__)
    const std::size_t bytes = count * sizeof(Value);
    if (bytes >= 2 * huge_page) return free_large(memory, whole_pages(bytes));
#else
    static_cast<void>(count);
#endif
    ::operator delete(memory, std::align_val_t(alignment));
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
#if defined(__linux__)
  static std::size_t whole_pages(std::size_t bytes) {
    return (bytes + huge_page - 1) / huge_page * huge_page;
  }
#endif
};

}  // namespace octotomy::voxel
