// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

/// What octotomy_image_io.so offers under the name "octotomy_encode_image". Fills `encoded`, or `error` with
/// the reason and returns false. No exception crosses the library's boundary.
extern "C" bool octotomy_encode_image(const char* format, int width, int height, const std::uint8_t* rgb,
                                      std::vector<std::uint8_t>* encoded, std::string* error);

namespace octotomy::voxel {
/// A grey image as a file holds it: samples row by row from the top left.
struct StoredImage {
  enum class Type { UInt8, UInt16, Int16, Float };
  int width = 0;
  int height = 0;
  Type type = Type::UInt8;
  std::vector<char> bytes;  ///< in this machine's order
};
}  // namespace octotomy::voxel

/// Offered as "octotomy_read_images": the images of a file, one a page, or `error` with the reason and false.
/// Colour is refused unless its channels are equal. Nothing is allocated beyond `most_bytes` in all.
extern "C" bool octotomy_read_images(const char* path, std::size_t most_bytes,
                                     std::vector<octotomy::voxel::StoredImage>* images, std::string* error);
