// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace octotomy::brep {

/// Reads a zip archive in memory (PKWARE's APPNOTE, also with 64-bit sizes): stored and deflated entries, one
/// volume.
class ZipArchive {
 public:
  /// Reads the directory. Throws Error (Input) if there is none or it is damaged. The bytes must outlive this
  /// object.
  explicit ZipArchive(std::string_view bytes);

  /// Whether an entry exists. Ignores case, as 3MF requires.
  bool has(const std::string& name) const;
  /// An entry's bytes: at most 1032 times its size in the archive. Verifies the checksum. Throws Error
  /// (Input), which names the entry, if it is missing, damaged, encrypted or compressed by another method.
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
