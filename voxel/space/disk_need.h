// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace octotomy::voxel {

/// Highest compression of deflate: 258 bytes into 2 bits.
inline constexpr std::uint64_t deflate_ratio = 1032;

/// Free bytes that the file system of a folder grants this process. None if they are unknown, or if a file
/// may take fewer bytes on disk than it has: on compressing, network, layered and unrecognised file systems.
std::optional<std::uint64_t> free_disk(const std::filesystem::path& folder);

/// Throws Error (Resource) with both figures if `out`, a file or folder that takes at least `least_bytes`
/// while it is written, does not fit into free_disk() of its folder. An older file of the same name frees no
/// room, because it stays until the new one is complete.
void need_disk(const std::filesystem::path& out, std::uint64_t least_bytes);

}  // namespace octotomy::voxel
