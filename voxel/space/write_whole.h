// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace octotomy::voxel {

/// Writes a file directly, into a folder that no reader uses yet, such as an UnfinishedFolder. Throws Error
/// (Input or Resource) with the path and the reason.
void write_file(const std::filesystem::path& path, const std::string& bytes);

/// Writes a file beside its destination and renames it into place: readers see the old file or the whole new
/// one. Links at the destination are followed, and the old file's permissions are kept. Throws as
/// write_file() and StagedFiles do; the old file then remains.
void write_whole(const std::filesystem::path& path, const std::string& bytes);

}  // namespace octotomy::voxel
