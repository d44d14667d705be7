// SPDX-License-Identifier: AGPL-3.0-or-later
//
// This reader parses headers itself and uses GDCM only to decompress pixels: on some damaged headers GDCM
// aborts the program (its Debian build has assertions enabled), and it allocates as many bytes as an
// attribute claims.
#include "voxel/dicom/dicom_file.h"

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "voxel/dicom/character_set.h"
#include "voxel/dicom/inflate.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {

namespace {

constexpr DicomTag item_tag = 0xfffee000;
constexpr DicomTag item_end_tag = 0xfffee00d;
constexpr DicomTag sequence_end_tag = 0xfffee0dd;
constexpr DicomTag transfer_syntax_tag = 0x00020010;
constexpr DicomTag pixels_tag = 0x7fe00010;

bool has_prefix(std::string_view bytes) {
  return bytes.size() >= 132 && bytes.substr(128, 4) == "DICM";
}

/// Whether the first attribute states its value representation, two capital letters. With implicit VR the
/// same bytes belong to a length, which would then be more than 16 kilobytes; no first attribute is that
/// long.
bool spells_vr(std::string_view bytes) {
  const auto is_capital = [&](std::size_t i) { return bytes[i] >= 'A' && bytes[i] <= 'Z'; };
  return bytes.size() >= 8 && is_capital(4) && is_capital(5);
}

/// Whether the length of values with this representation takes four bytes instead of two.
bool is_wide(std::string_view vr) {
  constexpr std::array<std::string_view, 13> wide = {"OB", "OD", "OF", "OL", "OV", "OW", "SQ",
                                                     "SV", "UC", "UN", "UR", "UT", "UV"};
  for (const std::string_view one : wide)
    if (vr == one) return true;
  return false;
}

/// Whether a transfer syntax is absent, as in old files, or one of DICOM's. All of DICOM's are explicit and
/// little-endian except those that leave_meta() lists.
bool is_readable_syntax(std::string_view syntax) {
  return syntax.empty() || syntax.starts_with("1.2.840.10008.1.2");
}

bool begins_little_endian_item(std::string_view bytes) {
  return bytes.starts_with(std::string_view("\xfe\xff\x00\xe0", 4));
}

std::string unpadded(std::string_view text) {
  constexpr std::string_view padding(" \t\r\n\0", 5);
  const std::size_t first = text.find_first_not_of(padding);
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(padding) - first + 1));
}

}  // namespace

bool DicomFile::begins(std::string_view head) {
  if (has_prefix(head)) return true;
  return head.size() >= 8 && (head[0] == 2 || head[0] == 8) && head[1] == 0 && head[3] == 0;
}

DicomFile::DicomFile(std::string_view bytes, std::size_t file_bytes, bool inflated)
    : bytes_(bytes),
      file_bytes_(file_bytes),
      at_(has_prefix(bytes) ? 132 : 0),
      inflated_(inflated),
      explicit_(at_ > 0 || spells_vr(bytes)) {
  walk();
}

DicomFile::DicomFile(std::string_view bytes, bool explicit_vr, bool big_endian)
    : bytes_(bytes),
      file_bytes_(bytes.size()),
      is_item_(true),
      explicit_(explicit_vr),
      big_endian_(big_endian) {
  walk();
}

std::uint32_t DicomFile::u16(std::size_t at) const {
  const auto u8 = [&](std::size_t i) { return std::uint32_t{static_cast<unsigned char>(bytes_[i])}; };
  return big_endian_ ? (u8(at) << 8) | u8(at + 1) : u8(at) | (u8(at + 1) << 8);
}

std::uint32_t DicomFile::u32(std::size_t at) const {
  return big_endian_ ? (u16(at) << 16) | u16(at + 2) : u16(at) | (u16(at + 2) << 16);
}

