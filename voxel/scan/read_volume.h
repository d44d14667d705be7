// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "voxel/scan/read_scene.h"
#include "voxel/space/scene.h"
#include "voxel/volume/volume_header.h"

namespace octotomy::voxel {

/// Reads a NIfTI, NRRD or MetaImage. The audit has a line for each statement of its header: frame, unit of
/// length, scaling, the values' unit, and each assumption where it states nothing. Throws Error (Input) with
/// path and reason. Memory: the stored samples and the scene's, both bounded by the size of the files.
Scene read_volume(const std::filesystem::path& path, VolumeFormat format, const ReadOptions& options = {});

}  // namespace octotomy::voxel
