// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace octotomy::voxel {

/// Reads the text of a code from left to right. Every error message states the position.
class TextCursor {
 public:
  /// `what` is the kind of text, such as "treecode", with which error messages begin.
  TextCursor(std::string_view what, std::string_view text) : what_(what), text_(text) {}

  std::size_t position() const { return position_; }
  bool at_end() const { return position_ == text_.size(); }
  /// The next character; 0 at the end.
  char peek() const { return at_end() ? '\0' : text_[position_]; }
  void advance() { ++position_; }

  void skip_spaces();  ///< skips spaces and line ends
  void skip_blanks();  ///< skips spaces and tabs within a line
  bool accept(std::string_view expected);
  void expect(std::string_view expected);
  /// Reads a decimal number, at most `largest`.
  std::uint64_t number(std::uint64_t largest);
  /// Throws unless only spaces and line ends follow.
  void expect_end();

  /// Throws std::invalid_argument: "treecode, character 12: ...", counted from one.
  [[noreturn]] void refuse(const std::string& why) const { refuse_at(position_, why); }
  [[noreturn]] void refuse_at(std::size_t position, const std::string& why) const;
  /// Throws as refuse() does; the message states the expected text and the character found at the position.
  [[noreturn]] void refuse_unexpected(const std::string& expected) const;

 private:
  std::string_view what_;
  std::string_view text_;
  std::size_t position_ = 0;
};

}  // namespace octotomy::voxel
