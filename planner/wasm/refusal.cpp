// SPDX-License-Identifier: AGPL-3.0-or-later
// There are no exceptions: what would be thrown ends the instance. Its message goes to standard error, as
// WASI has it; a page then makes a new instance. Every type that the voxel kernel throws is a std::exception.
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <typeinfo>

extern "C" {

void* __cxa_allocate_exception(std::size_t bytes) noexcept {  // NOLINT(bugprone-reserved-identifier)
  return std::malloc(bytes);
}
void __cxa_free_exception(void* memory) noexcept {  // NOLINT(bugprone-reserved-identifier)
  std::free(memory);
}
[[noreturn]] void __cxa_throw(void* thrown, std::type_info*, void (*)(void*)) {  // NOLINT
  std::fprintf(stderr, "%s\n", static_cast<std::exception*>(thrown)->what());
  std::fflush(stderr);
  std::_Exit(2);
}

}  // extern "C"
