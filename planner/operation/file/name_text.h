// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

namespace octotomy::planner {

/// A text file's bytes as UTF-8.
struct DecodedText {
  std::string utf8;      ///< without a byte-order mark
  std::string encoding;  ///< the encoding if it is not UTF-8, with the evidence for it; else empty
};
/// Decodes UTF-16 if there is a byte-order mark, UTF-8 if the bytes are valid, else Latin-1 (ISO 8859-1),
/// which is an assumption.
DecodedText decoded(const std::string& bytes);

/// Replaces each Latin letter with a combining mark by a single character, so that "u" with U+0308, as
/// macOS writes names of files, equals "\u00fc". For letters of European languages this is Unicode's normal
/// form C; other scripts, and letters with several marks, stay unchanged. Precondition: UTF-8.
std::string composed(const std::string& text);

}  // namespace octotomy::planner
