// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/name_text.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

namespace octotomy::planner {
namespace {

void append_utf8(std::string& text, std::uint32_t code) {
  const auto byte = [&](std::uint32_t value) { text += static_cast<char>(value); };
  if (code < 0x80) return byte(code);
  if (code < 0x800) {
    byte(0xc0 | code >> 6);
  } else if (code < 0x10000) {
    byte(0xe0 | code >> 12);
    byte(0x80 | (code >> 6 & 0x3f));
  } else {
    byte(0xf0 | code >> 18);
    byte(0x80 | (code >> 12 & 0x3f));
    byte(0x80 | (code >> 6 & 0x3f));
  }
  byte(0x80 | (code & 0x3f));
}

/// The number of bytes of the UTF-8 character that begins at `at`; none if the bytes there are not valid
/// UTF-8 (RFC 3629).
std::optional<std::size_t> length_at(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(at);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || text.size() - at < length) return std::nullopt;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(at + i) & 0xc0) != 0x80) return std::nullopt;
  const bool is_long = (lead == 0xe0 && byte(at + 1) < 0xa0) || (lead == 0xf0 && byte(at + 1) < 0x90);
  const bool is_beyond = (lead == 0xf4 && byte(at + 1) > 0x8f) || (lead == 0xed && byte(at + 1) > 0x9f);
  return is_long || is_beyond ? std::nullopt : std::optional(length);
}

bool is_utf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::optional<std::size_t> length = length_at(text, at);
    if (!length) return false;
    at += *length;
  }
  return true;
}

std::string of_utf16(std::string_view bytes, bool is_big) {
  constexpr std::uint32_t replacement = 0xfffd;
  const auto unit = [&](std::size_t at) -> std::uint32_t {
    const auto first = static_cast<unsigned char>(bytes[at]),
               second = static_cast<unsigned char>(bytes[at + 1]);
    return is_big ? first << 8 | second : second << 8 | first;
  };
  const auto is_in = [](std::uint32_t code, std::uint32_t low, std::uint32_t high) {
    return code >= low && code <= high;
  };
  std::string text;
  for (std::size_t at = 0; at + 2 <= bytes.size(); at += 2) {
    std::uint32_t code = unit(at);
    if (is_in(code, 0xd800, 0xdbff) && at + 4 <= bytes.size() && is_in(unit(at + 2), 0xdc00, 0xdfff)) {
      code = 0x10000 + ((code - 0xd800) << 10) + (unit(at + 2) - 0xdc00);
      at += 2;
    }
    append_utf8(text, is_in(code, 0xd800, 0xdfff) ? replacement : code);
  }
  return text;
}

/// For each combining mark, pairs of a letter and the character that replaces the letter with the mark
/// (Unicode, UnicodeData.txt).
constexpr std::array<std::pair<std::string_view, std::string_view>, 12> marks{{
    {"\u0300", "AÀEÈIÌOÒUÙNǸaàeèiìoòuùnǹ"},
    {"\u0301", "AÁEÉIÍOÓUÚYÝCĆLĹNŃRŔSŚZŹaáeéiíoóuúyýcćlĺnńrŕsśzź"},
    {"\u0302", "AÂEÊIÎOÔUÛCĈGĜHĤJĴSŜWŴYŶaâeêiîoôuûcĉgĝhĥjĵsŝwŵyŷ"},
    {"\u0303", "AÃIĨNÑOÕUŨaãiĩnñoõuũ"},
    {"\u0304", "AĀEĒIĪOŌUŪaāeēiīoōuū"},
    {"\u0306", "AĂEĔGĞIĬOŎUŬaăeĕgğiĭoŏuŭ"},
    {"\u0307", "CĊEĖGĠIİZŻcċeėgġzż"},
    {"\u0308", "AÄEËIÏOÖUÜYŸaäeëiïoöuüyÿ"},
    {"\u030a", "AÅUŮaåuů"},
    {"\u030b", "OŐUŰoőuű"},
    {"\u030c", "CČDĎEĚLĽNŇRŘSŠTŤZŽcčdďeělľnňrřsštťzž"},
    {"\u0327", "CÇGĢKĶLĻNŅRŖSŞTŢcçkķlļnņrŗsştţ"},
}};
constexpr std::pair<std::string_view, std::string_view> ogonek{"\u0328", "AĄEĘIĮUŲaąeęiįuų"};

/// The single character for a letter with a combining mark; empty if there is none.
std::string_view joined(char letter, std::string_view mark) {
  const auto in = [&](const std::pair<std::string_view, std::string_view>& entry) -> std::string_view {
    for (std::size_t at = 0; entry.first == mark && at < entry.second.size();) {
      const std::size_t length = *length_at(entry.second, at + 1);
      if (entry.second[at] == letter) return entry.second.substr(at + 1, length);
      at += 1 + length;
    }
    return {};
  };
  for (const auto& entry : marks)
    if (const std::string_view found = in(entry); !found.empty()) return found;
  return in(ogonek);
}

}  // namespace

DecodedText decoded(const std::string& bytes) {
  const std::string_view text = bytes;
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    return {of_utf16(text.substr(2), text[0] == '\xfe'), "UTF-16, by its byte-order mark"};
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
  if (is_utf8(text))
    return {std::string(text.substr(text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0)), {}};
  std::string utf8;
  for (const char letter : text) append_utf8(utf8, static_cast<unsigned char>(letter));
  return {
      utf8,
      "Latin-1, which is assumed because the text is not valid UTF-8: check names with letters beyond ASCII"};
}

std::string composed(const std::string& text) {
  std::string made;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = length_at(text, at).value_or(1);
    const std::size_t next = at + length;
    if (length == 1 && next < text.size()) {
      const std::size_t mark = length_at(text, next).value_or(1);
      if (const std::string_view both = joined(text[at], std::string_view(text).substr(next, mark));
          !both.empty()) {
        made += both;
        at = next + mark;
        continue;
      }
    }
    made.append(text, at, length);
    at = next;
  }
  return made;
}

}  // namespace octotomy::planner
