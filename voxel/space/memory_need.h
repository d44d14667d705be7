// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>

namespace octotomy::voxel {

/// Limits this process to `bytes` of memory that no file backs. free_memory() and need_memory() respect the
/// limit. Small allocations above the limit do not fail, because libraries crash when allocations fail;
/// instead, a thread should check is_memory_over() regularly and end the process. An allocation far beyond
/// the limit throws std::bad_alloc.
void limit_memory(std::uint64_t bytes);
/// The limit of limit_memory(), or no_memory_limit.
std::uint64_t memory_limit() noexcept;
inline constexpr std::uint64_t no_memory_limit = std::numeric_limits<std::uint64_t>::max();
/// Removes the limit on single allocations, so that a process that is being ended can still print the reason.
void lift_memory_limit() noexcept;
/// Whether this process uses more memory than limit_memory() allows. Takes microseconds and allocates
/// nothing.
bool is_memory_over() noexcept;
/// Resident bytes of this process that files back. Cost: microseconds, no allocation.
std::uint64_t resident_file_bytes() noexcept;

/// Bytes that this process may still allocate: the system's free memory, or the rest of limit_memory() if
/// that is less.
std::uint64_t free_memory();

/// Throws Error (Resource) if reading `path` needs more than free_memory(), with both figures. The file has
/// `sample_count` samples, each of which takes `sample_bytes` bytes while the file is read. `what` names the
/// data in the message if they are not the file's samples.
void need_memory(const std::filesystem::path& path, std::uint64_t sample_count, std::uint64_t sample_bytes,
                 const std::string& what = "its samples");
/// As need_memory(), for samples in arrays of LargeAllocator, which may lie in files if the disk has room.
void need_room(const std::filesystem::path& path, std::uint64_t sample_count, std::uint64_t sample_bytes);

}  // namespace octotomy::voxel
