// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/scan/read_scene.h"

namespace octotomy::voxel {

/// Reads a file of samples without a header in the options' layout and spacing. Its axes are assumed to point
/// to the patient's left, back and head, centred on the origin; the audit says so. Throws Error, Input, if
/// the layout is unusable, no spacing is given, or the file's size is not the layout's.
Scene read_raw(const std::filesystem::path& path, const ReadOptions& options);

/// The lattice of a file without a patient frame: the options' spacing, axes along LPS, centred on the
/// origin. Throws Error, Input, naming the path if the options have no spacing or one that is not positive.
Lattice lattice_without_frame(const std::filesystem::path& path, const glm::ivec3& dims,
                              const ReadOptions& options);

}  // namespace octotomy::voxel
