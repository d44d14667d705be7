// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/read_scene.h"

namespace octotomy::voxel {

/// The image files that a path means: the file itself, those of a folder, or those that a pattern with * and
/// ? in its last part matches; in the order of the numbers in their names. Empty where it means none: a file
/// is an image by its extension (tif, tiff, png, jpg, jpeg, bmp, pgm, exr, jp2, webp).
std::vector<std::filesystem::path> image_files(const std::filesystem::path& path);

/// Reads images as the slices of a stack, the first at the feet, spaced as the options say; several pages of
/// a file are as many slices. All must have one size and type. Patient frame and unit are not told by images:
/// the audit says what is taken. Throws as read_scene.
Scene read_image_stack(const std::filesystem::path& path, const ReadOptions& options);

}  // namespace octotomy::voxel
