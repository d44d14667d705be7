// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/scan/read_scene.h"

namespace octotomy::voxel {

/// The image files that a path names: the file itself, the images in a folder, or the matches of a pattern
/// with * and ? in its last part; in the order of the numbers in their names (slice_names.h). Empty if it
/// names none. A file is an image by its extension (tif, tiff, png, jpg, jpeg, bmp, pgm, exr, jp2, webp).
std::vector<std::filesystem::path> image_files(const std::filesystem::path& path);

/// Reads images as the slices of a stack, the first at the feet; each page of a file is a slice. The spacing
/// is the options', else what ImageJ or OME state in the pictures' descriptions, with a line in the audit;
/// where they state a part of it, or only the resolution of a page, there is none. All must have the same
/// size and type. Images hold no patient frame: the audit states the assumed one, and what their names leave
/// open (slice_names). What pictures state of themselves is held against the options: sizes of pixels and
/// slices (picture_spacing), times and channels (picture_axes), WhiteIsZero (polarity), JPEG's losses
/// (compression). A folder whose names are those of several stacks ("ct_001.png", "mask_001.png") is refused;
/// a pattern that takes several is a FAIL, and names that differ by numbers alone ("s1_001.png",
/// "s2_001.png") are a WARN (stacks). Throws as read_scene().
Scene read_image_stack(const std::filesystem::path& path, const ReadOptions& options);

}  // namespace octotomy::voxel
