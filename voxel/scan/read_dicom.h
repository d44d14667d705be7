// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/scan/read_scene.h"

namespace octotomy::voxel {

/// Reads one DICOM series of a folder and its subfolders, a multi-frame file, or a single slice. Orders
/// slices by position along their normal, never by name or number. The audit reports every interpolation and,
/// for every doubt, the files concerned. Its lines are those of stack_of_series(), slice_plan() and
/// audit_neighbours(), and rescale, padding, unstated_padding, stored_bits, blank_slices, repeated_slices,
/// sample_steps, air_level. For each slice the padding that it states is used. If a slice states none but
/// others do, their padding value is assumed at the rim of its image. In the scene all padded samples have
/// the value Scene::padding. Throws as read_scene() does. Parallel over slices; same bits on any thread
/// count.
Scene read_dicom(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace octotomy::voxel
