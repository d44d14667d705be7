// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// Whether a .nii or .nii.gz file's header is NIfTI-2's.
bool is_nifti2(const std::filesystem::path& path);

/// Reads a NIfTI-2 volume, which ITK does not. Takes the affine of the sform, else of the qform, and turns it
/// from RAS to LPS. Throws Error, Input, with path and reason if the header is damaged, the volume has more
/// than three axes or samples that are no numbers, or the samples are cut short. Memory: the inflated file
/// and the samples.
Scene read_nifti2(const std::filesystem::path& path);

}  // namespace octotomy::voxel
