// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace octotomy::voxel {

/// Compressed pixels of one grey DICOM frame, and the format of the pixels once decompressed.
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

/// Decompresses RLE, JPEG, JPEG-LS and JPEG 2000 with GDCM to little-endian pixels of BitsAllocated bits.
/// None if the pixels are damaged or have another transfer syntax. Each thread starts a process of its own,
/// octotomy_dicom_codec: GDCM and its codecs crash on some damaged pixels, and loading GDCM would add 30 ms
/// to every start of the program. Throws Error (Resource) if that process cannot be started.
std::optional<std::string> decompress(const CompressedFrame& frame);

/// Facts that the decompressing process reports about itself.
struct CodecFacts {
  bool is_confined = false;  ///< whether all of confine() is in force there
  std::vector<std::pair<std::string, std::string>> libraries = {};  ///< names and loaded versions
};

/// Requests the facts from the calling thread's process. Throws Error (Resource) if it cannot be started or
/// does not answer.
CodecFacts codec_facts();

}  // namespace octotomy::voxel
