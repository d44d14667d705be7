// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "voxel/scene.h"

namespace octotomy::voxel {

/// Reads a scan: a folder or a file of DICOM, or NIfTI, NRRD or MetaImage. Values are rescaled as the file
/// says and held as int16 where every one of them is an integer of its range, otherwise as float; geometry
/// comes out in LPS millimetres whatever frame the file speaks. The scene's audit lists every check made and
/// every doubt: missing or repeated slices, uneven spacing, gantry tilt, absent rescale, stray files.
/// Throws std::runtime_error with path and reason where nothing sound can be read.
/// Memory: bounded by a multiple of the file's size; the samples once, and one slice or the decoder's own
/// copy beside them; twice where slices have to be resampled.
Scene read_scene(const std::filesystem::path& path);

}  // namespace octotomy::voxel
