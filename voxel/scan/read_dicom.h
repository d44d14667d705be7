// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/scan/read_scene.h"

namespace octotomy::voxel {

/// Reads one DICOM series of a folder and its subfolders, a multi-frame file, or a single slice. Orders
/// slices by position along their normal, never by name or number. The audit states every interpolation and
/// names the files of every doubt: stack_of_series()'s and slice_plan()'s checks, rescale, padding,
/// unstated_padding, stored_bits, audit_neighbours()'s, blank_slices, repeated_slices, sample_steps,
/// air_level. Each slice's own padding counts; a slice that states none where others do has theirs at its
/// image's rim, by assumption. Padded samples are the scene's `padding`. Throws as read_scene(). Parallel
/// over slices; same bits on any thread count.
Scene read_dicom(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace octotomy::voxel