void DicomFile::require(std::size_t length, DicomTag tag) const {
  if (length <= left()) return;
  if (length <= file_bytes_ - at_) throw NeedsMore{};
  if (!is_readable_syntax(transfer_syntax_))
    throw Error(ErrorCode::Input,
                "is in the transfer syntax " + transfer_syntax_ +
                    ", which octotomy cannot read: convert it, for example by gdcmconv --raw");
  std::array<char, 112> text{};
  std::snprintf(text.data(), text.size(),
                "cut short or damaged: attribute (%04x,%04x) claims %zu bytes, %zu are left", tag >> 16,
                tag & 0xffffu, length, file_bytes_ - at_);
  throw Error(ErrorCode::Input, text.data());
}

/// Called if fewer bytes are left than an attribute takes. Throws NeedsMore if the file has more bytes.
void DicomFile::require_more() const {
  if (bytes_.size() < file_bytes_) throw NeedsMore{};
}

void DicomFile::leave_meta() {
  transfer_syntax_ = text(transfer_syntax_tag);
  const bool is_implicit = transfer_syntax_ == "1.2.840.10008.1.2";
  const bool is_deflated = transfer_syntax_ == "1.2.840.10008.1.2.1.99" && !inflated_;
  // Some tools change the stated syntax but not the attributes. The attributes' coding is therefore
  // determined from the attributes themselves.
  explicit_ = left() >= 8 && !is_deflated ? spells_vr(bytes_.substr(at_)) : !is_implicit;
  contradicts_syntax_ = explicit_ == is_implicit;
  if (transfer_syntax_ == "1.2.840.10008.1.2.2") big_endian_ = true;
  if (is_deflated) throw Deflated{at_};
}

/// Reads the head of the current attribute and moves past it. Precondition: eight bytes are left.
DicomFile::Head DicomFile::take_head() {
  Head head;
  head.tag = (u16(at_) << 16) | u16(at_ + 2);
  const std::string_view vr = bytes_.substr(at_ + 4, 2);
  const bool is_mark = head.tag >> 16 == 0xfffe;  // items and end marks have no value representation
  if (!explicit_ || is_mark) {
    head.length = u32(at_ + 4);
    at_ += 8;
  } else if (is_wide(vr)) {
    require(12, head.tag);
    head.length = u32(at_ + 8);
    head.is_unknown = vr == "UN";
    head.is_words = vr == "OW";
    at_ += 12;
  } else {
    head.length = u16(at_ + 6);
    at_ += 8;
  }
  return head;
}

/// Reads the Extended Offset Table, (7fe0,0001), with eight bytes per frame (DICOM PS3.3, C.7.6.3).
void DicomFile::take_extended_offsets() {
  const auto found = values_.find(0x7fe00001);
  if (found == values_.end()) return;
  const auto start = static_cast<std::size_t>(found->second.data() - bytes_.data());
  for (std::size_t i = 0; i + 8 <= found->second.size(); i += 8)
    frame_offsets_.push_back(u32(start + i) | std::uint64_t{u32(start + i + 4)} << 32);
}

void DicomFile::take_fragments() {
  fragments_.emplace();
  bool is_offset_table = true;
  while (left() >= 8) {
    const Head head = take_head();
    if (head.tag == sequence_end_tag) return;
    if (head.tag != item_tag)
      throw Error(ErrorCode::Input, "compressed pixels are damaged: an item is missing");
    require(head.length, head.tag);
    if (is_offset_table)
      for (std::size_t i = 0; i + 4 <= head.length; i += 4) frame_offsets_.push_back(u32(at_ + i));
    else
      fragments_->push_back({at_, head.length});
    if (is_offset_table && frame_offsets_.empty()) take_extended_offsets();
    is_offset_table = false;
    at_ += head.length;
  }
  require_more();
  throw Error(ErrorCode::Input, "cut short: the compressed pixels do not end");
}

