// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace octotomy::planner {

/// Reads the small part of HDF5 that transforms of ITK and 3D Slicer use: groups, rows of numbers and texts.
/// libhdf5 is not used, because it trusts files and these come from strangers.
///
/// The class reads superblocks 0 to 3, both forms of object headers, groups with symbol tables or compact
/// links, real numbers of 4 or 8 bytes, texts of fixed or variable length, and the layouts compact,
/// contiguous and chunked. Chunks may have the filters deflate, shuffle and fletcher32. Anything else is
/// refused with its name. Each address and length is checked against the file before use, a value has at
/// most `most_numbers` numbers, and the number of parts is limited. Time and memory are therefore bounded.
/// Only one thread at a time may use an object.
/// Throws std::runtime_error without a path, with the byte or the member at fault.
/// Source: HDF5 File Format Specification, version 3.0.
class Hdf5File {
 public:
  static constexpr std::size_t most_numbers = 4096, most_members = 1024;

  /// Whether a file begins with the signature of HDF5.
  static bool begins(std::string_view head);

  /// `bytes` is the whole file and must outlive the object.
  explicit Hdf5File(std::string_view bytes);

  /// The names of a group's members, sorted. `path` is a path such as "/TransformGroup".
  std::vector<std::string> members(const std::string& path) const;
  bool has(const std::string& path) const;
  /// A text without trailing blanks and zero bytes. If the value has several texts, the first one.
  std::string text(const std::string& path) const;
  /// A row of real numbers; a single number is a row of one.
  std::vector<double> numbers(const std::string& path) const;

 private:
  using Address = std::uint64_t;
  using Members = std::map<std::string, Address>;
  struct Message {
    std::uint32_t type = 0;
    bool is_shared = false;
    std::string_view bytes;
  };
  struct Dataset;

  std::string_view part(Address at, std::uint64_t count, const char* what) const;
  std::vector<Message> messages(Address header) const;
  void take_messages(std::string_view block, bool is_new, bool has_order, std::vector<Message>& found,
                     std::vector<std::pair<Address, std::uint64_t>>& further) const;
  Members members_at(Address header) const;
  void take_symbols(Address tree, Address heap, int levels, Members& found) const;
  Address find(const std::string& path) const;
  Dataset dataset(const std::string& path) const;
  std::string stored(const Dataset& from, const std::string& path) const;
  void take_chunks(Address tree, int levels, const Dataset& from, std::string& into) const;
  std::string referred_text(std::string_view reference) const;

  void count_node() const;

  std::string_view bytes_;
  Address root_ = 0;
  mutable std::size_t nodes_ = 0;  ///< read until now
};

}  // namespace octotomy::planner
