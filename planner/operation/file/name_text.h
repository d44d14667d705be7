// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

namespace octotomy::planner {

/// The text of a file as UTF-8.
struct DecodedText {
  std::string utf8;      ///< without a byte-order mark
  std::string encoding;  ///< the file's encoding and the evidence for it; empty if it was UTF-8
};
/// Decodes a file's bytes: UTF-16 if they begin with a byte-order mark, UTF-8 if they are valid, else Latin-1
/// (ISO 8859-1), which is an assumption.
DecodedText decoded(const std::string& bytes);

/// Replaces each Latin letter with a combining mark by a single character. macOS writes "u" with U+0308 in
/// names of files, which then equals "\u00fc". For letters of European languages this is Unicode's normal
/// form C. Other scripts, and letters with several marks, stay unchanged. Precondition: UTF-8.
std::string composed(const std::string& text);

}  // namespace octotomy::planner
