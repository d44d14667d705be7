// SPDX-License-Identifier: AGPL-3.0-or-later
// The functions of the language's runtime that the kernel needs, for a platform without exceptions and
// threads. Throwing an exception ends the instance; the exception's message goes to WASI's standard error. A
// page then makes a new instance. Every type that the voxel kernel throws is a std::exception.
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

/// Destructors of thread-local objects are not called, because the only thread does not end.
int __cxa_thread_atexit(void (*)(void*), void*, void*) noexcept {  // NOLINT(bugprone-reserved-identifier)
  return 0;
}

}  // extern "C"
