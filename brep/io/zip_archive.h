// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace octotomy::brep {

/// A zip archive in memory (PKWARE's APPNOTE, also with 64-bit sizes): stored and deflated entries, one part.
class ZipArchive {
 public:
  /// Reads the directory. Throws Error (Input) where there is none or it is damaged. The bytes outlive this.
  explicit ZipArchive(std::string_view bytes);

  /// Names as the archive has them, with the case of their letters ignored: 3MF's are so.
  bool has(const std::string& name) const;
  /// An entry's bytes, at most 1032 times as many as it takes in the archive, checked against its checksum.
  /// Throws Error (Input) naming the entry where it is missing, damaged, encrypted or packed another way.
  std::string read(const std::string& name) const;

 private:
  struct Entry {
    std::size_t header = 0, packed = 0, size = 0;
    unsigned method = 0, flags = 0;
    unsigned long checksum = 0;
  };
  const Entry* find(const std::string& name) const;

  std::string_view bytes_;
  std::map<std::string, Entry> entries_;
};

}  // namespace octotomy::brep
