// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace octotomy::voxel {

/// The highest compression ratio of deflate: 258 bytes become 2 bits.
inline constexpr std::uint64_t deflate_ratio = 1032;

/// The number of free bytes that this process may use on the file system of a folder. None if they are
/// unknown, or if a file may take fewer bytes on disk than it has: on compressing, network, layered and
/// unrecognised file systems.
std::optional<std::uint64_t> free_disk(const std::filesystem::path& folder);

/// Throws Error (Resource) with both figures if `out`, a file or folder that takes at least `least_bytes`
/// while it is written, does not fit into free_disk() of its folder. The space of an older file of the same
/// name is not counted as free, because this file remains until the new one is complete.
void need_disk(const std::filesystem::path& out, std::uint64_t least_bytes);

}  // namespace octotomy::voxel
