// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/dicom/character_set.h"

#include <algorithm>
#include <array>
#include <iconv.h>
#include <utility>

namespace octotomy::voxel {
namespace {

/// The names of DICOM's character sets in iconv. A set has two names, without and with code extensions, such
/// as "ISO_IR 100" and "ISO 2022 IR 100"; each key is the end that both share.
constexpr std::array<std::pair<std::string_view, const char*>, 18> encodings{{
    {"IR 6", "ASCII"},
    {"IR 100", "ISO-8859-1"},
    {"IR 101", "ISO-8859-2"},
    {"IR 109", "ISO-8859-3"},
    {"IR 110", "ISO-8859-4"},
    {"IR 144", "ISO-8859-5"},
    {"IR 127", "ISO-8859-6"},
    {"IR 126", "ISO-8859-7"},
    {"IR 138", "ISO-8859-8"},
    {"IR 148", "ISO-8859-9"},
    {"IR 166", "TIS-620"},
    {"IR 13", "SHIFT_JIS"},
    {"IR 87", "ISO-2022-JP-2"},
    {"IR 159", "ISO-2022-JP-2"},
    {"IR 149", "EUC-KR"},
    {"IR 192", "UTF-8"},
    {"GB18030", "GB18030"},
    {"GBK", "GBK"},
}};

void erase_all(std::string& text, std::string_view part) {
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos;) text.erase(at, part.size());
}

}  // namespace

bool is_ascii(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char letter) {
    // An escape sequence switches to another set.
    return static_cast<unsigned char>(letter) < 0x80 && letter != '\x1b';
  });
}

std::optional<std::string> utf8_of(std::string_view character_set, std::string_view text) {
  if (is_ascii(text)) return std::string(text);
  const std::string_view set = character_set.substr(character_set.rfind('\\') + 1);
  const auto* known = std::find_if(encodings.begin(), encodings.end(),
                                   [&](const auto& encoding) { return set.ends_with(encoding.first); });
  if (known == encodings.end()) return std::nullopt;
  const iconv_t converter = iconv_open("UTF-8", known->second);
  if (converter == reinterpret_cast<iconv_t>(-1)) return std::nullopt;
  std::string from(text);
  erase_all(from, "\x1b$)C");  // switches to Korean, which EUC-KR recognises without it
  std::string to(4 * from.size(), '\0');
  char* in = from.data();
  char* out = to.data();
  std::size_t in_left = from.size();
  std::size_t out_left = to.size();
  const std::size_t converted = iconv(converter, &in, &in_left, &out, &out_left);
  iconv_close(converter);
  if (converted == static_cast<std::size_t>(-1)) return std::nullopt;
  to.resize(to.size() - out_left);
  return to;
}

}  // namespace octotomy::voxel
