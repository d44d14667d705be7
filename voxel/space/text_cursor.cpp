// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/text_cursor.h"

#include <algorithm>
#include <stdexcept>

#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t';
}

bool is_space(char c) {
  return is_blank(c) || c == '\n' || c == '\r';
}

std::string shown(char c) {
  if (c >= ' ' && c <= '~') return "'" + std::string(1, c) + "'";
  return "the byte " + std::to_string(static_cast<unsigned char>(c));
}

}  // namespace

void TextCursor::skip_spaces() {
  while (!at_end() && is_space(text_[position_])) ++position_;
}

void TextCursor::skip_blanks() {
  while (!at_end() && is_blank(text_[position_])) ++position_;
}

bool TextCursor::accept(std::string_view expected) {
  if (text_.substr(position_, expected.size()) != expected) return false;
  position_ += expected.size();
  return true;
}

void TextCursor::expect(std::string_view expected) {
  if (!accept(expected)) refuse_unexpected("'" + std::string(expected) + "'");
}

std::uint64_t TextCursor::number(std::uint64_t largest) {
  const std::size_t start = position_;
  std::uint64_t value = 0;
  while (peek() >= '0' && peek() <= '9') {
    const auto digit = static_cast<std::uint64_t>(peek() - '0');
    if (value > (largest - std::min(digit, largest)) / 10 || digit > largest)
      refuse_at(start, "a number of at most " + std::to_string(largest) + " was expected");
    value = 10 * value + digit;
    ++position_;
  }
  if (position_ == start) refuse_unexpected("a number");
  return value;
}

void TextCursor::expect_end() {
  skip_spaces();
  if (!at_end()) refuse_unexpected("the end");
}

void TextCursor::refuse_at(std::size_t position, const std::string& why) const {
  throw InvalidInput(std::string(what_) + ", character " + std::to_string(position + 1) + ": " + why);
}

void TextCursor::refuse_unexpected(const std::string& expected) const {
  refuse("expected " + expected + ", found " + (at_end() ? "the end" : shown(text_[position_])));
}

}  // namespace octotomy::voxel
