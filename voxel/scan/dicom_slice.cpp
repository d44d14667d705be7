// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/dicom_slice.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <limits>
#include <type_traits>
#include <unistd.h>

#include "voxel/scan/dicom_codec.h"
#include "voxel/scan/identity.h"
#include "voxel/scan/inflate.h"
#include "voxel/space/file_text.h"

namespace octotomy::voxel {

namespace {

constexpr DicomTag shared_groups_tag = 0x52009229;
constexpr DicomTag frame_groups_tag = 0x52009230;

/// Attributes of a slice by tag. A frame's are looked for in its own functional groups, then in the shared
/// ones, then in the file (DICOM PS3.3, C.7.6.16).
class Attributes {
 public:
  explicit Attributes(const DicomFile& file) : file_(&file) {}
  Attributes(const DicomFile& file, const DicomFile* shared, const DicomFile* own) : file_(&file) {
    for (const DicomFile* groups : {own, shared}) {
      if (groups == nullptr) continue;
      for (const DicomTag group :
           {DicomTag{0x00209113}, DicomTag{0x00209116}, DicomTag{0x00289110}, DicomTag{0x00289145},
            DicomTag{0x00209111}, DicomTag{0x00189314}, DicomTag{0x00189325}, DicomTag{0x00189341}})
        for (DicomFile& item : groups->items(group)) groups_.push_back(std::move(item));
    }
  }

  std::string text(DicomTag tag) const {
    return first<std::string>([&](const DicomFile& from) {
             std::string found = from.readable_text(tag);
             return found.empty() ? std::nullopt : std::optional(std::move(found));
           })
        .value_or("");
  }
  std::optional<std::vector<double>> decimals(DicomTag tag) const {
    return first<std::vector<double>>([&](const DicomFile& from) { return from.decimals(tag); });
  }
  std::optional<double> decimal(DicomTag tag) const {
    return first<double>([&](const DicomFile& from) { return from.decimal(tag); });
  }

 private:
  template <typename Value, typename Ask>
  std::optional<Value> first(const Ask& ask) const {
    for (const DicomFile& group : groups_)
      if (std::optional<Value> found = ask(group)) return found;
    return ask(*file_);
  }

