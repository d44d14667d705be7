// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/fuzz/mutation.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <random>
#include <stdexcept>
#include <zlib.h>

namespace octotomy::tests {
namespace {

/// Random numbers that are the same with every standard library.
class Dice {
 public:
  Dice(Mutation mutation, std::uint64_t seed)
      : engine_(seed * mutation_count + static_cast<std::uint64_t>(mutation)) {}
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(engine_() % count); }

 private:
  std::mt19937_64 engine_;
};

void flip_bits(std::string& bytes, Dice& dice) {
  const std::size_t within = dice.below(2) == 0 ? std::min<std::size_t>(bytes.size(), 1024) : bytes.size();
  for (std::size_t left = 1 + dice.below(16); left > 0; --left) {
    char& byte = bytes[dice.below(within)];
    byte = static_cast<char>(byte ^ (1 << dice.below(8)));
  }
}

/// Replaces a run of digits at or after a place; false where none follows.
bool inflate_digits(std::string& bytes, std::size_t from, Dice& dice) {
  const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  const auto first = std::find_if(bytes.begin() + static_cast<std::ptrdiff_t>(from), bytes.end(), is_digit);
  if (first == bytes.end()) return false;
  const auto last = std::find_if_not(first, bytes.end(), is_digit);
  constexpr std::array<const char*, 8> large{"65535",      "2147483647", "4294967296", "99999999999999999999",
                                             "1000000000", "-1",         "0",          "1e308"};
  bytes.replace(first, last, large[dice.below(large.size())]);
  return true;
}

void inflate_number(std::string& bytes, Dice& dice) {
  const std::size_t at = dice.below(std::min<std::size_t>(bytes.size(), 4096));
  if (dice.below(2) == 0 && inflate_digits(bytes, at, dice)) return;
  constexpr std::array<std::uint64_t, 6> large{0x7fff,     0xffff,     0x7fffffff,
                                               0xffffffff, 0x40000000, 0x7fffffffffffffff};
  const std::uint64_t value = large[dice.below(large.size())];
  const std::size_t width = std::min(std::size_t{2} << dice.below(3), bytes.size() - at);
  const bool high_first = dice.below(2) == 0;
  for (std::size_t i = 0; i < width; ++i)
    bytes[at + (high_first ? width - 1 - i : i)] = static_cast<char>(value >> (8 * i));
}

void move_part(std::string& bytes, Dice& dice) {
  const std::size_t at = dice.below(bytes.size());
  const std::size_t length = std::min(1 + dice.below(64), bytes.size() - at);
  switch (dice.below(3)) {
    case 0:
      bytes.insert(at, bytes.substr(at, length));
      break;
    case 1:
      bytes.erase(at, length);
      break;
    default:
      std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), length, '\0');
  }
}

std::uint32_t number_at(const std::string& bytes, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i)
    number |= std::uint32_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
  return number;
}

void put_number(std::string& bytes, std::size_t at, std::uint32_t number) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<char>(number >> (8 * i));
}

std::uint32_t swapped(std::uint32_t number) {
  return number >> 24 | (number >> 8 & 0xff00) | (number << 8 & 0xff0000) | number << 24;
}

std::uint32_t checksum(const std::string& bytes) {
  return static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

}  // namespace

const char* name_of(Mutation mutation) {
  switch (mutation) {
    case Mutation::FlipBits:
      return "bits flipped";
    case Mutation::Truncate:
      return "truncated";
    case Mutation::InflateNumber:
      return "a number inflated";
    case Mutation::MovePart:
      return "a part moved";
  }
  return "";
}

std::string mutated(const std::string& sound, Mutation mutation, std::uint64_t seed) {
  Dice dice(mutation, seed);
  std::string bytes = sound;
  switch (mutation) {
    case Mutation::FlipBits:
      flip_bits(bytes, dice);
      break;
    case Mutation::Truncate:
      bytes.resize(dice.below(bytes.size()));
      break;
    case Mutation::InflateNumber:
      inflate_number(bytes, dice);
      break;
    case Mutation::MovePart:
      move_part(bytes, dice);
  }
  return bytes;
}

std::string resealed_octree(std::string bytes) {
  constexpr std::size_t header = 32;
  constexpr std::size_t section_head = 16;
  if (bytes.size() < header) return bytes;
  std::uint32_t count = 0;
  for (std::size_t at = header; bytes.size() - at >= section_head; ++count) {
    const std::size_t stored = number_at(bytes, at + 12);
    if (stored > bytes.size() - at - section_head) break;
    std::string summed(4, '\0');
    put_number(summed, 0, count);
    summed += bytes.substr(at, 4) + bytes.substr(at + 8, 8 + stored);
    put_number(bytes, at + 4, checksum(summed));
    at += section_head + stored;
  }
  put_number(bytes, 28, checksum(bytes.substr(0, 28)));
  return bytes;
}

std::string resealed_png(std::string bytes) {
  for (std::size_t at = 8; at < bytes.size() && bytes.size() - at >= 12;) {
    const std::size_t length = swapped(number_at(bytes, at));
    if (length > bytes.size() - at - 12) break;
    put_number(bytes, at + 8 + length, swapped(checksum(bytes.substr(at + 4, 4 + length))));
    at += 12 + length;
  }
  return bytes;
}

std::string packed(const std::string& bytes) {
  z_stream stream{};
  if (deflateInit2(&stream, 6, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::runtime_error("zlib cannot begin");
  std::string to(deflateBound(&stream, static_cast<uLong>(bytes.size())) + 64, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(to.data());
  stream.avail_out = static_cast<uInt>(to.size());
  deflate(&stream, Z_FINISH);
  to.resize(to.size() - stream.avail_out);
  deflateEnd(&stream);
  return to;
}

}  // namespace octotomy::tests
