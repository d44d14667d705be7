// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/dicom_slice.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <vector>

#include "voxel/dicom_codec.h"
#include "voxel/dicom_file.h"

namespace octotomy::voxel {

namespace {

/// How a pixel is stored: in `allocated` bits, of which `stored` ending at `high` are its value.
struct PixelBits {
  unsigned allocated = 16;
  unsigned stored = 16;
  unsigned high = 15;
  bool is_signed = false;
};

PixelBits pixel_bits(const DicomFile& file) {
  PixelBits bits;
  bits.allocated = file.unsigned_short(0x00280100).value_or(16);
  bits.stored = file.unsigned_short(0x00280101).value_or(static_cast<std::uint16_t>(bits.allocated));
  bits.high = file.unsigned_short(0x00280102).value_or(static_cast<std::uint16_t>(bits.stored - 1));
  bits.is_signed = file.unsigned_short(0x00280103).value_or(0) == 1;
  return bits;
}

bool is_sound(const PixelBits& bits) {
  return (bits.allocated == 8 || bits.allocated == 16 || bits.allocated == 32) && bits.stored >= 1 &&
         bits.stored <= bits.allocated && bits.high < bits.allocated && bits.high + 1 >= bits.stored;
}

/// Fills the slice's geometry; the reason where there is none.
std::optional<NoSlice> take_geometry(const DicomFile& file, DicomSlice& slice) {
  const auto position = file.decimals(0x00200032);
  const auto orientation = file.decimals(0x00200037);
  if (!position || position->size() != 3) return NoSlice{"an image without ImagePositionPatient"};
  if (!orientation || orientation->size() != 6) return NoSlice{"an image without ImageOrientationPatient"};
  auto spacing = file.decimals(0x00280030);
  if (!spacing) {
    spacing = file.decimals(0x00181164);
    slice.spacing_at_detector = true;
  }
  if (!spacing || spacing->size() != 2 || (*spacing)[0] <= 0.0 || (*spacing)[1] <= 0.0)
    return NoSlice{"an image without PixelSpacing"};
  slice.first_mm = {(*position)[0], (*position)[1], (*position)[2]};
  slice.along_row = {(*orientation)[0], (*orientation)[1], (*orientation)[2]};
  slice.along_column = {(*orientation)[3], (*orientation)[4], (*orientation)[5]};
  slice.spacing_mm = {(*spacing)[1], (*spacing)[0]};  // the tag gives the distance of rows first
  slice.thickness_mm = file.decimal(0x00180050);
  slice.tilt_deg = file.decimal(0x00181120);
  return std::nullopt;
}

/// The reason why the pixels cannot be those of a grey slice; none where they can.
std::optional<NoSlice> flaw_of_pixels(const DicomFile& file, const DicomSlice& slice) {
  if (file.unsigned_short(0x00280002).value_or(1) != 1) return NoSlice{"a colour image"};
  if (file.decimal(0x00280008).value_or(1.0) > 1.0)
    return NoSlice{"a multi-frame image; export it as single frames"};
  const PixelBits bits = pixel_bits(file);
  if (!is_sound(bits)) return NoSlice{"pixels of " + std::to_string(bits.allocated) + " bits"};
  const std::size_t needed = static_cast<std::size_t>(slice.size_px.x) *
                             static_cast<std::size_t>(slice.size_px.y) * (bits.allocated / 8);
  if (!file.raw_pixels() && !file.fragments()) return NoSlice{"DICOM without pixels"};
  if (file.raw_pixels() && file.raw_pixels()->size() < needed)
    return NoSlice{"cut short: " + std::to_string(file.raw_pixels()->size()) + " bytes of pixels of " +
                   std::to_string(needed)};
  if (file.fragments()) {
    // Compressed pixels may be blank: up to 4096 x 4096 of two bytes are believed of any file.
    std::size_t held = 0;
    for (const std::string_view fragment : *file.fragments()) held += fragment.size();
    if (needed > std::max(std::size_t{4096} * 4096 * 2, 1100 * held))
      return NoSlice{"claims " + std::to_string(needed) + " bytes of pixels, more than its file can hold"};
  }
  return std::nullopt;
}

std::variant<DicomSlice, NoSlice> slice_of(const DicomFile& file, const std::filesystem::path& path) {
  if (file.text(0x00020002) == "1.2.840.10008.1.3.10") return NoSlice{"a DICOM directory"};
  DicomSlice slice;
  slice.path = path;
  const auto rows = file.unsigned_short(0x00280010);
  const auto columns = file.unsigned_short(0x00280011);
  if (!rows || !columns || *rows == 0 || *columns == 0) return NoSlice{"DICOM without an image"};
  slice.size_px = {*columns, *rows};
  if (const auto flaw = flaw_of_pixels(file, slice)) return *flaw;
  if (const auto flaw = take_geometry(file, slice)) return *flaw;
  slice.inverted = file.text(0x00280004) == "MONOCHROME1";
  slice.instance_uid = file.text(0x00080018);
  slice.series_uid = file.text(0x0020000e);
  slice.series_description = file.readable_text(0x0008103e);
  slice.modality = file.readable_text(0x00080060);
  slice.rescale_type = file.readable_text(0x00281054);
  slice.intercept = file.decimal(0x00281052);
  slice.slope = file.decimal(0x00281053);
  const double instance = file.decimal(0x00200013).value_or(0.0);
  slice.instance_number = std::abs(instance) < 1e9 ? static_cast<int>(instance) : 0;
  return slice;
}

/// The file's bytes, or only the first 132 where they are not DICOM's.
std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes(132, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  if (!in || !DicomFile::begins(bytes)) return bytes;
  const std::size_t head = bytes.size();
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error || size < head) return bytes;
  bytes.resize(static_cast<std::size_t>(size));
  in.read(bytes.data() + head, static_cast<std::streamsize>(bytes.size() - head));
  bytes.resize(head + static_cast<std::size_t>(in.gcount()));
  return bytes;
}

[[noreturn]] void refuse(const DicomSlice& slice, const std::string& reason) {
  throw std::runtime_error(slice.path.string() + ": " + reason);
}

/// Pixels decompressed, little-endian in the bits that the header allocates.
std::string decompressed(const DicomFile& file, const DicomSlice& slice, const PixelBits& bits) {
  std::optional<std::string> pixels = decompress(
      {file.transfer_syntax(), static_cast<unsigned>(slice.size_px.x), static_cast<unsigned>(slice.size_px.y),
       bits.allocated, bits.stored, bits.high, bits.is_signed, *file.fragments()});
  if (!pixels)
    refuse(slice, "pixels in transfer syntax " + file.transfer_syntax() +
                      " cannot be decompressed; the file is damaged or must be decompressed beforehand");
  return std::move(*pixels);
}

/// The value that stands in the stored bits of a pixel's word.
double value_of(std::uint32_t word, const PixelBits& bits) {
  const std::uint32_t mask = bits.stored == 32 ? 0xffffffffu : (1u << bits.stored) - 1;
  word = (word >> (bits.high + 1 - bits.stored)) & mask;
  const std::uint32_t sign = 1u << (bits.stored - 1);
  return bits.is_signed && (word & sign) != 0 ? static_cast<double>(word) - static_cast<double>(mask) - 1.0
                                              : static_cast<double>(word);
}

template <typename Sample>
bool read_samples(const DicomSlice& slice, std::span<Sample> samples) {
  const std::string bytes = bytes_of(slice.path);
  try {
    const DicomFile file(bytes);
    // The file may have changed since its header was read: what is relied on is looked at anew.
    if (const std::variant<DicomSlice, NoSlice> now = slice_of(file, slice.path);
        !std::holds_alternative<DicomSlice>(now) || std::get<DicomSlice>(now).size_px != slice.size_px)
      refuse(slice, "changed while it was read");
    const PixelBits bits = pixel_bits(file);
    const std::string decoded = file.fragments() ? decompressed(file, slice, bits) : std::string();
    const std::string_view pixels = file.fragments() ? std::string_view(decoded) : *file.raw_pixels();
    const std::size_t width = bits.allocated / 8;
    if (pixels.size() < samples.size() * width) refuse(slice, "the pixels decompress to too few bytes");
    const bool is_swapped = file.big_endian() && !file.fragments();
    const double slope = slice.slope.value_or(1.0);
    const double intercept = slice.intercept.value_or(0.0);
    bool fits = true;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      std::uint32_t word = 0;
      for (std::size_t byte = 0; byte < width; ++byte) {
        const std::size_t at = i * width + (is_swapped ? width - 1 - byte : byte);
        word |= std::uint32_t{static_cast<unsigned char>(pixels[at])} << (8 * byte);
      }
      const double value = slope * value_of(word, bits) + intercept;
      if constexpr (std::is_same_v<Sample, float>) {
        samples[i] = static_cast<float>(value);
      } else {
        const bool held = value >= std::numeric_limits<Sample>::min() &&
                          value <= std::numeric_limits<Sample>::max() && value == std::trunc(value);
        fits = fits && held;
        samples[i] = held ? static_cast<Sample>(value) : Sample{0};
      }
    }
    return fits;
  } catch (const std::runtime_error&) {
    throw;
  } catch (const std::exception& error) {
    refuse(slice, std::string("its pixels cannot be read: ") + error.what());
  }
}

}  // namespace

std::variant<DicomSlice, NoSlice> read_dicom_slice(const std::filesystem::path& path) {
  const std::string bytes = bytes_of(path);
  if (!DicomFile::begins(bytes)) return NoSlice{"not DICOM"};
  try {
    return slice_of(DicomFile(bytes), path);
  } catch (const std::runtime_error& error) {
    return NoSlice{error.what()};
  }
}

bool read_dicom_samples(const DicomSlice& slice, std::span<std::int16_t> samples) {
  return read_samples(slice, samples);
}

bool read_dicom_samples(const DicomSlice& slice, std::span<float> samples) {
  return read_samples(slice, samples);
}

}  // namespace octotomy::voxel
