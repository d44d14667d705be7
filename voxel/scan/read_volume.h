// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "voxel/scan/read_scene.h"
#include "voxel/space/scene.h"
#include "voxel/volume/volume_header.h"

namespace octotomy::voxel {

/// Reads a NIfTI, NRRD or MetaImage. The audit has a line for each statement of the header: frame, unit of
/// length, scaling and the values' unit, and a line for each assumption that replaces a missing statement.
/// Throws Error (Input) with path and reason. Memory: the stored samples and the scene's, both bounded by the
/// size of the files.
Scene read_volume(const std::filesystem::path& path, VolumeFormat format, const ReadOptions& options = {});

}  // namespace octotomy::voxel
