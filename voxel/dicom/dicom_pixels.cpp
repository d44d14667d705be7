// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/dicom/dicom_pixels.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <fcntl.h>
#include <limits>
#include <type_traits>
#include <unistd.h>

#include "voxel/dicom/dicom_codec.h"
#include "voxel/dicom/inflate.h"
#include "voxel/space/file_text.h"

namespace octotomy::voxel {

namespace {

/// Reads an open file at given offsets.
class PlacedReader {
 public:
  explicit PlacedReader(const DicomSlice& slice)
      : slice_(slice), file_(::open(slice.path.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (file_ < 0)
      refuse(slice.path, "cannot be opened: " + std::string(std::strerror(errno)), code_of_errno(errno));
  }
  PlacedReader(const PlacedReader&) = delete;
  PlacedReader& operator=(const PlacedReader&) = delete;
  ~PlacedReader() { ::close(file_); }

  void read(const DicomExtent& extent, char* to) const {
    std::size_t done = 0;
    while (done < extent.length) {
      const ssize_t got =
          ::pread(file_, to + done, extent.length - done, static_cast<off_t>(extent.at + done));
      if (got <= 0) refuse(slice_.path, "changed while it was read");
      done += static_cast<std::size_t>(got);
    }
  }

 private:
  const DicomSlice& slice_;
  int file_;
};

/// Reads the parts of a slice's pixels, without decompressing them.
std::vector<std::string> stored_parts(const DicomSlice& slice) {
  std::vector<std::string> parts;
  if (slice.pixels.is_deflated) {
    const std::string bytes =
        beginning_of(slice.path, static_cast<std::size_t>(std::filesystem::file_size(slice.path)));
    try {
      const DicomFile file(bytes, bytes.size());
      refuse(slice.path, "changed while it was read");
    } catch (const DicomFile::Deflated& from) {
      const std::string whole = inflated(bytes, from.at);
      for (const DicomExtent& part : slice.pixels.parts) {
        if (part.at > whole.size() || part.length > whole.size() - part.at)
          refuse(slice.path, "changed while it was read");
        parts.push_back(whole.substr(part.at, part.length));
      }
    }
    return parts;
  }
  const PlacedReader reader(slice);
  for (const DicomExtent& part : slice.pixels.parts) {
    parts.emplace_back(part.length, '\0');
    reader.read(part, parts.back().data());
  }
  return parts;
}

/// Concatenates all parts of raw pixels.
std::string joined(std::vector<std::string> parts) {
  for (std::size_t i = 1; i < parts.size(); ++i) parts.front() += parts[i];
  return std::move(parts.front());
}

/// Swaps the two bytes of each word.
void swap_bytes(std::string& words) {
  for (std::size_t i = 0; i + 1 < words.size(); i += 2) std::swap(words[i], words[i + 1]);
}

/// Unpacks pixels of 12 bits, two in three bytes, to words of 16 bits. The first pixel has the lower bits
/// (DICOM PS3.5, 8.1.1); big-endian files store 16-bit words, whose bytes are swapped first.
std::string unpacked(std::string packed, std::size_t count, bool big_endian) {
  if (packed.size() % 2 != 0) packed += '\0';
  if (big_endian) swap_bytes(packed);
  packed.append(2, '\0');
  std::string words(2 * count, '\0');
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(packed[i]); };
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = i / 2 * 3 + i % 2;
    const int word = i % 2 == 0 ? byte(at) | (byte(at + 1) & 0x0f) << 8 : byte(at) >> 4 | byte(at + 1) << 4;
    words[2 * i] = static_cast<char>(word & 0xff);
    words[2 * i + 1] = static_cast<char>(word >> 8);
  }
  return words;
}

/// A slice's pixels after decompression: little-endian, each with BitsAllocated bits.
std::string decompressed(const DicomSlice& slice, const std::vector<std::string>& parts) {
  const DicomPixels& pixels = slice.pixels;
  CompressedFrame frame{pixels.transfer_syntax,
                        static_cast<unsigned>(slice.size_px.x),
                        static_cast<unsigned>(slice.size_px.y),
                        pixels.allocated,
                        pixels.stored,
                        pixels.high,
                        pixels.is_signed,
                        {parts.begin(), parts.end()}};
  std::optional<std::string> decoded = decompress(frame);
  if (!decoded)
    refuse(slice.path,
           "pixels in transfer syntax " + pixels.transfer_syntax +
               " cannot be decompressed: the file may be damaged; try to decompress it with another tool");
  return std::move(*decoded);
}

/// The number in the stored bits of a pixel's word, signed if the pixels are.
double value_of(std::uint32_t word, const DicomPixels& pixels) {
  const std::uint32_t mask = pixels.stored == 32 ? 0xffffffffu : (1u << pixels.stored) - 1;
  word = (word >> (pixels.high + 1 - pixels.stored)) & mask;
  const std::uint32_t sign = 1u << (pixels.stored - 1);
  return pixels.is_signed && (word & sign) != 0 ? static_cast<double>(word) - static_cast<double>(mask) - 1.0
                                                : static_cast<double>(word);
}

/// Whether a pixel's word has bits set outside its stored bits, other than copies of its sign.
bool has_foreign_bits(std::uint32_t word, const DicomPixels& pixels) {
  const unsigned low = pixels.high + 1 - pixels.stored;
  const std::uint32_t mask = (pixels.stored == 32 ? 0xffffffffu : (1u << pixels.stored) - 1) << low;
  const std::uint32_t whole = pixels.allocated == 32 ? 0xffffffffu : (1u << pixels.allocated) - 1;
  const std::uint32_t others = word & whole & ~mask;
  if (others == 0) return false;
  const bool is_negative = pixels.is_signed && (word >> pixels.high & 1u) != 0;
  const std::uint32_t above = pixels.high == 31 ? 0u : whole & ~((2u << pixels.high) - 1);
  return !(is_negative && others == above);
}

/// The usual CT: 16 bits, little-endian, slope 1, an integer intercept. Rescales the stored words in place.
/// Uses integers so that the compiler vectorises. With a padding mark, values at or below the mark do not
/// fit.
DecodedSlice rescale_shorts(const DicomSlice& slice, int intercept, std::span<std::int16_t> samples,
                            std::optional<std::int16_t> padding_mark) {
  const DicomPixels& pixels = slice.pixels;
  assert(pixels.allocated == 16 && pixels.high < 16 && pixels.stored >= 1 && pixels.stored <= 16);
  const int shift = 15 - static_cast<int>(pixels.high);
  const int drop = 16 - static_cast<int>(pixels.stored);
  int low = std::numeric_limits<int>::max();
  int high = std::numeric_limits<int>::min();
  std::uint32_t foreign = 0;
  const auto outside = static_cast<std::uint16_t>(~(((1u << pixels.stored) - 1) << (drop - shift)));
  const auto run = [&]<typename Word, bool padded>(Word, std::bool_constant<padded>) {
    const int pad_low = padded ? static_cast<int>(std::clamp(slice.padding->low, -1e6, 1e6)) : 0;
    const int pad_high = padded ? static_cast<int>(std::clamp(slice.padding->high, -1e6, 1e6)) : 0;
    const std::int16_t mark = padding_mark.value_or(0);
    for (std::int16_t& sample : samples) {
      const auto word = static_cast<Word>(sample);
      const int stored = static_cast<Word>(static_cast<Word>(word << shift) >> drop);
      // Bits outside the stored bits are harmless if all are zero, or if they are copies of the sign above
      // the stored bits.
      const bool is_plain = (static_cast<std::uint16_t>(sample) & outside) == 0;
      foreign += !is_plain && static_cast<Word>(stored << (drop - shift)) != word;
      const int value = stored + intercept;
      const bool is_padded = padded && stored >= pad_low && stored <= pad_high;
      low = std::min(low, is_padded ? std::numeric_limits<int>::max() : value);
      high = std::max(high, is_padded ? std::numeric_limits<int>::min() : value);
      sample = is_padded ? mark : static_cast<std::int16_t>(value);
    }
  };
  const auto run_word = [&](auto word) {
    if (padding_mark && slice.padding)
      run(word, std::true_type{});
    else
      run(word, std::false_type{});
  };
  if (pixels.is_signed)
    run_word(std::int16_t{});
  else
    run_word(std::uint16_t{});
  const int least = padding_mark ? *padding_mark + 1 : std::numeric_limits<std::int16_t>::min();
  return {low >= least && high <= std::numeric_limits<std::int16_t>::max(), foreign};
}

/// A slope of 0 would map all pixels to one value; it is read as 1.
double slope_of(const DicomSlice& slice) {
  const double slope = slice.slope.value_or(1.0);
  return slope == 0.0 ? 1.0 : slope;
}

bool is_usual(const DicomSlice& slice) {
  const double intercept = slice.intercept.value_or(0.0);
  return std::endian::native == std::endian::little && slice.pixels.allocated == 16 &&
         !slice.pixels.is_big_endian && !slice.lut && slope_of(slice) == 1.0 &&
         intercept == std::trunc(intercept) && std::abs(intercept) < 1e6;
}

/// The value that a stored number has after Modality LUT or rescale.
double meant(double stored, const DicomSlice& slice) {
  if (!slice.lut) return slope_of(slice) * stored + slice.intercept.value_or(0.0);
  const double last = static_cast<double>(slice.lut->values.size() - 1);
  return slice.lut->values[static_cast<std::size_t>(std::clamp(stored - slice.lut->first, 0.0, last))];
}

template <typename Sample>
DecodedSlice rescale(const std::string& stored, const DicomSlice& slice, std::span<Sample> samples,
                     std::optional<Sample> padding_mark) {
  const DicomPixels& pixels = slice.pixels;
  if constexpr (std::is_same_v<Sample, std::int16_t>)
    if (is_usual(slice)) {
      std::memcpy(samples.data(), stored.data(), samples.size_bytes());
      return rescale_shorts(slice, static_cast<int>(slice.intercept.value_or(0.0)), samples, padding_mark);
    }
  const bool is_packed = pixels.allocated == 12;  // unpacked to little-endian words
  const std::size_t width = is_packed ? 2 : pixels.allocated / 8;
  const bool is_big_endian = pixels.is_big_endian && !is_packed;
  assert(stored.size() >= samples.size() * width);
  DecodedSlice decoded;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    std::uint32_t word = 0;
    for (std::size_t byte = 0; byte < width; ++byte) {
      const std::size_t at = i * width + (is_big_endian ? width - 1 - byte : byte);
      word |= std::uint32_t{static_cast<unsigned char>(stored[at])} << (8 * byte);
    }
    decoded.foreign_count += has_foreign_bits(word, pixels);
    const double number = value_of(word, pixels);
    if (padding_mark && slice.padding && number >= slice.padding->low && number <= slice.padding->high) {
      samples[i] = *padding_mark;
      continue;
    }
    const double value = meant(number, slice);
    if (padding_mark && !(value > static_cast<double>(*padding_mark))) decoded.fits = false;
    if constexpr (std::is_same_v<Sample, float>) {
      samples[i] = static_cast<float>(value);
    } else {
      const bool held = value >= std::numeric_limits<Sample>::min() &&
                        value <= std::numeric_limits<Sample>::max() && value == std::trunc(value);
      decoded.fits = decoded.fits && held;
      samples[i] = held ? static_cast<Sample>(value) : Sample{0};
    }
  }
  return decoded;
}

