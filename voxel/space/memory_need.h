// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace octotomy::voxel {

/// Lets this process take at most so many bytes of memory that no file backs. free_memory() and
/// need_memory() keep to it; what passes it bit by bit is_memory_over() tells, for a thread that looks often
/// and ends the process: libraries crash where a small allocation fails, so none is made to. An allocation
/// far beyond the limit is std::bad_alloc.
void limit_memory(std::uint64_t bytes);
/// Takes the bound on single allocations back, so that a process that ends can say why.
void lift_memory_limit() noexcept;
/// Whether this process has taken more than limit_memory() lets it. Cost: microseconds, no allocation.
bool is_memory_over() noexcept;

/// Bytes that this process may still take: what the system has free, or what limit_memory() left if that is
/// less.
std::uint64_t free_memory();

/// Throws Error (Resource) with both figures where `path`, of `sample_count` samples that take
/// `sample_bytes` each while they are read, does not fit into free_memory(). `what` names other things that
/// are made of it.
void need_memory(const std::filesystem::path& path, std::uint64_t sample_count, std::uint64_t sample_bytes,
                 const std::string& what = "its samples");

}  // namespace octotomy::voxel
