// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace octotomy::tests {

/// DICOM attributes put together by hand, explicit VR little-endian, for files beyond our own writer.
class DicomBytes {
 public:
  static std::string number(std::uint32_t value, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i));
    return text;
  }
  static std::string tag(std::uint32_t tag) { return number(tag >> 16, 2) + number(tag & 0xffff, 2); }
  static std::string element(std::uint32_t at, std::string_view vr, std::string value) {
    if (value.size() % 2 != 0) value += vr == "UI" ? '\0' : ' ';
    const bool wide = vr == "OB" || vr == "OW" || vr == "SQ" || vr == "UN" || vr == "UT";
    const auto length = static_cast<std::uint32_t>(value.size());
    return tag(at) + std::string(vr) + (wide ? number(0, 2) + number(length, 4) : number(length, 2)) + value;
  }
  static std::string us(std::uint32_t at, std::uint16_t value) { return element(at, "US", number(value, 2)); }
  /// A sequence's items, or one without lengths, which ends by marks.
  static std::string item(const std::string& value, bool open = false) {
    return tag(0xfffee000) + number(open ? 0xffffffff : static_cast<std::uint32_t>(value.size()), 4) + value +
           (open ? tag(0xfffee00d) + number(0, 4) : "");
  }
  static std::string sequence(std::uint32_t at, const std::string& items, bool open = false) {
    if (!open) return element(at, "SQ", items);
    return tag(at) + "SQ" + number(0, 2) + number(0xffffffff, 4) + items + tag(0xfffee0dd) + number(0, 4);
  }
  /// A file: preamble, its own attributes, and the rest.
  static std::string file(const std::string& transfer_syntax, const std::string& rest) {
    const std::string meta = element(0x00020010, "UI", transfer_syntax);
    return std::string(128, '\0') + "DICM" +
           element(0x00020000, "UL", number(static_cast<std::uint32_t>(meta.size()), 4)) + meta + rest;
  }
};

}  // namespace octotomy::tests