  const DicomFile* file_;
  std::vector<DicomFile> groups_;
};

bool is_raw_syntax(const std::string& syntax) {
  return syntax.empty() || syntax == "1.2.840.10008.1.2" || syntax.starts_with("1.2.840.10008.1.2.1") ||
         syntax == "1.2.840.10008.1.2.2";
}

/// How an image's pixels lost values by compression, by its transfer syntax and LossyImageCompression.
std::string lossy_of(const DicomFile& file) {
  const std::string& syntax = file.transfer_syntax();
  std::string how;
  if (syntax == "1.2.840.10008.1.2.4.50" || syntax == "1.2.840.10008.1.2.4.51") how = "JPEG";
  if (syntax == "1.2.840.10008.1.2.4.81") how = "near-lossless JPEG-LS";
  const std::string flag = file.text(0x00282110);
  if (flag == "01" && how.empty())
    how = syntax == "1.2.840.10008.1.2.4.91" ? "JPEG 2000" : "compression before this file was made";
  if (how.empty()) return how;
  if (const std::string ratio = file.readable_text(0x00282112); !ratio.empty()) how += ", ratio " + ratio;
  return how;
}

DicomPixels pixels_of(const DicomFile& file) {
  DicomPixels pixels;
  pixels.transfer_syntax = file.transfer_syntax();
  pixels.allocated = file.unsigned_short(0x00280100).value_or(16);
  pixels.stored = file.unsigned_short(0x00280101).value_or(static_cast<std::uint16_t>(pixels.allocated));
  pixels.high = file.unsigned_short(0x00280102).value_or(static_cast<std::uint16_t>(pixels.stored - 1));
  pixels.is_signed = file.unsigned_short(0x00280103).value_or(0) == 1;
  // Fragments in a syntax without compression are raw pixels in pieces.
  pixels.is_compressed = file.fragments().has_value() && !is_raw_syntax(pixels.transfer_syntax);
  pixels.is_big_endian = file.big_endian() && !pixels.is_compressed;
  return pixels;
}

bool is_sound(const DicomPixels& pixels) {
  const bool is_whole = pixels.allocated == 8 || pixels.allocated == 16 || pixels.allocated == 32;
  const bool is_packed = pixels.allocated == 12 && !pixels.is_compressed;
  return (is_whole || is_packed) && pixels.stored >= 1 && pixels.stored <= pixels.allocated &&
         pixels.high < pixels.allocated && pixels.high + 1 >= pixels.stored;
}

std::size_t frame_bytes(const DicomSlice& slice) {
  return (static_cast<std::size_t>(slice.size_px.x) * static_cast<std::size_t>(slice.size_px.y) *
              slice.pixels.allocated +
          7) /
         8;
}

/// Whether every value that the pixels can hold stays finite in single precision when it is rescaled.
bool is_rescale_finite(const DicomSlice& slice) {
  const double largest_stored = std::ldexp(1.0, static_cast<int>(slice.pixels.stored));
  return std::abs(slice.slope.value_or(1.0)) * largest_stored + std::abs(slice.intercept.value_or(0.0)) <=
         static_cast<double>(std::numeric_limits<float>::max());
}

/// Fills the slice's geometry. Returns the reason if the file has none.
std::optional<NoSlice> take_geometry(const Attributes& attributes, DicomSlice& slice) {
  constexpr auto unusable = NoSlice::Kind::Unusable;
  const auto are_within = [](const std::vector<double>& numbers, double low, double high) {
    return std::all_of(numbers.begin(), numbers.end(), [&](double x) { return x >= low && x <= high; });
  };
  auto position = attributes.decimals(0x00200032);
  auto orientation = attributes.decimals(0x00200037);
  if (!position && !orientation) {
    position = attributes.decimals(0x00200030);
    orientation = attributes.decimals(0x00200035);
    slice.position_of_acr_nema = position && orientation;
  }
  if (!position || position->size() != 3) return NoSlice{"an image without ImagePositionPatient", unusable};
  if (!orientation || orientation->size() != 6)
    return NoSlice{"an image without ImageOrientationPatient", unusable};
  auto spacing = attributes.decimals(0x00280030);
  if (!spacing) {
    spacing = attributes.decimals(0x00181164);
    slice.spacing_at_detector = true;
  }
  if (!spacing || spacing->size() != 2) return NoSlice{"an image without PixelSpacing", unusable};
  if (!are_within(*spacing, 1e-6, 1e6))  // no scanner's or microscope's
    return NoSlice{"an image whose PixelSpacing is not 1e-6 to 1e6 mm", unusable};
  if (!are_within(*position, -1e9, 1e9))  // doubles still part places by 1e-7 mm there
    return NoSlice{"an image whose ImagePositionPatient is beyond 1e9 mm", unusable};
  if (!are_within(*orientation, -1.001, 1.001))  // with the tolerance of the stack's own directions
    return NoSlice{"an image whose ImageOrientationPatient is not two unit vectors", unusable};
  slice.first_mm = {(*position)[0], (*position)[1], (*position)[2]};
  slice.along_row = {(*orientation)[0], (*orientation)[1], (*orientation)[2]};
  slice.along_column = {(*orientation)[3], (*orientation)[4], (*orientation)[5]};
  slice.spacing_mm = {(*spacing)[1], (*spacing)[0]};  // the tag gives the distance of rows first
  slice.thickness_mm = attributes.decimal(0x00180050);
  slice.spacing_tag_mm = attributes.decimal(0x00180088);
  slice.tilt_deg = attributes.decimal(0x00181120);
  return std::nullopt;
}

/// Whether a fragment begins a frame of JPEG, JPEG-LS or JPEG 2000: by its start-of-image marker.
bool begins_image(std::string_view fragment) {
  return fragment.size() >= 4 && fragment[0] == '\xff' &&
         ((fragment[1] == '\xd8' && fragment[2] == '\xff') ||
          (fragment[1] == '\x4f' && fragment[2] == '\xff'));
}

/// The fragments of each frame: one for each, or by the offset table, or by the fragments' start-of-image
/// markers. None if no way fits.
std::optional<std::vector<std::vector<DicomExtent>>> fragments_by_frame(const DicomFile& file,
                                                                        std::size_t frames) {
  const std::vector<DicomExtent>& fragments = *file.fragments();
  std::vector<std::vector<DicomExtent>> parts(frames);
  if (frames == 1) {
    parts[0] = fragments;
    return parts;
  }
  if (fragments.size() == frames) {
    for (std::size_t i = 0; i < frames; ++i) parts[i] = {fragments[i]};
    return parts;
  }
  if (fragments.empty()) return std::nullopt;
  const std::vector<std::uint64_t>& offsets = file.frame_offsets();
  if (offsets.size() == frames) {
    // Offsets count from the first fragment's item, eight bytes before its value.
    std::size_t frame = 0;
    for (const DicomExtent& fragment : fragments) {
      const std::size_t offset = fragment.at - fragments.front().at;
      while (frame + 1 < frames && offset >= offsets[frame + 1]) ++frame;
      parts[frame].push_back(fragment);
    }
    return parts;
  }
  std::size_t begun = 0;
  for (const DicomExtent& fragment : fragments) {
    if (begins_image(file.at(fragment))) ++begun;
    if (begun == 0 || begun > frames) return std::nullopt;
    parts[begun - 1].push_back(fragment);
  }
  return begun == frames ? std::optional(parts) : std::nullopt;
}

/// The bytes from `from` on, `length` of them, of raw pixels in pieces.
std::vector<DicomExtent> cut_out(const std::vector<DicomExtent>& pieces, std::size_t from,
                                 std::size_t length) {
  std::vector<DicomExtent> cut;
  for (const DicomExtent& piece : pieces) {
    if (from < piece.length && length > 0) {
      cut.push_back({piece.at + from, std::min(piece.length - from, length)});
      length -= cut.back().length;
      from = 0;
    } else {
      from -= std::min(from, piece.length);
    }
  }
  return cut;
}

/// Fills the pixels of `slices`, the frames of a file. Returns the reason if they cannot be grey frames.
std::optional<NoSlice> take_pixels(const DicomFile& file, std::vector<DicomSlice>& slices) {
  const std::size_t needed = frame_bytes(slices.front());
  const std::size_t frames = slices.size();
  if (!file.raw_pixels() && !file.fragments())
    return NoSlice{"DICOM without pixels", NoSlice::Kind::Unusable};
  if (!slices.front().pixels.is_compressed) {
    const std::vector<DicomExtent> pieces =
        file.raw_pixels() ? std::vector{*file.raw_pixels()} : *file.fragments();
    std::size_t held = 0;
    for (const DicomExtent& piece : pieces) held += piece.length;
    if (held / frames < needed)
      return NoSlice{
          "cut short: " + std::to_string(held) + " bytes of pixels of " + std::to_string(needed * frames),
          NoSlice::Kind::Damaged};
    if (frames > 1 && slices.front().pixels.allocated == 12 &&
        slices.front().size_px.x * slices.front().size_px.y % 2 != 0)
      return NoSlice{"packed frames that begin within a byte", NoSlice::Kind::Unusable};
    for (std::size_t i = 0; i < frames; ++i) slices[i].pixels.parts = cut_out(pieces, i * needed, needed);
    return std::nullopt;
  }
  auto parts = fragments_by_frame(file, frames);
  if (!parts)
    return NoSlice{"a multi-frame image without the offsets of its frames; decompress it first",
                   NoSlice::Kind::Unusable};
  for (std::size_t i = 0; i < frames; ++i) {
    // Blank pixels compress to almost nothing: any file may hold 4096 x 4096 pixels of two bytes.
    std::size_t held = 0;
    for (const DicomExtent& fragment : (*parts)[i]) held += fragment.length;
    if (needed > std::max(std::size_t{4096} * 4096 * 2, 1100 * held))
      return NoSlice{"claims " + std::to_string(needed) + " bytes of pixels, more than its file can hold",
                     NoSlice::Kind::Damaged};
    slices[i].pixels.parts = std::move((*parts)[i]);
  }
  return std::nullopt;
}

/// The part of the header that all frames of a file share.
std::variant<DicomSlice, NoSlice> common_of(const DicomFile& file, const std::filesystem::path& path) {
  if (file.text(0x00020002) == "1.2.840.10008.1.3.10")
    return NoSlice{"a DICOM directory", NoSlice::Kind::Stray, true};
  DicomSlice slice;
  slice.path = path;
  const auto rows = file.unsigned_short(0x00280010);
  const auto columns = file.unsigned_short(0x00280011);
  if (!rows || !columns || *rows == 0 || *columns == 0) return NoSlice{"DICOM without an image"};
  slice.size_px = {*columns, *rows};
  constexpr auto unusable = NoSlice::Kind::Unusable;
  if (file.unsigned_short(0x00280002).value_or(1) != 1) return NoSlice{"a colour image", unusable};
  const std::string photometric = file.readable_text(0x00280004);
  if (!photometric.empty() && !photometric.starts_with("MONOCHROME"))
    return NoSlice{"pixels in " + photometric + ", which are no measurements", unusable};
  slice.pixels = pixels_of(file);
  if (!is_sound(slice.pixels))
    return NoSlice{"pixels of " + std::to_string(slice.pixels.allocated) + " bits", unusable};
  slice.inverted = photometric == "MONOCHROME1";
  slice.lossy = lossy_of(file);
  slice.class_uid = file.text(0x00080016);
  slice.instance_uid = file.text(0x00080018);
  slice.series_uid = file.text(0x0020000e);
  slice.series_description = file.readable_text(0x0008103e);
  slice.modality = file.readable_text(0x00080060);
  slice.identity = identity_of(file);
  const auto number = [&](DicomTag tag) {
    const double value = file.decimal(tag).value_or(0.0);
    return std::abs(value) < 1e9 ? static_cast<int>(value) : 0;
  };
  slice.series_number = number(0x00200011);
  slice.instance_number = number(0x00200013);
  return slice;
}

/// Fills the part of the header that may differ between frames. Returns the reason if geometry is missing.
std::optional<NoSlice> take_frame(const DicomFile& file, const Attributes& attributes, DicomSlice& slice) {
  if (auto flaw = take_geometry(attributes, slice)) return flaw;
  slice.rescale_type = attributes.text(0x00281054);
  slice.intercept = attributes.decimal(0x00281052);
  slice.slope = attributes.decimal(0x00281053);
  if (!is_rescale_finite(slice))
    return NoSlice{"values that RescaleSlope takes beyond single precision", NoSlice::Kind::Unusable};
  for (std::size_t i = 0; i < dicom_traits.size(); ++i)
    for (const DicomTag tag : dicom_traits[i].tags)
      if (tag != 0 && slice.traits[i].empty()) slice.traits[i] = attributes.text(tag);
  slice.is_localizer = file.text(0x00080008).find("LOCALIZER") != std::string::npos;
  if (const auto padding = file.unsigned_short(0x00280120)) {
    const double stored = slice.pixels.is_signed ? static_cast<double>(static_cast<std::int16_t>(*padding))
                                                 : static_cast<double>(*padding);
    slice.padding = slice.slope.value_or(1.0) * stored + slice.intercept.value_or(0.0);
  }
  return std::nullopt;
}

std::variant<std::vector<DicomSlice>, NoSlice> slices_of(const DicomFile& file,
                                                         const std::filesystem::path& path) {
  std::variant<DicomSlice, NoSlice> common = common_of(file, path);
  if (NoSlice* flaw = std::get_if<NoSlice>(&common)) return std::move(*flaw);
  const double claimed = file.decimal(0x00280008).value_or(1.0);
  // The items, each of at least eight bytes, bound the number of frames that a damaged count can claim.
  const std::vector<DicomFile> own = file.items(frame_groups_tag);
  const std::vector<DicomFile> shared = file.items(shared_groups_tag);
  if (claimed > 1.0 && static_cast<double>(own.size()) != claimed)
    return NoSlice{"a multi-frame image without the positions of its frames; export it as single frames",
                   NoSlice::Kind::Unusable};
  std::vector<DicomSlice> slices(std::max<std::size_t>(own.size(), 1), std::get<DicomSlice>(common));
  for (std::size_t i = 0; i < slices.size(); ++i) {
    const Attributes attributes(file, shared.empty() ? nullptr : &shared.front(),
                                own.empty() ? nullptr : &own[i]);
    slices[i].frame = static_cast<int>(i);
    if (slices.size() > 1) slices[i].instance_uid.append("#").append(std::to_string(i + 1));
    if (auto flaw = take_frame(file, attributes, slices[i])) return std::move(*flaw);
  }
  if (auto flaw = take_pixels(file, slices)) return std::move(*flaw);
  return slices;
}

/// The first `count` bytes of a file, or all of them.
std::string beginning_of(const std::filesystem::path& path, std::size_t count) {
  std::ifstream in = opened(path);
  std::string bytes(count, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return bytes;
}

/// A deflated file whose bytes from `at` on are inflated.
std::string inflated(const std::string& bytes, std::size_t at) {
  return bytes.substr(0, at) + inflate_raw(std::string_view(bytes).substr(at));
}

/// An open file, read at offsets.
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

/// The parts of a slice's pixels as stored.
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

/// All parts of raw pixels behind each other.
std::string joined(std::vector<std::string> parts) {
  for (std::size_t i = 1; i < parts.size(); ++i) parts.front() += parts[i];
  return std::move(parts.front());
}

/// Pixels of 12 bits, two in three bytes, as words of 16 bits. The first pixel has the lower bits (DICOM
/// PS3.5, 8.1.1); big-endian files store 16-bit words, whose bytes are exchanged.
std::string unpacked(std::string packed, std::size_t count, bool big_endian) {
  if (packed.size() % 2 != 0) packed += '\0';
  if (big_endian)
    for (std::size_t i = 0; i < packed.size(); i += 2) std::swap(packed[i], packed[i + 1]);
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

/// Decompressed pixels, little-endian, in the bits allocated.
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
               " cannot be decompressed: the file is damaged, or decompress it with another tool");
  return std::move(*decoded);
}

/// The value in the stored bits of a pixel's word.
double value_of(std::uint32_t word, const DicomPixels& pixels) {
  const std::uint32_t mask = pixels.stored == 32 ? 0xffffffffu : (1u << pixels.stored) - 1;
  word = (word >> (pixels.high + 1 - pixels.stored)) & mask;
  const std::uint32_t sign = 1u << (pixels.stored - 1);
  return pixels.is_signed && (word & sign) != 0 ? static_cast<double>(word) - static_cast<double>(mask) - 1.0
                                                : static_cast<double>(word);
}

/// The usual CT: 16 bits, little-endian, slope 1, an integer intercept. Rescales the stored words in place,
/// in integers so that the compiler vectorises. False if a value leaves int16's range.
bool rescale_shorts(const DicomPixels& pixels, int intercept, std::span<std::int16_t> samples) {
  assert(pixels.allocated == 16 && pixels.high < 16 && pixels.stored >= 1 && pixels.stored <= 16);
  const int shift = 15 - static_cast<int>(pixels.high);
  const int drop = 16 - static_cast<int>(pixels.stored);
  int low = std::numeric_limits<int>::max();
  int high = std::numeric_limits<int>::min();
  const auto run = [&]<typename Word>(Word) {
    for (std::int16_t& sample : samples) {
      const auto word = static_cast<Word>(sample);
      const int value = static_cast<Word>(static_cast<Word>(word << shift) >> drop) + intercept;
      low = std::min(low, value);
      high = std::max(high, value);
      sample = static_cast<std::int16_t>(value);
    }
  };
  if (pixels.is_signed)
    run(std::int16_t{});
  else
    run(std::uint16_t{});
  return low >= std::numeric_limits<std::int16_t>::min() && high <= std::numeric_limits<std::int16_t>::max();
}

/// A slope of 0 would leave one value: it is taken for 1.
double slope_of(const DicomSlice& slice) {
  const double slope = slice.slope.value_or(1.0);
  return slope == 0.0 ? 1.0 : slope;
}

bool is_usual(const DicomSlice& slice) {
  const double intercept = slice.intercept.value_or(0.0);
  return std::endian::native == std::endian::little && slice.pixels.allocated == 16 &&
         !slice.pixels.is_big_endian && slope_of(slice) == 1.0 && intercept == std::trunc(intercept) &&
         std::abs(intercept) < 1e6;
}

template <typename Sample>
bool rescale(const std::string& stored, const DicomSlice& slice, std::span<Sample> samples) {
  const DicomPixels& pixels = slice.pixels;
  const double slope = slope_of(slice);
  const double intercept = slice.intercept.value_or(0.0);
  if constexpr (std::is_same_v<Sample, std::int16_t>)
    if (is_usual(slice)) {
      std::memcpy(samples.data(), stored.data(), samples.size_bytes());
      return rescale_shorts(pixels, static_cast<int>(intercept), samples);
    }
  const bool is_packed = pixels.allocated == 12;  // unpacked to little-endian words
  const std::size_t width = is_packed ? 2 : pixels.allocated / 8;
  const bool is_big_endian = pixels.is_big_endian && !is_packed;
  assert(stored.size() >= samples.size() * width);
  bool fits = true;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    std::uint32_t word = 0;
    for (std::size_t byte = 0; byte < width; ++byte) {
      const std::size_t at = i * width + (is_big_endian ? width - 1 - byte : byte);
      word |= std::uint32_t{static_cast<unsigned char>(stored[at])} << (8 * byte);
    }
    const double value = slope * value_of(word, pixels) + intercept;
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
}

template <typename Sample>
bool read_samples(const DicomSlice& slice, std::span<Sample> samples) {
  assert((samples.size() * slice.pixels.allocated + 7) / 8 == frame_bytes(slice));
  try {
    if constexpr (std::is_same_v<Sample, std::int16_t>)
      if (is_usual(slice) && !slice.pixels.is_compressed && !slice.pixels.is_deflated &&
          slice.pixels.parts.size() == 1) {
        const std::size_t at = slice.pixels.parts.front().at;
        PlacedReader(slice).read({at, samples.size_bytes()}, reinterpret_cast<char*>(samples.data()));
        return rescale_shorts(slice.pixels, static_cast<int>(slice.intercept.value_or(0.0)), samples);
      }
    std::vector<std::string> parts = stored_parts(slice);
    std::string stored = slice.pixels.is_compressed ? decompressed(slice, parts) : joined(std::move(parts));
    if (stored.size() < frame_bytes(slice)) refuse(slice.path, "the pixels decompress to too few bytes");
    if (slice.pixels.allocated == 12)
      stored = unpacked(std::move(stored), samples.size(), slice.pixels.is_big_endian);
    return rescale(stored, slice, samples);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    refuse(slice.path, std::string("its pixels cannot be read: ") + error.what(), ErrorCode::Resource);
  }
}

/// The slices of a file that begins with `bytes`; reads the whole file if these end within the attributes.
std::variant<std::vector<DicomSlice>, NoSlice> slices_of(std::string bytes, std::size_t file_bytes,
                                                         const std::filesystem::path& path) {
  try {
    return slices_of(DicomFile(bytes, file_bytes), path);
  } catch (const DicomFile::NeedsMore&) {
    bytes = beginning_of(path, file_bytes);
    return slices_of(DicomFile(bytes, bytes.size()), path);
  }
}

}  // namespace

std::variant<std::vector<DicomSlice>, NoSlice> read_dicom_slices(const std::filesystem::path& path) {
  // Attributes take some kilobytes; the pixels after them are not needed yet.
  constexpr std::size_t most_attributes = std::size_t{1} << 15;
  std::string bytes = beginning_of(path, most_attributes);
  if (!DicomFile::begins(bytes)) return NoSlice{"not DICOM"};
  try {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    const std::size_t file_bytes = error ? bytes.size() : std::max<std::size_t>(size, bytes.size());
    try {
      return slices_of(bytes, file_bytes, path);
    } catch (const DicomFile::Deflated& from) {
      const std::string whole = inflated(beginning_of(path, file_bytes), from.at);
      auto slices = slices_of(DicomFile(whole, whole.size(), true), path);
      if (auto* found = std::get_if<std::vector<DicomSlice>>(&slices))
        for (DicomSlice& slice : *found) slice.pixels.is_deflated = true;
      return slices;
    }
  } catch (const DicomFile::NeedsMore&) {
    return NoSlice{"changed while it was read"};
  } catch (const Error& error) {
    // Without DICOM's prefix, a file that cannot be walked through may be of any kind.
    const bool has_prefix = bytes.size() >= 132 && bytes.compare(128, 4, "DICM") == 0;
    return NoSlice{error.what(), has_prefix ? NoSlice::Kind::Damaged : NoSlice::Kind::Stray};
  }
}

bool same_pixels(const DicomSlice& a, const DicomSlice& b) {
  if (a.size_px != b.size_px || a.pixels.transfer_syntax != b.pixels.transfer_syntax ||
      a.pixels.allocated != b.pixels.allocated || a.pixels.is_signed != b.pixels.is_signed ||
      a.slope != b.slope || a.intercept != b.intercept)
    return false;
  return stored_parts(a) == stored_parts(b);
}

bool read_dicom_samples(const DicomSlice& slice, std::span<std::int16_t> samples) {
  return read_samples(slice, samples);
}

bool read_dicom_samples(const DicomSlice& slice, std::span<float> samples) {
  return read_samples(slice, samples);
}

}  // namespace octotomy::voxel
