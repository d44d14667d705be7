// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The program's operator new. Blocks of many megabytes begin at a huge page, and all but small blocks request
// huge pages from the system. Otherwise each 4 KiB causes a page fault, which costs more than filling them,
// and as many pages must be released when the program ends. This affects every array of both kernels and of
// the libraries they use.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

#include "voxel/space/large_memory.h"

namespace {

using octotomy::voxel::huge_page;

/// Below this size, rounding up to a huge page wastes too much memory.
constexpr std::size_t least_aligned = 8 * huge_page;
/// From this size on, a system call costs little compared with filling the block.
constexpr std::size_t least_advised = huge_page / 8;

#if defined(__linux__)
/// Requests huge pages for a block of memory. The request also applies to other blocks on the same first and
/// last huge page. A system may ignore it.
void advise_huge_pages(void* memory, std::size_t bytes) {
  const std::uintptr_t before = reinterpret_cast<std::uintptr_t>(memory) % huge_page;
  const std::size_t advised = (before + bytes + huge_page - 1) / huge_page * huge_page;
  static_cast<void>(::madvise(static_cast<char*>(memory) - before, advised, MADV_HUGEPAGE));
}
#endif

/// Allocates a block of at least `bytes`; null if there is no memory.
void* block_of(std::size_t bytes) {
#if defined(__linux__)
  if (bytes >= least_advised && bytes < std::size_t(-1) / 2) {
    const std::size_t whole = (bytes + huge_page - 1) / huge_page * huge_page;
    void* const memory = bytes >= least_aligned ? std::aligned_alloc(huge_page, whole) : std::malloc(bytes);
    if (memory != nullptr) advise_huge_pages(memory, bytes);
    return memory;
  }
#endif
  return std::malloc(bytes == 0 ? 1 : bytes);
}

}  // namespace

void* operator new(std::size_t bytes) {
  for (;;) {
    if (void* const memory = block_of(bytes)) return memory;
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}

void operator delete(void* memory) noexcept {
  std::free(memory);
}

void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
