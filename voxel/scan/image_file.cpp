// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/image_file.h"

#include <algorithm>
#include <cerrno>
#include <dlfcn.h>
#include <fstream>
#include <stdexcept>

#include "voxel/picture/encode_png.h"
#include "voxel/picture/png_chunk.h"
#include "voxel/scan/image_file_oiio.h"
#include "voxel/scan/picture_header.h"
#include "voxel/scan/portable_map.h"
#include "voxel/space/error.h"
#include "voxel/space/file_text.h"
#include "voxel/space/helper_file.h"
#include "voxel/space/quiet_errors.h"
#include "voxel/space/staged_files.h"
#include "voxel/space/write_failure.h"
#include "voxel/space/write_whole.h"

namespace octotomy::voxel {

namespace {

namespace fs = std::filesystem;
using Encode = decltype(&octotomy_encode_image);
using Read = decltype(&octotomy_read_images);

/// The library octotomy_image_io.so. It is never unloaded, because OpenImageIO's threads run until the
/// program ends.
void* symbol_of_library(const char* name) {
  const fs::path path = helper_file("octotomy_image_io.so");
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr)
    throw Error(ErrorCode::Resource, path.string() + ": pictures cannot be read or written: " + dlerror() +
                                         "; install this library and OpenImageIO again");
  void* symbol = dlsym(library, name);
  if (symbol == nullptr)
    throw Error(ErrorCode::Resource, path.string() + ": is not this program's library; install both again");
  return symbol;
}

}  // namespace

std::vector<std::uint8_t> encode_image(const std::string& format, const glm::ivec2& size_px,
                                       const std::vector<std::uint8_t>& rgb,
                                       const std::optional<ImageText>& text) {
  if (size_px.x < 1 || size_px.y < 1 ||
      rgb.size() !=
          std::size_t{3} * static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y))
    throw std::invalid_argument("a picture of " + std::to_string(size_px.x) + " x " +
                                std::to_string(size_px.y) + " pixels does not have " +
                                std::to_string(rgb.size()) + " bytes");
  if (format != "png" && format != "jpeg" && format != "webp")
    throw Error(ErrorCode::Input, "no picture is encoded as '" + format + "'; choose png, jpeg or webp");
  if (format == "png") {
    const std::vector<std::uint8_t> png = encode_png(size_px, rgb);
    return text ? with_png_text(png, text->keyword, text->text) : png;
  }
  static const Encode encode = reinterpret_cast<Encode>(symbol_of_library("octotomy_encode_image"));
  std::vector<std::uint8_t> encoded;
  std::string error;
  if (!encode(format.c_str(), size_px.x, size_px.y, rgb.data(), &encoded, &error))
    throw Error(ErrorCode::Resource, "a picture cannot be encoded as " + format + ": " + error);
  return encoded;
}

std::string image_library_version() {
  using Version = decltype(&octotomy_image_library_version);
  const int version = reinterpret_cast<Version>(symbol_of_library("octotomy_image_library_version"))();
  // OpenImageIO's version number is 10000 major + 100 minor + patch.
  return std::to_string(version / 10000) + "." + std::to_string(version / 100 % 100) + "." +
         std::to_string(version % 100);
}

std::vector<StoredImage> read_images(const fs::path& path) {
  static const Read read = reinterpret_cast<Read>(symbol_of_library("octotomy_read_images"));
  // Blank pixels compress to almost nothing, so a file of any size may hold 4096 x 4096 pixels of four bytes.
  const std::size_t most_bytes =
      std::max(std::size_t{4096} * 4096 * 4, 1100 * static_cast<std::size_t>(fs::file_size(path)));
  PictureHeader header;
  // OpenImageIO multiplies samples by 65535 in signed 32-bit numbers, which overflows for samples above
  // 32768.
  constexpr std::uint32_t largest_of_library = 32767;
  try {
    header = read_picture_header(picture_header_bytes(path), most_bytes);
    if (header.format == "pnm" && header.largest_sample > largest_of_library)
      return {read_portable_map(file_bytes(path), most_bytes)};
  } catch (const InvalidInput& error) {
    refuse(path, error.what());
  }
  std::vector<StoredImage> images;
  std::string error;
  bool is_read = false;
  {
    const QuietErrors quiet;  // libpng also prints its error messages
    is_read = read(path.c_str(), header.format.c_str(), header.largest_sample, most_bytes, &images, &error);
  }
  if (!is_read) {
    std::replace(error.begin(), error.end(), '\n', ' ');
    refuse(path, "cannot be read as images: " + error);
  }
  return images;
}

void write_image(const fs::path& path, const glm::ivec2& size_px, const std::vector<std::uint8_t>& rgb,
                 const std::optional<ImageText>& text) {
  std::string format = extension_of(path);
  if (!format.empty()) format.erase(0, 1);
  if (format == "jpg") format = "jpeg";
  std::vector<std::uint8_t> encoded;
  try {
    encoded = encode_image(format, size_px, rgb, text);
  } catch (const Error& error) {
    throw Error(error.code(), path.string() + ": " + error.what());
  }
  write_whole(path, {encoded.begin(), encoded.end()});
}

}  // namespace octotomy::voxel
