// SPDX-License-Identifier: AGPL-3.0-or-later
// Structures follow one another without gaps, members before their group, because a group states their addresses. The
// superblock is written last, when the root's address is known.
#include "planner/operation/file/write_hdf5.h"

#include <bit>
#include <cstdint>
#include <stdexcept>
#include <string_view>

namespace octotomy::planner {
namespace {

constexpr std::uint64_t no_address = ~std::uint64_t{0};
/// The numbers of members in a symbol table and in a tree's node. The superblock states them for readers.
constexpr std::uint64_t leaf_k = 4, internal_k = 16;
constexpr std::size_t superblock_bytes = 96, texts_bytes = 4096;

std::string coded(std::uint64_t value, std::size_t width) {
  std::string bytes;
  for (std::size_t i = 0; i < width; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xff);
  return bytes;
}

std::string padded(std::string bytes) {
  bytes.resize((bytes.size() + 7) / 8 * 8, '\0');
  return bytes;
}

std::string header_message(std::uint64_t type, const std::string& value) {
  const std::string bytes = padded(value);
  return coded(type, 2) + coded(bytes.size(), 2) + coded(0, 4) + bytes;
}

std::string object_header(std::uint64_t count, const std::string& messages) {
  return coded(1, 2) + coded(count, 2) + coded(1, 4) + coded(messages.size(), 8) + messages;
}

std::string real_type() {
  // Class 1, version 1: a little-endian number with an implied first bit of the mantissa and its sign in bit
  // 63.
  return coded(0x11, 1) + coded(0x3f20, 3) + coded(8, 4) + coded(0, 2) + coded(64, 2) + coded(52, 1) +
         coded(11, 1) + coded(0, 1) + coded(52, 1) + coded(1023, 4);
}

std::string text_type() {
  // Class 9, version 1: a byte text of variable length that ends with a zero byte.
  return coded(0x19, 1) + coded(1, 3) + coded(16, 4) + coded(0x10, 1) + coded(0, 3) + coded(1, 4) +
         coded(0, 2) + coded(8, 2);
}

class Writer {
 public:
  std::string file(const Hdf5Group& root) {
    bytes_.assign(superblock_bytes, '\0');
    texts_at_ = bytes_.size();
    bytes_.append(texts_bytes, '\0');
    const std::uint64_t at = group(root);
    finish_texts();
    const std::string head = std::string("\x89HDF\r\n\x1a\n", 8) + coded(0, 4) + coded(0, 1) + coded(8, 1) +
                             coded(8, 1) + coded(0, 1) + coded(leaf_k, 2) + coded(internal_k, 2) +
                             coded(0, 4) + coded(0, 8) + coded(no_address, 8) + coded(bytes_.size(), 8) +
                             coded(no_address, 8) + symbol(0, at);
    bytes_.replace(0, superblock_bytes, head);
    return std::move(bytes_);
  }

 private:
  std::uint64_t put(const std::string& structure) {
    const std::uint64_t at = bytes_.size();
    bytes_ += padded(structure);
    return at;
  }

  static std::string symbol(std::uint64_t name, std::uint64_t object_at) {
    return coded(name, 8) + coded(object_at, 8) + std::string(24, '\0');
  }

  std::uint64_t dataset(std::uint64_t count, const std::string& type, std::uint64_t at, std::uint64_t size) {
    return put(object_header(
        4, header_message(0x01, coded(1, 1) + coded(1, 1) + coded(0, 6) + coded(count, 8)) +
               header_message(0x03, type) +
               // Storage is allocated when data are written. The fill value has the size 0, so there is none.
               header_message(0x05, coded(2, 1) + coded(2, 1) + coded(2, 1) + coded(1, 1) + coded(0, 4)) +
               header_message(0x08, coded(3, 1) + coded(1, 1) + coded(at, 8) + coded(size, 8))));
  }

  std::uint64_t value(const std::string& text) {
    if (texts_.size() + text.size() + 48 > texts_bytes - 16)
      throw std::invalid_argument("the texts of an HDF5 file must have at most 3 kB together");
    texts_ += coded(++text_count_, 2) + coded(1, 2) + coded(0, 4) + coded(text.size(), 8) + padded(text);
    const std::uint64_t at = put(coded(text.size(), 4) + coded(texts_at_, 8) + coded(text_count_, 4));
    return dataset(1, text_type(), at, 16);
  }

  std::uint64_t value(const std::vector<double>& numbers) {
    if (numbers.empty()) throw std::invalid_argument("a row of an HDF5 file must have at least one number");
    std::string row;
    for (const double each : numbers) row += coded(std::bit_cast<std::uint64_t>(each), 8);
    const std::uint64_t at = put(row);
    return dataset(numbers.size(), real_type(), at, row.size());
  }

  std::uint64_t value(const Hdf5Group& inside) { return group(inside); }

  std::uint64_t group(const Hdf5Group& made) {
    if (made.members.size() > 2 * leaf_k)
      throw std::invalid_argument("a group of an HDF5 file must have at most 8 members");
    std::string names(8, '\0'), symbols;
    std::uint64_t last_name = 0;
    for (const auto& [name, member] : made.members) {
      const std::uint64_t at = std::visit([&](const auto& each) { return value(each); }, member);
      last_name = names.size();
      names += padded(name + '\0');
      symbols += symbol(last_name, at);
    }
    symbols.resize(2 * leaf_k * 40, '\0');
    const std::uint64_t names_at = put(names);
    // A free list at offset 1 means that the list of names has no free part.
    const std::uint64_t heap =
        put("HEAP" + coded(0, 4) + coded(names.size(), 8) + coded(1, 8) + coded(names_at, 8));
    const std::uint64_t table = put("SNOD" + coded(1, 2) + coded(made.members.size(), 2) + symbols);
    std::string tree = "TREE" + coded(0, 2) + coded(made.members.empty() ? 0 : 1, 2) + coded(no_address, 8) +
                       coded(no_address, 8) + coded(0, 8) + coded(table, 8) + coded(last_name, 8);
    tree.resize(24 + 8 * (4 * internal_k + 1), '\0');
    const std::uint64_t tree_at = put(tree);
    return put(object_header(1, header_message(0x11, coded(tree_at, 8) + coded(heap, 8))));
  }

  void finish_texts() {
    std::string collection = "GCOL" + coded(1, 4) + coded(texts_bytes, 8) + texts_;
    // Object 0 is the remaining free space, including the header of object 0.
    collection += coded(0, 8) + coded(texts_bytes - collection.size(), 8);
    collection.resize(texts_bytes, '\0');
    bytes_.replace(texts_at_, texts_bytes, collection);
  }

  std::string bytes_, texts_;
  std::uint64_t texts_at_ = 0, text_count_ = 0;
};

}  // namespace

std::string hdf5_bytes(const Hdf5Group& root) {
  return Writer().file(root);
}

}  // namespace octotomy::planner
