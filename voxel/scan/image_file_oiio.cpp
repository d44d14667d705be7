// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/image_file_oiio.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>
#include <string_view>
#include <type_traits>
#include <utility>

extern "C" int octotomy_image_library_version() {
  return OIIO::openimageio_version();
}

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

/// Largest difference, of 255, between the channels of a grey picture coded as brightness and two colours:
/// it arises because decoding rounds each channel separately.
constexpr int lossy_shades_apart = 1;

/// The original value of a stretched sample. Readers stretch samples in one of two ways: they multiply by the
/// type's largest value, divide by the picture's largest and round down, or they repeat the highest bits
/// below the lowest.
template <typename Sample>
Sample unstretched(Sample sample, std::uint32_t largest) {
  constexpr std::uint64_t whole = std::numeric_limits<Sample>::max();
  if (std::has_single_bit(largest + 1))
    return static_cast<Sample>(sample >> (std::bit_width(whole) - std::bit_width(largest)));
  return static_cast<Sample>((std::uint64_t{sample} * largest + whole - 1) / whole);
}

/// Copies the first channel of each pixel to a type that can represent its values.
template <typename Read, typename Stored>
std::vector<char> first_channel(const std::vector<char>& pixels, std::size_t channels,
                                std::uint32_t largest) {
  std::vector<char> bytes(pixels.size() / (channels * sizeof(Read)) * sizeof(Stored));
  for (std::size_t i = 0; i < bytes.size() / sizeof(Stored); ++i) {
    Read sample;
    std::memcpy(&sample, &pixels[i * channels * sizeof(Read)], sizeof sample);
    if constexpr (std::is_unsigned_v<Read>)
      if (largest > 0 && largest < std::numeric_limits<Read>::max()) sample = unstretched(sample, largest);
    const auto stored = static_cast<Stored>(sample);  // NOLINT(bugprone-signed-char-misuse): a number
    std::memcpy(&bytes[i * sizeof(Stored)], &stored, sizeof stored);
  }
  return bytes;
}

/// The type in which samples are read, and the type in which they are stored. If another type were requested,
/// OpenImageIO would stretch integers.
struct Reading {
  OIIO::TypeDesc read_as;
  StoredImage::Type stored_as;
  std::vector<char> (*take)(const std::vector<char>&, std::size_t, std::uint32_t);
};

Reading reading_of(const OIIO::TypeDesc& type) {
  using Type = StoredImage::Type;
  switch (type.basetype) {
    case OIIO::TypeDesc::UINT8:
      return {type, Type::UInt8, first_channel<std::uint8_t, std::uint8_t>};
    case OIIO::TypeDesc::INT8:
      return {type, Type::Int16, first_channel<std::int8_t, std::int16_t>};
    case OIIO::TypeDesc::UINT16:
      return {type, Type::UInt16, first_channel<std::uint16_t, std::uint16_t>};
    case OIIO::TypeDesc::INT16:
      return {type, Type::Int16, first_channel<std::int16_t, std::int16_t>};
    case OIIO::TypeDesc::UINT32:
      return {type, Type::Float, first_channel<std::uint32_t, float>};
    case OIIO::TypeDesc::INT32:
      return {type, Type::Float, first_channel<std::int32_t, float>};
    case OIIO::TypeDesc::UINT64:
      return {type, Type::Float, first_channel<std::uint64_t, float>};
    case OIIO::TypeDesc::INT64:
      return {type, Type::Float, first_channel<std::int64_t, float>};
    default:
      return {OIIO::TypeDesc::FLOAT, Type::Float, first_channel<float, float>};
  }
}

/// The largest sample of a page, if its reader reports the bits per sample, as that of TIFF does; else 0.
/// Pixels expanded from a palette no longer have these bits.
std::uint32_t largest_sample_of(const OIIO::ImageSpec& spec) {
  const int bits = spec.get_int_attribute("oiio:BitsPerSample", 0);
  const bool may_be_coloured = spec.nchannels >= 3 && spec.format == OIIO::TypeDesc::UINT8;
  return bits > 0 && bits < 32 && !may_be_coloured ? (1u << bits) - 1 : 0;
}

/// Whether the first three channels are the same at every pixel; for one-byte samples, up to a difference of
/// `most_apart`.
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

