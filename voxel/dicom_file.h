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

/// Where bytes lie in a file.
struct DicomExtent {
  std::size_t at = 0;
  std::size_t length = 0;
};

/// The attributes of a DICOM file at its top level, as views into its bytes: implicit and explicit VR, either
/// byte order (DICOM PS3.5, 7 and 10). Values inside sequences are stepped over; items() reads them. Every
/// length is checked against the file before it is believed; nothing is allocated that the file does not
/// hold.
class DicomFile {
 public:
  /// The attributes after the file's own are deflated, from there on.
  struct Deflated {
    std::size_t at = 0;
  };
  /// The bytes given end before the attributes do, and the file goes on.
  struct NeedsMore {};

  /// True where a file's first 132 bytes are DICOM's: the prefix, or, in files older than it, an attribute of
  /// group 2 or 8.
  static bool begins(std::string_view head);

  /// `bytes` must outlive the object; they are all of the file's `file_bytes`, or its beginning: pixels as
  /// they stand may lie beyond it. Throws std::runtime_error with the reason, without a path, where
  /// attributes end beyond the file; Deflated unless `inflated` says that the bytes are inflated already;
  /// NeedsMore.
  DicomFile(std::string_view bytes, std::size_t file_bytes, bool inflated = false);

  /// Without padding; empty where the attribute is absent. As stored, in the file's character set.
  std::string text(DicomTag tag) const;
  /// As UTF-8: Latin-1 is converted, and beyond it what is not ASCII becomes a question mark.
  std::string readable_text(DicomTag tag) const;
  std::optional<std::uint16_t> unsigned_short(DicomTag tag) const;
  /// Decimal strings; none where absent or one of them is no finite number.
  std::optional<std::vector<double>> decimals(DicomTag tag) const;
  std::optional<double> decimal(DicomTag tag) const;
  /// The items of a sequence, each with attributes of its own; none where it is absent. They live no longer
  /// than the bytes. Throws std::runtime_error where an item is damaged.
  std::vector<DicomFile> items(DicomTag sequence) const;

  bool big_endian() const { return big_endian_; }
  const std::string& transfer_syntax() const { return transfer_syntax_; }
  /// Pixel data as they stand; none where the file has none or they are compressed.
  std::optional<DicomExtent> raw_pixels() const { return raw_pixels_; }
  /// Fragments of compressed pixels, the offset table left out; none where they are raw.
  const std::optional<std::vector<DicomExtent>>& fragments() const { return fragments_; }
  /// Where frames begin, from the first fragment's item on; empty where the file does not say.
  const std::vector<std::uint32_t>& frame_offsets() const { return frame_offsets_; }

 private:
  struct Head {
    DicomTag tag = 0;
    std::uint32_t length = 0;
    bool is_unknown = false;
    bool is_open() const { return length == 0xffffffffu; }
  };

  /// An item's attributes: up to its end mark, or the bytes' end.
  DicomFile(std::string_view bytes, bool explicit_vr, bool big_endian);

  void walk();
  Head take_head();
  void leave_meta();
  void take_fragments();
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
  bool big_endian_ = false;
  std::string transfer_syntax_;
  std::map<DicomTag, std::string_view> values_;
  std::set<DicomTag> implicit_inside_;  ///< sequences of unknown representation
  std::optional<DicomExtent> raw_pixels_;
  std::optional<std::vector<DicomExtent>> fragments_;
  std::vector<std::uint32_t> frame_offsets_;
};

}  // namespace octotomy::voxel
