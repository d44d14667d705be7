// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "voxel/scene.h"

namespace octotomy::voxel {

/// Whether a .nii or .nii.gz file's header is NIfTI-2's.
bool is_nifti2(const std::filesystem::path& path);

/// Reads a NIfTI-2 volume (which ITK does not): the affine of the sform, else of the qform, turned from RAS
/// to LPS. Throws std::runtime_error with path and reason where the header is damaged, the volume has more
/// than three axes or a type that is no number, or its samples are cut short. Memory: the file inflated, and
/// the samples.
Scene read_nifti2(const std::filesystem::path& path);

}  // namespace octotomy::voxel