/// Reorders the pixels from the stored orientation to rows from the top, each from the left.
void turn_upright(StoredImage& image) {
  const int code = image.orientation;
  if (code < 2 || code > 8) return;
  const auto width = static_cast<std::size_t>(image.width), height = static_cast<std::size_t>(image.height);
  const std::size_t bytes = image.bytes.size() / (width * height);
  // TIFF 6.0, page 36: in the orientations 5 to 8 rows and columns are exchanged.
  const bool is_turned = code >= 5, from_right = code == 2 || code == 3 || code == 7 || code == 8,
             from_below = code == 3 || code == 4 || code == 6 || code == 7;
  std::vector<char> upright(image.bytes.size());
  const std::size_t columns = is_turned ? height : width, rows = is_turned ? width : height;
  for (std::size_t y = 0; y < rows; ++y)
    for (std::size_t x = 0; x < columns; ++x) {
      std::size_t i = is_turned ? y : x, j = is_turned ? x : y;
      if (from_right) i = width - 1 - i;
      if (from_below) j = height - 1 - j;
      std::copy_n(&image.bytes[(j * width + i) * bytes], bytes, &upright[(y * columns + x) * bytes]);
    }
  image.bytes = std::move(upright);
  if (is_turned) std::swap(image.pixels_per_unit, image.pixels_per_unit_across);
  image.width = static_cast<int>(columns);
  image.height = static_cast<int>(rows);
}

/// Copies a page's statements about its pixels, such as orientation and resolution.
void take_statements(const OIIO::ImageSpec& spec, std::string_view format, StoredImage& image) {
  image.pixels_per_unit = static_cast<double>(spec.get_float_attribute("XResolution", 0.0f));
  image.pixels_per_unit_across = static_cast<double>(spec.get_float_attribute("YResolution", 0.0f));
  const std::string unit = spec.get_string_attribute("ResolutionUnit");
  image.mm_per_unit = unit == "in" || unit == "inch" ? 25.4
                      : unit == "cm"                 ? 10.0
                      : unit == "m"                  ? 1000.0
                                                     : 0.0;
  image.is_white_zero = format == "tiff" && spec.get_int_attribute("tiff:PhotometricInterpretation", 1) == 0;
  image.is_lossy = format == "jpeg" || spec.get_string_attribute("compression") == "jpeg";
  image.description = spec.get_string_attribute("ImageDescription");
}

/// Reads the current page. Returns the reason if it cannot be a slice, else an empty text.
std::string read_page(OIIO::ImageInput& in, int page, std::uint32_t largest_sample, std::size_t most_bytes,
                      StoredImage& image) {
  const OIIO::ImageSpec spec = in.spec();
  image.width = spec.width;
  image.height = spec.height;
  const Reading reading = reading_of(spec.format);
  image.type = reading.stored_as;
  const OIIO::TypeDesc type = reading.read_as;
  const auto channels = static_cast<std::size_t>(spec.nchannels);
  if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || channels < 1)
    return "a page that contains no image";
  // With such a tile size, TIFF's reader would loop forever.
  const bool has_tiles = spec.tile_width != 0 || spec.tile_height != 0;
  if (has_tiles && (spec.tile_width < 1 || spec.tile_height < 1 || spec.tile_depth > 1))
    return "tiles of an invalid size";
  const auto bytes_of = [&](int width, int height) {
    return static_cast<double>(width) * height * static_cast<double>(channels * type.size());
  };
  const double bytes = bytes_of(spec.width, spec.height);
  if (std::max(bytes, bytes_of(spec.tile_width, spec.tile_height)) > static_cast<double>(most_bytes))
    return "a page that claims more pixels than the file can hold";
  std::vector<char> pixels(static_cast<std::size_t>(bytes));
  if (!in.read_image(page, 0, 0, spec.nchannels, type, pixels.data())) {
    const std::string error = in.geterror();
    return error.empty() ? "its pixels end early or are damaged" : error;  // some readers report no reason
  }
  const std::string_view format = in.format_name();
  const int most_apart = format == "webp" || format == "jpeg" ? lossy_shades_apart : 0;
  if (channels >= 3 && !is_grey(pixels, channels, type.size(), most_apart))
    return "a colour image; a scan is grey";
  image.bytes = reading.take(pixels, channels, largest_sample > 0 ? largest_sample : largest_sample_of(spec));
  image.orientation = spec.get_int_attribute("Orientation", 1);
  take_statements(spec, format, image);
  turn_upright(image);
  return {};
}

}  // namespace

extern "C" bool octotomy_read_images(const char* path, const char* format, std::uint32_t largest_sample,
                                     std::size_t most_bytes, std::vector<StoredImage>* images,
                                     std::string* error) {
  try {
    // Creates the format's own reader, because open() would try all of OpenImageIO's readers.
    const std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::create(format);
    OIIO::ImageSpec first, wishes;
    wishes.attribute("oiio:UnassociatedAlpha", 1);  // otherwise samples are multiplied by their alpha
    if (!in || !in->open(path, first, wishes)) {
      *error = in ? in->geterror() : OIIO::geterror();
      return false;
    }
    for (int page = 0; in->seek_subimage(page, 0); ++page) {
      images->emplace_back();
      *error = read_page(*in, page, largest_sample, most_bytes, images->back());
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
