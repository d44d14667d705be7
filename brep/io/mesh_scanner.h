// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "brep/io/mesh_statements.h"

namespace octotomy::brep {

/// Reads the bytes of a mesh file in order, as text or as numbers. Unexpected content throws Error (Input)
/// with the line, or with the byte once binary numbers were read.
class MeshScanner {
 public:
  explicit MeshScanner(std::string_view bytes) : bytes_(bytes) {}

  bool at_end() const { return at_ >= bytes_.size(); }
  std::size_t rest() const { return bytes_.size() - at_; }
  /// Returns the rest of the line and moves past it.
  std::string_view line();
  /// The next word; empty at the end. With `within_line`, also empty at the end of the line, which is not
  /// skipped. A # starts a comment if comments_start_with_hash() was called.
  std::string_view word(bool within_line = false);
  void comments_start_with_hash() { hash_comments_ = true; }
  double number();
  long long integer();
  /// Reads a count of items of at least `bytes_each` bytes. Throws if the rest of the file cannot hold that
  /// many.
  std::size_t count(std::size_t bytes_each);
  std::size_t bounded(long long count, std::size_t bytes_each) const;

  /// A number in the given byte order.
  template <typename T>
  T binary(std::endian order) {
    binary_ = true;
    if (rest() < sizeof(T)) fail("the file ends too early");
    char raw[sizeof(T)];
    std::memcpy(raw, bytes_.data() + at_, sizeof(T));
    if (order != std::endian::native) std::reverse(raw, raw + sizeof(T));
    at_ += sizeof(T);
    T value;
    std::memcpy(&value, raw, sizeof(T));
    return value;
  }
  void skip(std::size_t byte_count);
  std::string_view bytes(std::size_t byte_count);

  [[noreturn]] void fail(const std::string& why) const;

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
  bool hash_comments_ = false;
  bool binary_ = false;
};

/// A word as a number; throws Error (Input) without a position.
double number_of(std::string_view word);
long long integer_of(std::string_view word);

/// The text with ASCII letters in lower case.
std::string lower_case(std::string_view text);

/// Throws Error (Input).
[[noreturn]] void refuse_file(const std::string& why);

/// Whether a text begins with `lower`, which is in lower case; ignores the case of the text.
bool starts_in_any_case(std::string_view text, std::string_view lower);

/// Readers of the formats. All throw Error (Input) without the path. Coordinates stay in the file's frame and
/// unit.
MeshContent read_stl(std::string_view bytes);
MeshContent read_obj(std::string_view bytes);
MeshContent read_off(std::string_view bytes);
MeshContent read_ply(std::string_view bytes);
MeshContent read_vtk(std::string_view bytes);
/// .vtp and .vtu
MeshContent read_vtk_xml(std::string_view bytes);
MeshContent read_glb(std::string_view bytes);
MeshContent read_3mf(std::string_view bytes);

}  // namespace octotomy::brep
