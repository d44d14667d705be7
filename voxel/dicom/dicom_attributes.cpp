// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/dicom/dicom_attributes.h"

#include <bit>
#include <cassert>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "voxel/space/error.h"
#include "voxel/space/write_failure.h"

namespace octotomy::voxel {
namespace {

static_assert(std::endian::native == std::endian::little, "values are written as they stand in memory");

template <typename Number>
std::string bytes_of(Number number, std::size_t width = sizeof(Number)) {
  return {reinterpret_cast<const char*>(&number), width};
}

}  // namespace

std::string dicom_decimal(double number) {
  char text[40];
  for (int digits = 17; digits > 0; --digits) {
    std::snprintf(text, sizeof text, "%.*g", digits, number);
    if (std::strlen(text) <= 16) break;
  }
  return text;
}

std::string dicom_decimals(const glm::dvec3& p) {
  return dicom_decimal(p.x) + "\\" + dicom_decimal(p.y) + "\\" + dicom_decimal(p.z);
}

void check_dicom_text(const std::string& text, const char* name) {
  if (text.size() > 64 || text.find('\\') != std::string::npos)
    throw InvalidInput(std::string(name) + " '" + text +
                       "' must have at most 64 characters and no backslash");
}

void DicomDigest::add(const void* bytes, std::size_t count) {
  constexpr std::uint64_t prime = 0x100000001b3;
  const auto* byte = static_cast<const unsigned char*>(bytes);
  for (std::size_t i = 0; i < count; ++i) {
    high_ = (high_ ^ byte[i]) * prime;
    low_ = (low_ ^ byte[i]) * prime;
    low_ ^= low_ >> 29;  // makes this sum differ from the other one
  }
}

std::string DicomDigest::uid() const {
  __extension__ using Wide = unsigned __int128;
  const std::uint64_t high = (high_ & ~std::uint64_t{0xf000}) | 0x8000;
  const std::uint64_t low = (low_ & ~(std::uint64_t{3} << 62)) | (std::uint64_t{2} << 62);
  std::string digits;
  for (Wide rest = (Wide{high} << 64) | low; rest != 0; rest /= 10)
    digits.insert(digits.begin(), static_cast<char>('0' + static_cast<int>(rest % 10)));
  return "2.25." + digits;
}

std::string DicomDigest::uid(const std::string& text) const {
  DicomDigest digest = *this;
  digest.add(text);
  return digest.uid();
}

void DicomAttributes::put(DicomTag tag, const char* vr, std::string value) {
  const std::string_view kind = vr;
  assert(value.size() <= (coding_ == Coding::ImplicitVr || kind == "OB" || kind == "OW" || kind == "SQ"
                              ? 0xfffffffeu
                              : 0xfffeu));
  if (value.size() % 2 == 1) value.push_back(kind == "UI" || kind == "OB" ? '\0' : ' ');
  values_[tag] = {vr, std::move(value)};
}

void DicomAttributes::put_short(DicomTag tag, std::uint16_t number) {
  put(tag, "US", bytes_of(number));
}

void DicomAttributes::put_longs(DicomTag tag, std::vector<std::uint32_t> numbers) {
  std::string bytes;
  for (const std::uint32_t number : numbers) bytes += bytes_of(number);
  put(tag, "UL", bytes);
}

void DicomAttributes::put_tag(DicomTag tag, DicomTag named) {
  put(tag, "AT", bytes_of(named >> 16, 2) + bytes_of(named, 2));
}

void DicomAttributes::put_sequence(DicomTag tag, const std::vector<DicomAttributes>& items) {
  constexpr std::string_view item_tag("\xfe\xff\x00\xe0", 4);
  std::string bytes;
  for (const DicomAttributes& item : items) {
    assert(item.coding_ == coding_);
    std::ostringstream inside;
    item.write(inside);
    const std::string value = inside.str();
    bytes.append(item_tag).append(bytes_of(value.size(), 4)).append(value);
  }
  put(tag, "SQ", bytes);
}

void DicomAttributes::write(std::ostream& out) const {
  for (const auto& [tag, value] : values_) {
    if (coding_ == Coding::ImplicitVr) {
      out << bytes_of(tag >> 16, 2) << bytes_of(tag, 2) << bytes_of(value.bytes.size(), 4) << value.bytes;
      continue;
    }
    const bool is_wide = value.vr == "OB" || value.vr == "OW" || value.vr == "SQ";
    out << bytes_of(tag >> 16, 2) << bytes_of(tag, 2) << value.vr;
    if (is_wide) out << bytes_of(0, 2);
    out << bytes_of(value.bytes.size(), is_wide ? 4 : 2) << value.bytes;
  }
}

DicomAttributes dicom_code(const char* value, const char* scheme, const char* meaning) {
  DicomAttributes code;
  code.put(0x00080100, "SH", value);
  code.put(0x00080102, "SH", scheme);
  code.put(0x00080104, "LO", meaning);
  return code;
}

void write_dicom_file(const std::filesystem::path& path, const std::filesystem::path& name,
                      const DicomAttributes& attributes) {
  DicomAttributes meta;
  meta.put(0x00020001, "OB", std::string("\0\1", 2));
  meta.put(0x00020002, "UI", attributes.value(0x00080016));
  meta.put(0x00020003, "UI", attributes.value(0x00080018));
  const bool is_implicit = attributes.coding() == DicomAttributes::Coding::ImplicitVr;
  meta.put(0x00020010, "UI", is_implicit ? "1.2.840.10008.1.2" : "1.2.840.10008.1.2.1");
  meta.put(0x00020012, "UI", DicomDigest().uid("octotomy"));
  meta.put(0x00020013, "SH", "OCTOTOMY");
  std::ostringstream head;
  meta.write(head);
  DicomAttributes length;
  length.put_longs(0x00020000, {static_cast<std::uint32_t>(head.str().size())});
  errno = 0;
  std::ofstream out(path, std::ios::binary);
  out << std::string(128, '\0') << "DICM";
  length.write(out);
  out << head.str();
  attributes.write(out);
  out.close();
  if (!out) refuse_unwritten(name, errno);
}

}  // namespace octotomy::voxel
