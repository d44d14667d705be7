// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>

namespace octotomy::voxel {

/// The bytes of a file from an offset on, inflated as they are read where they are packed. Packed means one
/// or more gzip streams one after the other, or a zlib stream; what follows them is not read. Memory: a
/// megabyte, whatever the file claims.
class SampleStream {
 public:
  /// Throws Error, Input, with the path if the file cannot be opened.
  SampleStream(const std::filesystem::path& path, std::uintmax_t at, bool is_packed);
  SampleStream(SampleStream&&) noexcept;
  ~SampleStream();

  /// Fills `to`, or as much of it as there are bytes left; returns how many. Throws Error, Input, with the
  /// path where a packed stream is damaged, ends early or fails its checksum.
  std::size_t read(char* to, std::size_t count);
  /// Reads to the end, so that checksums are tested; returns how many bytes there were.
  std::uintmax_t skip_rest();

 private:
  class Reading;
  std::unique_ptr<Reading> reading_;
};

/// Whether the file begins as a gzip stream does.
bool is_gzip(const std::filesystem::path& path);

}  // namespace octotomy::voxel
