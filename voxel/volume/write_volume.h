// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "voxel/space/scene.h"
#include "voxel/volume/volume_header.h"

namespace octotomy::voxel {

/// Writes a file under exactly this name; .nhdr and .mhd get a data file beside it. States the frame, the
/// unit of length, the values' meaning and the modality. Throws as write_scene().
void write_volume(const Scene& scene, const std::filesystem::path& path, VolumeFormat format);

}  // namespace octotomy::voxel
