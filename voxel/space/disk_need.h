// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace octotomy::voxel {

/// The most that deflate packs: 258 bytes into 2 bits.
inline constexpr std::uint64_t deflate_ratio = 1032;

/// Bytes that the file system of a folder still takes from this process. None where it cannot tell, or may
/// keep a file in fewer bytes than it has: file systems that pack, networks, layers of unknown ground.
std::optional<std::uint64_t> free_disk(const std::filesystem::path& folder);

/// Throws Error (Resource) with both figures where `out`, a file or folder that takes `least_bytes` or more
/// while it is written, does not fit beside what free_disk() tells of its folder. An older file of its name
/// makes no room, as it stays until the new one is whole.
void need_disk(const std::filesystem::path& out, std::uint64_t least_bytes);

}  // namespace octotomy::voxel
