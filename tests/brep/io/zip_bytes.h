// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>
#include <zlib.h>

namespace octotomy::tests {

/// The last bytes of a number, least significant first.
inline std::string little(unsigned long value, int bytes) {
  std::string made;
  for (int i = 0; i < bytes; ++i) made += static_cast<char>(value >> (8 * i) & 255);
  return made;
}

/// deflate without a header.
inline std::string deflated(std::string bytes) {
  std::string made(bytes.size() + 100, '\0');
  z_stream stream{};
  deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  stream.next_in = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(made.data());
  stream.avail_out = static_cast<uInt>(made.size());
  deflate(&stream, Z_FINISH);
  made.resize(made.size() - stream.avail_out);
  deflateEnd(&stream);
  return made;
}

/// A zip archive of names and bytes, stored or deflated.
inline std::string zipped(const std::vector<std::pair<std::string, std::string>>& files, bool deflate) {
  std::string archive, directory;
  for (const auto& [name, bytes] : files) {
    const std::string packed = deflate ? deflated(bytes) : bytes;
    const unsigned long sum =
        crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size()));
    const std::string common = little(20, 2) + little(0, 2) + little(deflate ? 8 : 0, 2) + little(0, 4) +
                               little(sum, 4) + little(packed.size(), 4) + little(bytes.size(), 4) +
                               little(name.size(), 2) + little(0, 2);
    directory += "PK\x01\x02" + little(20, 2) + common + little(0, 2) + little(0, 2) + little(0, 2) +
                 little(0, 4) + little(archive.size(), 4) + name;
    archive += "PK\x03\x04" + common + name + packed;
  }
  const std::string end = "PK\x05\x06" + little(0, 4) + little(files.size(), 2) + little(files.size(), 2) +
                          little(directory.size(), 4) + little(archive.size(), 4) + little(0, 2);
  return archive + directory + end;
}

}  // namespace octotomy::tests
