// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

/// Exported by octotomy_image_io.so. Fills `encoded`, or fills `error` with the reason and returns false. No
/// exception crosses the library's boundary.
extern "C" bool octotomy_encode_image(const char* format, int width, int height, const std::uint8_t* rgb,
                                      std::vector<std::uint8_t>* encoded, std::string* error);

/// Exported by octotomy_image_io.so: the version of OpenImageIO that is loaded.
extern "C" int octotomy_image_library_version();

namespace octotomy::voxel {
/// A grey image as stored in a file: samples row by row from the top left.
struct StoredImage {
  enum class Type { UInt8, UInt16, Int16, Float };
  int width = 0;
  int height = 0;
  Type type = Type::UInt8;
  std::vector<char> bytes;  ///< samples in this machine's byte order, rotated upright
  /// The orientation that the file states for its stored rows and columns, 1 to 8 as in TIFF and EXIF; 1:
  /// they were upright.
  int orientation = 1;
  double pixels_per_unit = 0.0;         ///< resolution along rows, as the file states it; 0: not stated
  double pixels_per_unit_across = 0.0;  ///< across rows
  /// Length of the resolution's unit; 0: the unit is not stated or is not a length.
  double mm_per_unit = 0.0;
  bool is_white_zero = false;  ///< TIFF's WhiteIsZero: large samples are dark
  bool is_lossy = false;
  std::string description;  ///< free text in which ImageJ and OME describe the file
};
}  // namespace octotomy::voxel

/// Exported by octotomy_image_io.so. Fills `images` with the pages of a file in the given format, or fills
/// `error` with the reason and returns false. Samples have the values of the file: stretching by the reader
/// is undone by means of `largest_sample`, the largest value that a sample may have (PictureHeader). Refuses
/// colour: channels that differ, in JPEG and WebP by more than one of 255. Refuses files whose pages
/// together, or a single tile, take more than `most_bytes`.
extern "C" bool octotomy_read_images(const char* path, const char* format, std::uint32_t largest_sample,
                                     std::size_t most_bytes,
                                     std::vector<octotomy::voxel::StoredImage>* images, std::string* error);