void DicomFile::walk() {
  // For each open sequence or item of undefined length, the coding of the data set around it.
  struct Coding {
    bool explicit_vr, big_endian;
  };
  std::vector<Coding> outside;
  DicomTag open_tag = 0;       // tag of the outermost open sequence
  std::size_t open_start = 0;  // where its items begin
  bool in_meta = !is_item_ && (at_ > 0 || (left() >= 8 && u16(at_) == 2));
  while (left() >= 8) {
    if (in_meta && u16(at_) != 2) {
      in_meta = false;
      leave_meta();
    }
    const Head head = take_head();
    const bool is_top = outside.empty();
    if (head.tag == item_end_tag || head.tag == sequence_end_tag) {
      if (is_top && is_item_) return;
      if (is_top) continue;
      explicit_ = outside.back().explicit_vr;
      big_endian_ = outside.back().big_endian;
      outside.pop_back();
      if (outside.empty()) values_.emplace(open_tag, bytes_.substr(open_start, at_ - 8 - open_start));
      continue;
    }
    const bool is_pixels = head.tag == pixels_tag && is_top && !is_item_;
    if (is_pixels && head.is_open()) return take_fragments();
    if (is_top && head.is_unknown) implicit_inside_.insert(head.tag);
    if (head.is_open()) {
      if (is_top) {
        open_tag = head.tag;
        open_start = at_;
      }
      outside.push_back({explicit_, big_endian_});
      // PS3.5, 6.2.2: sequences of unknown representation are implicit and little-endian inside. Some writers
      // use the file's byte order instead.
      if (head.is_unknown) {
        explicit_ = false;
        big_endian_ = big_endian_ && !begins_little_endian_item(bytes_.substr(at_));
      }
      continue;
    }
    if (is_pixels && head.length <= file_bytes_ - at_) {
      raw_pixels_ = DicomExtent{at_, head.length};
      has_words_of_pixels_ = head.is_words;
      return;
    }
    require(head.length, head.tag);
    if (is_top) values_.emplace(head.tag, bytes_.substr(at_, head.length));
    at_ += head.length;
  }
  require_more();
}

std::vector<DicomFile> DicomFile::items(DicomTag sequence) const {
  std::vector<DicomFile> found;
  const auto value = values_.find(sequence);
  if (value == values_.end()) return found;
  const bool explicit_vr = explicit_ && !implicit_inside_.contains(sequence);
  // An item's head is coded alike with implicit and with explicit VR.
  DicomFile marks(std::string_view(), explicit_vr, big_endian_);
  marks.bytes_ = value->second;
  marks.big_endian_ = big_endian_ && !begins_little_endian_item(value->second);
  marks.file_bytes_ = marks.bytes_.size();
  const auto character_set = values_.find(character_set_tag);
  while (marks.left() >= 8) {
    const Head head = marks.take_head();
    if (head.tag == sequence_end_tag) break;
    if (head.tag != item_tag) throw Error(ErrorCode::Input, "a sequence is damaged: an item is missing");
    if (!head.is_open()) marks.require(head.length, head.tag);
    const std::size_t length = head.is_open() ? marks.left() : head.length;
    found.push_back(DicomFile(marks.bytes_.substr(marks.at_, length), explicit_vr, marks.big_endian_));
    marks.at_ += head.is_open() ? found.back().at_ : length;
    // An item that states no character set uses the one of the data set around it (PS3.5, 6.1.1).
    if (character_set != values_.end()) found.back().values_.insert(*character_set);
  }
  return found;
}

std::string DicomFile::text(DicomTag tag) const {
  const auto found = values_.find(tag);
  return found == values_.end() ? std::string() : unpadded(found->second);
}

std::string_view DicomFile::value(DicomTag tag) const {
  const auto found = values_.find(tag);
  return found == values_.end() ? std::string_view() : found->second;
}

std::string DicomFile::readable_text(DicomTag tag) const {
  const std::string stored = text(tag);
  const std::optional<std::string> converted = utf8_of(text(character_set_tag), stored);
  std::string readable = converted.value_or(stored);
  for (char& letter : readable) {
    const auto code = static_cast<unsigned char>(letter);
    if (code < 0x20 || code == 0x7f || (code >= 0x80 && !converted)) letter = '?';
  }
  return readable;
}

