// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// Whether a file is a DICOM segmentation, by its storage class. False also of files that cannot be read.
bool is_dicom_seg(const std::filesystem::path& path);

/// Reads a DICOM segmentation as a label map: a sample is the number of its segment, 0 is none. The lattice
/// is that of the frames, unshifted; planes without a frame are empty. Planes are as far apart as the file
/// states if they lie there within a fifth of that, else as their positions are. Where segments overlap, a
/// further number stands for all of them (Scene::overlaps); a fractional segment holds the pixels of at least
/// half of its maximum. The audit's "segments" lists numbers and labels, "overlaps" the segments that
/// overlap; "slice_spacing", "fractions" and "undescribed" report positions off even planes, fractions that
/// are cut and segments without a description. Deflated files are inflated. Throws Error, Input, with path
/// and reason, also if frames are compressed, turned against each other or off one lattice. Memory: the file,
/// and two bytes per sample of at most four planes per frame.
Scene read_dicom_seg(const std::filesystem::path& path);

}  // namespace octotomy::voxel
