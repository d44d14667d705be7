// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

namespace octotomy::planner {

/// A text file's bytes as UTF-8.
struct DecodedText {
  std::string utf8;      ///< without a byte-order mark
  std::string encoding;  ///< that is not UTF-8, with what it rests on; else empty
};
/// UTF-16 by its byte-order mark; UTF-8 where the bytes are valid; else Latin-1 (ISO 8859-1), an assumption.
DecodedText decoded(const std::string& bytes);

/// A text whose Latin letters with a combining mark are one character each, so that "u" with U+0308, as macOS
/// writes names of files, equals "\u00fc". That is Unicode's normal form C of the letters of European
/// languages; other scripts, and letters with several marks, stay as they are. Precondition: UTF-8.
std::string composed(const std::string& text);

}  // namespace octotomy::planner
