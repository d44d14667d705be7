// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

namespace octotomy::voxel {

/// Forbids this process, and all processes that it starts, everything that decoding untrusted bytes never
/// needs, as far as the system supports it: new programs and processes, sockets, tracing, and other kernel
/// interfaces (seccomp); and changes of files outside of `writable` (Landlock, Linux 5.13 and later).
/// Threads, memory, open files and reading stay allowed. Refused calls fail with EPERM or EACCES. Cannot be
/// undone. Returns whether seccomp and Landlock are both in force.
bool confine(const std::filesystem::path& writable) noexcept;

}  // namespace octotomy::voxel
