// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The program's operator new. Blocks of many megabytes begin at a huge page and ask the system for huge
// pages: else it takes a fault for each 4 KiB, which costs more than filling them, and gives as many back
// when a program that holds gigabytes is stopped. This reaches every array of both kernels and of the
// libraries under them. Smaller blocks would lose too much to the last page.
#include <cstddef>
#include <cstdlib>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace {

constexpr std::size_t huge_page = std::size_t{2} << 20, least_bytes = 8 * huge_page;

/// Null where there is no memory.
void* block_of(std::size_t bytes) {
#if defined(__linux__)
  if (bytes >= least_bytes && bytes < std::size_t(-1) / 2) {
    const std::size_t whole = (bytes + huge_page - 1) / huge_page * huge_page;
    void* const memory = std::aligned_alloc(huge_page, whole);
    // Advice only: a system that ignores it gives small pages.
    if (memory != nullptr) static_cast<void>(::madvise(memory, whole, MADV_HUGEPAGE));
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
