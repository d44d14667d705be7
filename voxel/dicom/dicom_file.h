// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace octotomy::voxel {

/// Group and element of a DICOM attribute as one number: (0028,0010) is 0x00280010.
using DicomTag = std::uint32_t;
/// Specific Character Set (0008,0005): the character set of a file's texts.
constexpr DicomTag character_set_tag = 0x00080005;

/// A range of `length` bytes in a file, from offset `at` on.
struct DicomExtent {
  std::size_t at = 0;
  std::size_t length = 0;
};

/// The attributes of a DICOM file at its top level, as views into its bytes: implicit and explicit VR, either
/// byte order (DICOM PS3.5, 7 and 10). items() reads the values inside a sequence. Every length is checked
/// against the file before it is used, and no allocation exceeds the file's size.
class DicomFile {
 public:
  /// Thrown if the bytes from `at` to the end are deflated.
  struct Deflated {
    std::size_t at = 0;
  };
  /// Thrown if the given bytes are only the beginning of a file and end within an attribute that is needed.
  struct NeedsMore {};

  /// Whether a file begins as DICOM files do: with the prefix after 128 bytes, or, as in older files, with an
  /// attribute of group 2 or 8.
  static bool begins(std::string_view head);

  /// `bytes` are a whole file, or its beginning up to the pixels or beyond; they must outlive the object.
  /// `file_bytes` is the file's size. Throws Deflated if the attributes are deflated; the caller inflates
  /// them and sets `inflated`. Throws NeedsMore if `bytes` is too short. Throws Error (Input) with the reason
  /// and without a path, if an attribute ends beyond the file.
  DicomFile(std::string_view bytes, std::size_t file_bytes, bool inflated = false);

  /// The text as stored, in the file's character set, without padding; empty if the attribute is absent.
  std::string text(DicomTag tag) const;
  /// The value as stored, with its padding; empty if the attribute is absent.
  std::string_view value(DicomTag tag) const;
  /// The text in UTF-8. Control characters, and non-ASCII characters in a set that utf8_of() refuses, become
  /// question marks.
  std::string readable_text(DicomTag tag) const;
  std::optional<std::uint16_t> unsigned_short(DicomTag tag) const;
  /// All values of an attribute with two-byte numbers; empty if the attribute is absent.
  std::vector<std::uint16_t> unsigned_shorts(DicomTag tag) const;
  /// The number of bytes in an attribute's value; none if the attribute is absent.
  std::optional<std::size_t> length(DicomTag tag) const;
  /// The numbers of a decimal string; none if the attribute is absent or any value is not a finite number. A
  /// comma is read as a decimal point, because some writers format numbers in the user's language.
  std::optional<std::vector<double>> decimals(DicomTag tag) const;
  std::optional<double> decimal(DicomTag tag) const;
  /// The items of a sequence, each with its attributes and the character set that applies to it; empty if the
  /// sequence is absent. The file's bytes must outlive the returned attributes. Throws Error (Input) if an
  /// item is damaged.
  std::vector<DicomFile> items(DicomTag sequence) const;

  /// Whether a decimal string has a comma in place of a decimal point.
  bool has_decimal_comma(DicomTag tag) const;
  /// The value of an attribute with VR UL, an unsigned four-byte number; none if the attribute is absent.
  std::optional<std::uint32_t> unsigned_long(DicomTag tag) const;
  /// The value of an attribute with VR FD, an eight-byte float; none if the attribute is absent.
  std::optional<double> float_double(DicomTag tag) const;
  bool big_endian() const { return big_endian_; }
  const std::string& transfer_syntax() const { return transfer_syntax_; }
  /// Whether the attributes' value representations are explicit although the transfer syntax states implicit
  /// ones, or the reverse. The attributes are read as they are coded.
  bool contradicts_syntax() const { return contradicts_syntax_; }
  /// The position of uncompressed pixel data; none if there are no pixels or they are compressed.
  std::optional<DicomExtent> raw_pixels() const { return raw_pixels_; }
  /// Whether the header declares uncompressed pixels as two-byte words, VR OW.
  bool has_words_of_pixels() const { return has_words_of_pixels_; }
  /// The fragments of compressed pixels, without the offset table; none if the pixels are not compressed.
  const std::optional<std::vector<DicomExtent>>& fragments() const { return fragments_; }
  /// The offset table, basic or extended: the start of each frame in bytes, counted from the first fragment's
  /// item; empty if the file has no table.
  const std::vector<std::uint64_t>& frame_offsets() const { return frame_offsets_; }
  /// The fragments of each frame of a file with `frames` frames: one fragment per frame if the counts agree,
  /// else divided by the offset table, else by the start-of-image markers. None if no division yields
  /// `frames` frames. Precondition: fragments() has a value.
  std::optional<std::vector<std::vector<DicomExtent>>> frame_fragments(std::size_t frames) const;
  /// Whether a fragment begins a frame of JPEG, JPEG-LS or JPEG 2000, which start with a start-of-image
  /// marker.
  static bool begins_image(std::string_view fragment);
  /// The bytes of a fragment.
  std::string_view at(const DicomExtent& extent) const { return bytes_.substr(extent.at, extent.length); }

 private:
  struct Head {
    DicomTag tag = 0;
    std::uint32_t length = 0;
    bool is_unknown = false;
    bool is_words = false;
    bool is_open() const { return length == 0xffffffffu; }
  };

  /// Reads the attributes of an item, up to the item's end mark or the end of the bytes.
  DicomFile(std::string_view bytes, bool explicit_vr, bool big_endian);

  void walk();
  Head take_head();
  void leave_meta();
  void take_fragments();
  void take_extended_offsets();
  void require(std::size_t length, DicomTag tag) const;
  void require_more() const;
  std::size_t left() const { return bytes_.size() - at_; }
  std::uint32_t u16(std::size_t at) const;
  std::uint32_t u32(std::size_t at) const;

  std::string_view bytes_;
  std::size_t file_bytes_ = 0;
  std::size_t at_ = 0;
  bool inflated_ = false;
  bool is_item_ = false;
  bool explicit_ = false;
  bool contradicts_syntax_ = false;
  bool big_endian_ = false;
  std::string transfer_syntax_;
  std::map<DicomTag, std::string_view> values_;
  std::set<DicomTag> implicit_inside_;  ///< sequences of unknown representation
  std::optional<DicomExtent> raw_pixels_;
  bool has_words_of_pixels_ = false;
  std::optional<std::vector<DicomExtent>> fragments_;
  std::vector<std::uint64_t> frame_offsets_;
};

/// Inflates the deflated attributes of a whole DICOM file. The result can be passed to DicomFile with
/// `inflated` set. Throws as DicomFile does, and Error (Input) without a path, if the deflated bytes are
/// damaged.
std::string whole_dicom(std::string bytes);

}  // namespace octotomy::voxel
