// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "voxel/space/scene.h"
#include "voxel/volume/volume_header.h"

namespace octotomy::voxel {

/// Writes a file under exactly the given name; for .nhdr and .mhd also a data file beside it. The header
/// states the frame, the unit of length, the values' meaning and the modality. Throws as write_scene() does.
void write_volume(const Scene& scene, const std::filesystem::path& path, VolumeFormat format);

}  // namespace octotomy::voxel
