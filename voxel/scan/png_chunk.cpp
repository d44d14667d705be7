// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/png_chunk.h"

#include <zlib.h>

namespace octotomy::voxel {

std::string png_number(std::uint32_t number) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift & 0xff);
  return bytes;
}

std::string png_chunk(const std::string& letters, std::string_view data) {
  std::string checked = letters;
  checked += data;
  const auto crc = static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(checked.data()), static_cast<uInt>(checked.size())));
  return png_number(static_cast<std::uint32_t>(data.size())) + checked + png_number(crc);
}

}  // namespace octotomy::voxel
