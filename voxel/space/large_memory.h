// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

namespace octotomy::voxel {

/// Size in bytes of a huge page, to which the blocks of allocate_large() are aligned.
inline constexpr std::size_t huge_page = std::size_t{2} << 20;

/// Bytes of large blocks that stay in memory: half of limit_memory(), or 2 GiB if there is no limit, and never
/// more than half of the free memory. Further blocks lie in unnamed files.
std::uint64_t memory_for_large_blocks();

/// Allocates a block of uninitialised memory. A block of at least 64 MiB that exceeds
/// memory_for_large_blocks() lies in an unnamed file in the folder for temporary files, if there is room on a
/// disk: the block is then addressed like memory. Where more than 256 MiB of such files are resident, a thread
/// removes their pages from the process; the system may take them at any time. Scattered reads make pages
/// resident faster than the thread removes them, so the resident size may be larger for moments. The file ends
/// with the block, or with the process. A child of fork() shares it with its parent. Precondition: `bytes` is a
/// multiple of huge_page. Throws std::bad_alloc, or std::system_error without a thread. Thread-safe.
void* allocate_large(std::size_t bytes);
/// Frees a block of allocate_large() of this size. Thread-safe.
void free_large(void* memory, std::size_t bytes) noexcept;

/// Bytes of the disk on which allocate_large() creates its files; 0 if it has none.
std::uint64_t room_for_large_blocks();

}  // namespace octotomy::voxel
