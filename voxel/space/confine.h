// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

namespace octotomy::voxel {

/// Takes from this process, and all that it starts, what decoding untrusted bytes never needs, as far as the kernel
/// can: new programs and processes, sockets, tracing, and other kernel interfaces (seccomp); and changes of files
/// outside of `writable` (Landlock, Linux 5.13 and later). Threads, memory, open files and reading stay. Refused
/// calls fail with EPERM or EACCES. Cannot be undone. Returns whether both are in force.
bool confine(const std::filesystem::path& writable) noexcept;

}  // namespace octotomy::voxel
