// SPDX-License-Identifier: AGPL-3.0-or-later
// Any bytes are an .octree file or are refused with std::runtime_error; what is read is written and read
// again as the same. Half of the inputs are files as they are. Checksums would refuse almost all of those, so
// the other half are sealed first: an input is then the sections' names, lengths and raw bytes.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>
#include <zlib.h>
#include <zstd.h>

#include "voxel/tree/octree_file.h"

namespace {

using Bytes = std::vector<std::uint8_t>;

void put32(Bytes& bytes, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

void set32(Bytes& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
}

std::uint32_t checksum(std::uint32_t start, const std::uint8_t* bytes, std::size_t count) {
  return static_cast<std::uint32_t>(crc32(start, bytes, static_cast<uInt>(count)));
}

// Input: a kind's byte, then sections: a name's byte, two bytes of length, the raw bytes.
Bytes sealed(std::span<const std::uint8_t> input) {
  static constexpr const char* names[] = {"UNIV", "NAME", "META", "TREE", "TOUC", "FRAC", "GRID", "BRIK"};
  Bytes file{0x89, 'O', 'C', 'T', 'R', 'E', 'E', '\n'};
  put32(file, 1);
  put32(file, 1 + input[0] % 3);
  file.resize(32);
  std::uint32_t count = 0;
  for (std::size_t at = 1; at + 3 <= input.size();) {
    const char* const name = names[input[at] % 8];
    const std::size_t length =
        std::min<std::size_t>(input[at + 1] | input[at + 2] << 8, input.size() - at - 3);
    const std::span<const std::uint8_t> raw = input.subspan(at + 3, length);
    at += 3 + length;
    Bytes stored(ZSTD_compressBound(raw.size()));
    stored.resize(ZSTD_compress(stored.data(), stored.size(), raw.data(), raw.size(), 1));
    Bytes section;
    put32(section, count++);
    const std::size_t body = section.size();
    section.insert(section.end(), name, name + 4);
    const std::size_t place = section.size() - body;
    put32(section, static_cast<std::uint32_t>(raw.size()));
    put32(section, static_cast<std::uint32_t>(stored.size()));
    section.insert(section.end(), stored.begin(), stored.end());
    const std::uint32_t sum = checksum(0, section.data(), section.size());
    file.insert(file.end(), section.begin() + static_cast<std::ptrdiff_t>(body),
                section.begin() + static_cast<std::ptrdiff_t>(body + place));
    put32(file, sum);
    file.insert(file.end(), section.begin() + static_cast<std::ptrdiff_t>(body + place), section.end());
  }
  set32(file, 16, static_cast<std::uint32_t>(file.size()));
  set32(file, 24, count);
  set32(file, 28, checksum(0, file.data(), 28));
  return file;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::span<const std::uint8_t> rest(data + 1, size - 1);
  const Bytes file = data[0] % 2 == 0 ? Bytes(rest.begin(), rest.end()) : sealed(rest);
  try {
    const Bytes written = octree_file_bytes(octotomy::voxel::octree_file_of_bytes(file, "fuzz"));
    if (octree_file_bytes(octotomy::voxel::octree_file_of_bytes(written, "again")) != written) std::abort();
  } catch (const std::runtime_error&) {
    return 0;
  }
  return 0;
}
