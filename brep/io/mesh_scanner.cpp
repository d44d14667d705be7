// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/io/mesh_scanner.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

bool is_space(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

}  // namespace

void MeshScanner::fail(const std::string& why) const {
  const auto passed = bytes_.substr(0, std::min(at_, bytes_.size()));
  throw Error(
      ErrorCode::Input,
      binary_ ? "byte " + std::to_string(at_) + ": " + why
              : "line " + std::to_string(1 + std::count(passed.begin(), passed.end(), '\n')) + ": " + why);
}

std::string_view MeshScanner::line() {
  const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
  std::string_view text = bytes_.substr(at_, end - at_);
  at_ = std::min(end + 1, bytes_.size());
  if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
  return text;
}

std::string_view MeshScanner::word(bool within_line) {
  while (at_ < bytes_.size()) {
    if (bytes_[at_] == '\n' && within_line) return {};
    if (is_space(bytes_[at_])) {
      ++at_;
    } else if (hash_comments_ && bytes_[at_] == '#') {
      at_ = std::min(bytes_.find('\n', at_), bytes_.size());
    } else {
      break;
    }
  }
  const std::size_t begin = at_;
  while (at_ < bytes_.size() && !is_space(bytes_[at_])) ++at_;
  return bytes_.substr(begin, at_ - begin);
}

std::string lower_case(std::string_view text) {
  std::string made(text);
  for (char& c : made) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return made;
}

void refuse_file(const std::string& why) {
  throw Error(ErrorCode::Input, why);
}

bool starts_in_any_case(std::string_view text, std::string_view lower) {
  return text.size() >= lower.size() &&
         std::equal(lower.begin(), lower.end(), text.begin(), [](char a, char b) {
           return a == (b >= 'A' && b <= 'Z' ? static_cast<char>(b - 'A' + 'a') : b);
         });
}

double number_of(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  // A number too small for a double is read as zero.
  if (error == std::errc::result_out_of_range && end == word.data() + word.size() && std::abs(value) < 1.0)
    return 0.0;
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
    throw Error(ErrorCode::Input, "'" + std::string(word.substr(0, 40)) + "' where a number should be");
  return value;
}

long long integer_of(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  long long value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size())
    throw Error(ErrorCode::Input, "'" + std::string(word.substr(0, 40)) + "' where a whole number should be");
  return value;
}

double MeshScanner::number() {
  const std::string_view text = word();
  if (text.empty()) fail("the file ends where a number should be");
  try {
    return number_of(text);
  } catch (const std::runtime_error& e) {
    fail(e.what());
  }
}

long long MeshScanner::integer() {
  const std::string_view text = word();
  if (text.empty()) fail("the file ends where a whole number should be");
  try {
    return integer_of(text);
  } catch (const std::runtime_error& e) {
    fail(e.what());
  }
}

std::size_t MeshScanner::bounded(long long count, std::size_t bytes_each) const {
  assert(bytes_each > 0);
  if (count < 0 || static_cast<unsigned long long>(count) > rest() / bytes_each)
    fail("a count of " + std::to_string(count) + " is more than the rest of the file, " +
         std::to_string(rest()) + " bytes, can hold; the file is cut short or damaged");
  return static_cast<std::size_t>(count);
}

std::size_t MeshScanner::count(std::size_t bytes_each) {
  return bounded(integer(), bytes_each);
}

std::string_view MeshScanner::bytes(std::size_t byte_count) {
  const std::size_t begin = at_;
  skip(byte_count);
  return bytes_.substr(begin, byte_count);
}

void MeshScanner::skip(std::size_t byte_count) {
  if (byte_count > rest()) fail("the file ends too early");
  at_ += byte_count;
  assert(at_ <= bytes_.size());
}

}  // namespace octotomy::brep