template <typename Sample>
DecodedSlice read_samples(const DicomSlice& slice, std::span<Sample> samples,
                          std::optional<Sample> padding_mark) {
  assert((samples.size() * slice.pixels.allocated + 7) / 8 == frame_bytes(slice));
  try {
    if constexpr (std::is_same_v<Sample, std::int16_t>)
      if (is_usual(slice) && !slice.pixels.is_compressed && !slice.pixels.is_deflated &&
          slice.pixels.parts.size() == 1) {
        const std::size_t at = slice.pixels.parts.front().at;
        PlacedReader(slice).read({at, samples.size_bytes()}, reinterpret_cast<char*>(samples.data()));
        return rescale_shorts(slice, static_cast<int>(slice.intercept.value_or(0.0)), samples, padding_mark);
      }
    std::vector<std::string> parts = stored_parts(slice);
    std::string stored = slice.pixels.is_compressed ? decompressed(slice, parts) : joined(std::move(parts));
    if (stored.size() < frame_bytes(slice)) refuse(slice.path, "the pixels decompress to too few bytes");
    if (slice.pixels.allocated == 12)
      stored = unpacked(std::move(stored), samples.size(), slice.pixels.is_big_endian);
    if (slice.pixels.are_bytes_swapped) swap_bytes(stored);
    return rescale(stored, slice, samples, padding_mark);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    refuse(slice.path, std::string("its pixels cannot be read: ") + error.what(), ErrorCode::Resource);
  }
}

}  // namespace

bool same_pixels(const DicomSlice& a, const DicomSlice& b) {
  if (a.size_px != b.size_px || a.pixels.transfer_syntax != b.pixels.transfer_syntax ||
      a.pixels.allocated != b.pixels.allocated || a.pixels.is_signed != b.pixels.is_signed ||
      a.slope != b.slope || a.intercept != b.intercept || (a.lut != nullptr) != (b.lut != nullptr) ||
      (a.lut && (a.lut->first != b.lut->first || a.lut->values != b.lut->values)))
    return false;
  return stored_parts(a) == stored_parts(b);
}

DecodedSlice read_dicom_samples(const DicomSlice& slice, std::span<std::int16_t> samples,
                                std::optional<std::int16_t> padding_mark) {
  return read_samples(slice, samples, padding_mark);
}

DecodedSlice read_dicom_samples(const DicomSlice& slice, std::span<float> samples,
                                std::optional<float> padding_mark) {
  return read_samples(slice, samples, padding_mark);
}

}  // namespace octotomy::voxel
