// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace octotomy::voxel {

/// Compressed pixels of one grey DICOM frame and how they are stored once decompressed.
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

/// Decompresses RLE, JPEG, JPEG-LS and JPEG 2000 by GDCM to little-endian pixels in the bits allocated; none
/// where the pixels are damaged or the transfer syntax is not one of these. It happens in a process of its
/// own, octotomy_dicom_codec beside the program, one for each thread: GDCM and its codecs crash on some
/// damaged pixels, and loading it would cost every start of the program 30 ms. Throws std::runtime_error
/// where that program is not there.
std::optional<std::string> decompress(const CompressedFrame& frame);

}  // namespace octotomy::voxel
