// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>

namespace octotomy::voxel {

/// Reads the bytes of a file from an offset on. Compressed bytes are inflated while they are read: one or
/// more consecutive gzip streams, or one zlib stream. Bytes after these streams are not read. Memory: one
/// megabyte, independent of the size that the file states.
class SampleStream {
 public:
  /// Throws Error (Input) with the path if the file cannot be opened.
  SampleStream(const std::filesystem::path& path, std::uintmax_t at, bool is_packed);
  SampleStream(SampleStream&&) noexcept;
  ~SampleStream();

  /// Reads up to `count` bytes into `to`; returns their number, which is smaller only at the end. Throws
  /// Error (Input) with the path, if a packed stream is damaged, ends early or fails its checksum.
  std::size_t read(char* to, std::size_t count);
  /// Reads to the end, so that checksums are verified; returns the number of bytes read.
  std::uintmax_t skip_rest();

 private:
  class Reading;
  std::unique_ptr<Reading> reading_;
};

/// Whether the file begins with a gzip stream.
bool is_gzip(const std::filesystem::path& path);

}  // namespace octotomy::voxel
