// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/dicom/dicom_pixel_parts.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "voxel/space/printed.h"

namespace octotomy::voxel {
namespace {

bool is_raw_syntax(const std::string& syntax) {
  return syntax.empty() || syntax == "1.2.840.10008.1.2" || syntax.starts_with("1.2.840.10008.1.2.1") ||
         syntax == "1.2.840.10008.1.2.2";
}

/// The number of images that begin in the fragments: the larger one of the counts by the offset table and by
/// start-of-image markers. With RLE each fragment is an image.
std::size_t images_begun(const DicomFile& file) {
  const std::vector<DicomExtent>& fragments = *file.fragments();
  if (file.transfer_syntax() == "1.2.840.10008.1.2.5") return fragments.size();
  const auto begun = std::count_if(fragments.begin(), fragments.end(), [&](const DicomExtent& fragment) {
    return DicomFile::begins_image(file.at(fragment));
  });
  return std::max(file.frame_offsets().size(), static_cast<std::size_t>(begun));
}

/// The extents of `length` bytes of raw pixels, starting at byte `from` of the joined pieces.
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

/// The reason why this program cannot decode the pixels' transfer syntax; none if it can.
std::optional<NoSlice> unknown_syntax(const DicomFile& file, const DicomPixels& pixels) {
  const std::string& syntax = pixels.transfer_syntax;
  constexpr std::array<std::string_view, 9> codecs = {
      "1.2.840.10008.1.2.4.50", "1.2.840.10008.1.2.4.51", "1.2.840.10008.1.2.4.57",
      "1.2.840.10008.1.2.4.70", "1.2.840.10008.1.2.4.80", "1.2.840.10008.1.2.4.81",
      "1.2.840.10008.1.2.4.90", "1.2.840.10008.1.2.4.91", "1.2.840.10008.1.2.5"};
  if (is_raw_syntax(syntax) || std::find(codecs.begin(), codecs.end(), syntax) != codecs.end())
    return std::nullopt;
  // Raw pixels with the transfer syntax of a compression: a tool has decompressed them but not changed the
  // syntax.
  if (!pixels.is_compressed && file.raw_pixels() && syntax.starts_with("1.2.840.10008.1.2"))
    return std::nullopt;
  return NoSlice{"pixels in transfer syntax " + syntax +
                     ", which octotomy cannot decode: convert the file, for example by gdcmconv --raw",
                 NoSlice::Kind::Unusable};
}

/// Records pixel data beyond those of the images that the header states. One surplus byte is allowed, because
/// writers pad an odd number of bytes.
void note_excess(std::size_t held, std::size_t needed, std::vector<DicomSlice>& slices) {
  const std::size_t excess = held - needed * slices.size();
  if (excess <= 1) return;
  const std::size_t more = excess / needed;
  slices.front().excess_pixels =
      more > 0
          ? print("pixels of %zu images, of which the header counts %zu", more + slices.size(), slices.size())
          : print("%zu more bytes of pixels than Rows, Columns and BitsAllocated require", excess);
}

}  // namespace

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
  const auto stored = file.unsigned_short(0x00280101), high = file.unsigned_short(0x00280102);
  // If one of BitsStored and HighBit is absent, it is computed from the other one, because values then begin
  // at bit 0.
  pixels.stored = stored ? *stored : high ? *high + 1u : pixels.allocated;
  pixels.high = high ? *high : pixels.stored - 1;
  const auto representation = file.unsigned_short(0x00280103);
  pixels.is_signed = representation == 1;
  pixels.states_sign = representation.has_value();
  for (DicomTag group = 0x60000000; group < 0x60200000; group += 0x00020000)
    pixels.holds_overlay = pixels.holds_overlay || (file.unsigned_short(group + 0x0102).value_or(0) != 0 &&
                                                    !file.length(group + 0x3000));
  // If the transfer syntax is uncompressed, the fragments are pieces of raw pixels.
  pixels.is_compressed = file.fragments().has_value() && !is_raw_syntax(pixels.transfer_syntax);
  pixels.is_big_endian = file.big_endian() && !pixels.is_compressed;
  pixels.are_bytes_swapped = pixels.is_big_endian && pixels.allocated == 8 && file.has_words_of_pixels();
  return pixels;
}

