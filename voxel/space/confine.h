// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

namespace octotomy::voxel {

/// Forbids this process and its children what decoding untrusted bytes does not need, as far as the system
/// supports it: new programs and processes, sockets, tracing, and other kernel interfaces (seccomp); and
/// changes of files outside of `writable` (Landlock, Linux 5.13 and later). Threads, memory, open files and
/// reading remain allowed. Refused calls fail with EPERM or EACCES. This cannot be undone. Returns whether
/// seccomp and Landlock are both in force.
bool confine(const std::filesystem::path& writable) noexcept;

}  // namespace octotomy::voxel
