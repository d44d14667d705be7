// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "voxel/volume/volume_header.h"

namespace octotomy::voxel {

/// Reads and decodes `bytes` bytes of samples; text and hexadecimal numbers are converted. After every few
/// megabytes calls `held`, if set, with the number of bytes that are final, but not after the last byte.
/// Returns the number of surplus bytes after the samples. Throws Error (Input) with `path` and reason, if the
/// samples are truncated or damaged. Cost: reads and decompresses the files once. Memory: for text, the whole
/// file.
std::uintmax_t read_sample_files(const std::filesystem::path& path, const SampleFiles& from, char* samples,
                                 std::uintmax_t bytes,
                                 const std::function<void(std::uintmax_t held)>& held = {});

}  // namespace octotomy::voxel