bool is_sound(const DicomPixels& pixels) {
  const bool is_whole = pixels.allocated == 8 || pixels.allocated == 16 || pixels.allocated == 32;
  const bool is_packed = pixels.allocated == 12 && !pixels.is_compressed;
  return (is_whole || is_packed) && pixels.stored >= 1 && pixels.stored <= pixels.allocated &&
         pixels.high < pixels.allocated && pixels.high + 1 >= pixels.stored;
}

std::size_t most_frames(const DicomFile& file, const DicomSlice& slice) {
  if (file.fragments() && slice.pixels.is_compressed) return file.fragments()->size();
  std::size_t held = file.raw_pixels() ? file.raw_pixels()->length : 0;
  if (file.fragments())
    for (const DicomExtent& piece : *file.fragments()) held += piece.length;
  return held / std::max<std::size_t>(frame_bytes(slice), 1);
}

std::optional<NoSlice> take_pixels(const DicomFile& file, std::vector<DicomSlice>& slices) {
  const std::size_t needed = frame_bytes(slices.front());
  const std::size_t frames = slices.size();
  if (!file.raw_pixels() && !file.fragments())
    return NoSlice{"DICOM without pixels", NoSlice::Kind::Unusable};
  if (auto flaw = unknown_syntax(file, slices.front().pixels)) return flaw;
  if (!slices.front().pixels.is_compressed) {
    const std::vector<DicomExtent> pieces =
        file.raw_pixels() ? std::vector{*file.raw_pixels()} : *file.fragments();
    std::size_t held = 0;
    for (const DicomExtent& piece : pieces) held += piece.length;
    if (held / frames < needed)
      return NoSlice{"cut short: " + std::to_string(held) + " bytes of pixels of " +
                         std::to_string(needed * frames) +
                         (is_raw_syntax(slices.front().pixels.transfer_syntax)
                              ? std::string()
                              : "; or they are compressed, as transfer syntax " +
                                    slices.front().pixels.transfer_syntax + " states, but not in fragments"),
                     NoSlice::Kind::Damaged};
    note_excess(held, needed, slices);
    const bool is_odd = slices.front().size_px.x * slices.front().size_px.y % 2 != 0;
    const bool swaps = slices.front().pixels.are_bytes_swapped;
    if (frames > 1 && is_odd && (slices.front().pixels.allocated == 12 || swaps))
      return NoSlice{"packed frames that do not begin at whole bytes or words; export them as single frames",
                     NoSlice::Kind::Unusable};
    // In a file with swapped bytes and an odd number of pixels, the last word contains a byte of padding
    // before the last pixel.
    const std::size_t taken = std::min(held, needed + (swaps && is_odd ? 1 : 0));
    for (std::size_t i = 0; i < frames; ++i) slices[i].pixels.parts = cut_out(pieces, i * needed, taken);
    return std::nullopt;
  }
  const std::size_t images = std::max(images_begun(file), frames);
  auto parts = file.frame_fragments(images);
  if (parts && images > frames)
    slices.front().excess_pixels =
        print("pixels of %zu images, of which the header counts %zu", images, frames);
  if (!parts)
    return NoSlice{"a multi-frame image without the offsets of its frames; decompress it first",
                   NoSlice::Kind::Unusable};
  for (std::size_t i = 0; i < frames; ++i) {
    // Blank pixels compress to almost nothing, so a file of any size may hold 4096 x 4096 pixels of two
    // bytes.
    std::size_t held = 0;
    for (const DicomExtent& fragment : (*parts)[i]) held += fragment.length;
    if (needed > std::max(std::size_t{4096} * 4096 * 2, 1100 * held))
      return NoSlice{"claims " + std::to_string(needed) + " bytes of pixels, more than its file can hold",
                     NoSlice::Kind::Damaged};
    slices[i].pixels.parts = std::move((*parts)[i]);
  }
  return std::nullopt;
}

}  // namespace octotomy::voxel
