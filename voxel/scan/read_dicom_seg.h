// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// Whether a file is a DICOM segmentation, by its storage class. Returns false also for files that cannot be
/// read.
bool is_dicom_seg(const std::filesystem::path& path);

/// Reads a DICOM segmentation as a label map: a sample is the number of its segment, or 0 for none. The
/// lattice is that of the frames, unshifted; planes without a frame are empty. The distance of planes is the
/// stated one if all positions fit it within a fifth of it, else it follows from the positions. Where
/// segments overlap, a further number represents all of them (Scene::overlaps). A fractional segment has the
/// pixels of at least half of its maximum. In the audit, "segments" lists numbers and labels, "overlaps" the
/// segments that overlap. "slice_spacing", "fractions" and "undescribed" report uneven positions, fractions
/// that were cut, and segments without a description. Deflated files are inflated. Throws Error, Input, with
/// path and reason, also if frames are compressed, turned against each other or off one lattice. Memory: the
/// file, and two bytes per sample of at most four planes per frame.
Scene read_dicom_seg(const std::filesystem::path& path);

}  // namespace octotomy::voxel
