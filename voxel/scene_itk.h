// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "voxel/scene.h"
#include "voxel/volume_header.h"

namespace octotomy::voxel {

/// Throws std::runtime_error with path and reason. Allocates only what the data file can hold: its size for
/// raw data, 1100 times that for compressed data.
Scene read_volume_file(const std::filesystem::path& path, VolumeFormat format);

/// Writes under the very name given, with its data file beside it for .nhdr and .mhd.
/// Throws as write_scene.
void write_volume_file(const Scene& scene, const std::filesystem::path& path, VolumeFormat format);

}  // namespace octotomy::voxel
