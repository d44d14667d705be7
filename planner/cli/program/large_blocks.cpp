// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The program's operator new. Blocks of many megabytes begin at a huge page, and all but the small ones ask
// the system for huge pages: else it takes a fault for each 4 KiB, which costs more than filling them, and
// gives as many back when a program that holds gigabytes is stopped. This reaches every array of both kernels
// and of the libraries under them.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace {

constexpr std::size_t huge_page = std::size_t{2} << 20;
/// Smaller blocks would lose too much to the last page if they began at a huge one.
constexpr std::size_t least_aligned = 8 * huge_page;
/// What a call of the system costs is little against filling as much.
constexpr std::size_t least_advised = huge_page / 8;

#if defined(__linux__)
/// Asks for huge pages for a block that may begin and end anywhere. Other blocks on its first and last huge
/// page get them, too. Advice only: a system that ignores it gives small pages.
void advise_huge_pages(void* memory, std::size_t bytes) {
  const std::uintptr_t before = reinterpret_cast<std::uintptr_t>(memory) % huge_page;
  const std::size_t advised = (before + bytes + huge_page - 1) / huge_page * huge_page;
  static_cast<void>(::madvise(static_cast<char*>(memory) - before, advised, MADV_HUGEPAGE));
}
#endif

/// Null where there is no memory.
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
