// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/scan/read_scene.h"

namespace octotomy::voxel {

/// Reads one DICOM series of a folder and its subfolders, a multi-frame file, or a single slice. Orders
/// slices by position along their normal, never by name or number. The audit reports every interpolation and
/// lists the files of every doubt: the checks of stack_of_series(), slice_plan() and audit_neighbours(), and
/// rescale, padding, unstated_padding, stored_bits, blank_slices, repeated_slices, sample_steps, air_level.
/// Each slice's own padding is used. If a slice states none and others do, their padding value is assumed at
/// the rim of its image. Padded samples have the value of the scene's `padding`. Throws as read_scene() does.
/// Parallel over slices; same bits on any thread count.
Scene read_dicom(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace octotomy::voxel
