// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/scan/read_scene.h"

namespace octotomy::voxel {

/// The image files that a path names: the file itself, the images in a folder, or the matches of a pattern
/// with * and ? in its last part; in the order of the numbers in their names (slice_names.h). Empty if the
/// path names no image. A file is an image by its extension (tif, tiff, png, jpg, jpeg, bmp, pgm, exr, jp2,
/// webp).
std::vector<std::filesystem::path> image_files(const std::filesystem::path& path);

/// Reads images as the slices of a stack, the first at the feet; each page of a file is a slice. The spacing
/// comes from the options, else from ImageJ's or OME's statement in the pictures' descriptions, with a line
/// in the audit. If they state only a part of the spacing, or a page has only a resolution, the spacing
/// counts as not stated. All images must have the same size and type. Images have no patient frame: the audit
/// reports the assumed one, and any ambiguity in the names (slice_names). The audit also reports where
/// statements of the pictures differ from the options: sizes of pixels and slices (picture_spacing), times
/// and channels (picture_axes), WhiteIsZero (polarity), JPEG's losses (compression). A folder whose names are
/// those of several stacks ("ct_001.png", "mask_001.png") is refused; a pattern that matches several stacks
/// is a FAIL, and names that differ only by numbers ("s1_001.png", "s2_001.png") are a WARN (stacks). Throws
/// as read_scene() does.
Scene read_image_stack(const std::filesystem::path& path, const ReadOptions& options);

}  // namespace octotomy::voxel
