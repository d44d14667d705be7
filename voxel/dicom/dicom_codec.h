// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace octotomy::voxel {

/// Compressed pixels of one grey DICOM frame, and the format that they have after decompression.
struct CompressedFrame {
  std::string transfer_syntax;
  unsigned columns = 0;
  unsigned rows = 0;
  unsigned allocated_bits = 16;
  unsigned stored_bits = 16;
  unsigned high_bit = 15;
  bool is_signed = false;
  std::vector<std::string_view> fragments;
};

/// Decompresses RLE, JPEG, JPEG-LS and JPEG 2000 with GDCM. Returns little-endian pixels of `allocated_bits`
/// bits. None if the pixels are damaged or have another transfer syntax. The decompression runs in a separate
/// process per thread, octotomy_dicom_codec, because GDCM and its codecs crash on some damaged pixels, and
/// loading GDCM would delay every start of the program by 30 ms. Throws Error (Resource) if that process
/// cannot be started.
std::optional<std::string> decompress(const CompressedFrame& frame);

/// Facts that the decompressing process reports about itself.
struct CodecFacts {
  bool is_confined = false;  ///< whether every protection of confine() is in force in that process
  std::vector<std::pair<std::string, std::string>> libraries = {};  ///< names and loaded versions
};

/// Requests these facts from the calling thread's decompressing process. Throws Error (Resource) if the
/// process cannot be started or does not answer.
CodecFacts codec_facts();

}  // namespace octotomy::voxel
