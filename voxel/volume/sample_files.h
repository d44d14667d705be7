// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "voxel/volume/volume_header.h"

namespace octotomy::voxel {

/// Reads `bytes` bytes of samples, decoded: numbers of text and hexadecimal ones as well. Calls `held`, if
/// any, with the count of those that are final, every few megabytes before the last ones. Returns how many
/// bytes stand behind the samples and are none of them. Throws Error, Input, with `path` and reason where
/// they are cut short or damaged. Cost: reads and unpacks the files once. Memory: of text, the file.
std::uintmax_t read_sample_files(const std::filesystem::path& path, const SampleFiles& from, char* samples,
                                 std::uintmax_t bytes,
                                 const std::function<void(std::uintmax_t held)>& held = {});

}  // namespace octotomy::voxel
