// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "voxel/scan/read_scene.h"
#include "voxel/scan/volume_header.h"
#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// Reads a volume file by ITK; `slices_final` as in ReadOptions. Throws Error, Input, with path and reason.
/// Memory: at most the data file's size if raw, 1100 times that if compressed.
Scene read_volume_file(const std::filesystem::path& path, VolumeFormat format,
                       const SlicesFinal& slices_final = {});

/// Writes a file under exactly this name; .nhdr and .mhd get a data file beside it. Throws as write_scene().
void write_volume_file(const Scene& scene, const std::filesystem::path& path, VolumeFormat format);

}  // namespace octotomy::voxel
