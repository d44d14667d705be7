// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>

namespace octotomy::voxel {

/// Lets this process take at most so many bytes for data; what goes beyond is std::bad_alloc.
void limit_memory(std::uint64_t bytes);

/// Bytes that this process may still take: what the system has free, and what limit_memory() left.
std::uint64_t free_memory();

/// Throws Error (Resource) with both figures where `path`, of `sample_count` samples that take
/// `sample_bytes` each while they are read, does not fit into free_memory().
void need_memory(const std::filesystem::path& path, std::uint64_t sample_count, std::uint64_t sample_bytes);

}  // namespace octotomy::voxel