std::optional<std::uint16_t> DicomFile::unsigned_short(DicomTag tag) const {
  const auto found = values_.find(tag);
  if (found == values_.end() || found->second.size() < 2) return std::nullopt;
  return static_cast<std::uint16_t>(u16(static_cast<std::size_t>(found->second.data() - bytes_.data())));
}

std::vector<std::uint16_t> DicomFile::unsigned_shorts(DicomTag tag) const {
  std::vector<std::uint16_t> numbers;
  const auto found = values_.find(tag);
  if (found == values_.end()) return numbers;
  const auto start = static_cast<std::size_t>(found->second.data() - bytes_.data());
  for (std::size_t i = 0; i + 2 <= found->second.size(); i += 2)
    numbers.push_back(static_cast<std::uint16_t>(u16(start + i)));
  return numbers;
}

std::optional<std::size_t> DicomFile::length(DicomTag tag) const {
  const auto found = values_.find(tag);
  return found == values_.end() ? std::nullopt : std::optional(found->second.size());
}

std::optional<std::uint32_t> DicomFile::unsigned_long(DicomTag tag) const {
  const auto found = values_.find(tag);
  if (found == values_.end() || found->second.size() != 4) return std::nullopt;
  return u32(static_cast<std::size_t>(found->second.data() - bytes_.data()));
}

std::optional<double> DicomFile::float_double(DicomTag tag) const {
  const auto found = values_.find(tag);
  if (found == values_.end() || found->second.size() < 8) return std::nullopt;
  const auto start = static_cast<std::size_t>(found->second.data() - bytes_.data());
  const std::uint64_t first = u32(start), second = u32(start + 4);
  return std::bit_cast<double>(big_endian_ ? first << 32 | second : second << 32 | first);
}

bool DicomFile::has_decimal_comma(DicomTag tag) const {
  return text(tag).find(',') != std::string::npos;
}

std::optional<std::vector<double>> DicomFile::decimals(DicomTag tag) const {
  std::vector<double> numbers;
  std::istringstream parts(text(tag));
  for (std::string part; std::getline(parts, part, '\\');) {
    part = unpadded(part);
    if (part.starts_with('+')) part.erase(0, 1);
    if (const std::size_t comma = part.find(',');
        comma != std::string::npos && part.find('.') == std::string::npos)
      part[comma] = '.';
    double number = 0.0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), number);
    if (error != std::errc() || end != part.data() + part.size() || !std::isfinite(number))
      return std::nullopt;
    numbers.push_back(number);
  }
  if (numbers.empty()) return std::nullopt;
  return numbers;
}

std::optional<double> DicomFile::decimal(DicomTag tag) const {
  const std::optional<std::vector<double>> numbers = decimals(tag);
  return numbers ? std::optional<double>(numbers->front()) : std::nullopt;
}

bool DicomFile::begins_image(std::string_view fragment) {
  return fragment.size() >= 4 && fragment[0] == '\xff' &&
         ((fragment[1] == '\xd8' && fragment[2] == '\xff') ||
          (fragment[1] == '\x4f' && fragment[2] == '\xff'));
}

std::optional<std::vector<std::vector<DicomExtent>>> DicomFile::frame_fragments(std::size_t frames) const {
  const std::vector<DicomExtent>& fragments = *fragments_;
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
  const std::vector<std::uint64_t>& offsets = frame_offsets_;
  if (offsets.size() == frames) {
    // Offsets count from the head of the first fragment's item, eight bytes before the fragment's value.
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
    if (begins_image(at(fragment))) ++begun;
    if (begun == 0 || begun > frames) return std::nullopt;
    parts[begun - 1].push_back(fragment);
  }
  return begun == frames ? std::optional(parts) : std::nullopt;
}

std::string whole_dicom(std::string bytes) {
  try {
    const DicomFile file(bytes, bytes.size());
  } catch (const DicomFile::Deflated& from) {
    return bytes.substr(0, from.at) + inflate_raw(std::string_view(bytes).substr(from.at));
  }
  return bytes;
}

}  // namespace octotomy::voxel
