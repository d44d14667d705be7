// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/image_file_oiio.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <memory>
#include <string_view>

extern "C" bool octotomy_encode_image(const char* format, int width, int height, const std::uint8_t* rgb,
                                      std::vector<std::uint8_t>* encoded, std::string* error) {
  try {
    OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    const std::string name = format;
    spec.attribute("Compression", name + ":92");
    const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(name);
    OIIO::Filesystem::IOVecOutput memory(*encoded);
    if (!out || !out->supports("ioproxy")) {
      *error = "OpenImageIO cannot write '" + name + "' to memory";
      OIIO::geterror();
      return false;
    }
    if (out->set_ioproxy(&memory) && out->open("image." + name, spec) &&
        out->write_image(OIIO::TypeDesc::UINT8, rgb) && out->close())
      return true;
    *error = out->geterror();
  } catch (const std::exception& failure) {
    *error = failure.what();
  }
  return false;
}

namespace {

using octotomy::voxel::StoredImage;

/// Between the channels of a grey picture that was coded as brightness and two colours, of 255: each channel
/// is rounded by itself when it is decoded.
constexpr int lossy_shades_apart = 1;

/// The type to read samples as: their own if it is one of the four, else the next that holds every value.
StoredImage::Type type_of(OIIO::TypeDesc type) {
  switch (type.basetype) {
    case OIIO::TypeDesc::UINT8:
      return StoredImage::Type::UInt8;
    case OIIO::TypeDesc::INT8:
    case OIIO::TypeDesc::INT16:
      return StoredImage::Type::Int16;
    case OIIO::TypeDesc::UINT16:
      return StoredImage::Type::UInt16;
    default:
      return StoredImage::Type::Float;
  }
}

OIIO::TypeDesc described(StoredImage::Type type) {
  switch (type) {
    case StoredImage::Type::UInt8:
      return OIIO::TypeDesc::UINT8;
    case StoredImage::Type::UInt16:
      return OIIO::TypeDesc::UINT16;
    case StoredImage::Type::Int16:
      return OIIO::TypeDesc::INT16;
    case StoredImage::Type::Float:
      break;
  }
  return OIIO::TypeDesc::FLOAT;
}

/// Whether the first three channels are the same at every pixel; of single bytes, up to `most_apart`.
bool is_grey(const std::vector<char>& pixels, std::size_t channels, std::size_t width, int most_apart) {
  const std::size_t step = channels * width;
  const auto differ = [&](std::size_t a, std::size_t b) {
    return width == 1 ? std::abs(static_cast<std::uint8_t>(pixels[a]) -
                                 static_cast<std::uint8_t>(pixels[b])) > most_apart
                      : pixels[a] != pixels[b];
  };
  for (std::size_t at = 0; at + step <= pixels.size(); at += step)
    for (std::size_t byte = 0; byte < width; ++byte)
      if (differ(at + byte, at + width + byte) || differ(at + byte, at + 2 * width + byte)) return false;
  return true;
}

/// Reads the current page. Returns the reason if it cannot be a slice, else an empty text.
std::string read_page(OIIO::ImageInput& in, int page, std::size_t most_bytes, StoredImage& image) {
  const OIIO::ImageSpec spec = in.spec();
  image.width = spec.width;
  image.height = spec.height;
  image.type = type_of(spec.format);
  const OIIO::TypeDesc type = described(image.type);
  const auto channels = static_cast<std::size_t>(spec.nchannels);
  if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || channels < 1) return "a page that is no image";
  const auto bytes_of = [&](int width, int height) {
    return static_cast<double>(width) * height * static_cast<double>(channels * type.size());
  };
  const double bytes = bytes_of(spec.width, spec.height);
  if (std::max(bytes, bytes_of(spec.tile_width, spec.tile_height)) > static_cast<double>(most_bytes))
    return "a page that claims more pixels than the file can hold";
  std::vector<char> pixels(static_cast<std::size_t>(bytes));
  if (!in.read_image(page, 0, 0, spec.nchannels, type, pixels.data())) {
    const std::string error = in.geterror();
    return error.empty() ? "its pixels end early or are damaged" : error;  // some readers say nothing
  }
  const std::string_view format = in.format_name();
  const int most_apart = format == "webp" || format == "jpeg" ? lossy_shades_apart : 0;
  if (channels >= 3 && !is_grey(pixels, channels, type.size(), most_apart))
    return "a colour image; a scan is grey";
  image.bytes.resize(pixels.size() / channels);
  for (std::size_t i = 0; i < image.bytes.size() / type.size(); ++i)
    std::memcpy(&image.bytes[i * type.size()], &pixels[i * channels * type.size()], type.size());
  return {};
}

}  // namespace

extern "C" bool octotomy_read_images(const char* path, const char* format, std::size_t most_bytes,
                                     std::vector<StoredImage>* images, std::string* error) {
  try {
    // open() would try every reader that OpenImageIO has.
    const std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::create(format);
    OIIO::ImageSpec first;
    if (!in || !in->open(path, first)) {
      *error = in ? in->geterror() : OIIO::geterror();
      return false;
    }
    for (int page = 0; in->seek_subimage(page, 0); ++page) {
      images->emplace_back();
      *error = read_page(*in, page, most_bytes, images->back());
      if (!error->empty()) return false;
      most_bytes -= std::min(most_bytes, images->back().bytes.size());
    }
    if (!images->empty()) return true;
    *error = "holds no image";
  } catch (const std::exception& failure) {
    *error = failure.what();
  }
  return false;
}
