// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/picture_header.h"

#include <gtest/gtest.h>
#include <stdexcept>
#include <string>

#include "voxel/scan/png_chunk.h"

namespace octotomy::voxel {
namespace {

constexpr std::size_t most_bytes = std::size_t{1} << 26;

/// A codestream's first marker segments: size and offset of the picture, of its tiles, and its channels.
std::string codestream(std::uint32_t width, std::uint32_t height, std::uint32_t tile,
                       std::uint32_t channels) {
  std::string bytes("\xff\x4f\xff\x51\x00\x29\x00\x00", 8);
  for (const std::uint32_t number : {width, height, 0u, 0u, tile, tile, 0u, 0u}) bytes += big_endian(number);
  return bytes + big_endian(channels).substr(2);
}

std::string reason(const std::string& bytes) {
  try {
    check_picture_header(bytes, most_bytes);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(PictureHeader, Jpeg2000MayClaimWhatMayBeDecoded) {
  EXPECT_EQ(reason(codestream(512, 512, 512, 1)), "");
  EXPECT_EQ(reason(codestream(2048, 2048, 256, 3)), "");
  EXPECT_EQ(reason(std::string("\0\0\0\x0cjP  \r\n\x87\n", 12) + codestream(512, 512, 512, 1)), "");
  for (const std::string& bytes : {codestream(1u << 20, 21, 1u << 20, 1), codestream(16, 16, 16, 16384),
                                   codestream(4096, 4096, 16, 1), codestream(~0u, ~0u, 1, 1)})
    EXPECT_NE(reason(bytes).find("more than the file can hold"), std::string::npos) << reason(bytes);
  EXPECT_NE(reason(codestream(0, 5, 5, 1)).find("without pixels"), std::string::npos);
  EXPECT_NE(reason(codestream(5, 5, 0, 1)).find("without pixels"), std::string::npos);
  EXPECT_NE(reason(codestream(5, 5, 5, 1).substr(0, 30)).find("ends in its header"), std::string::npos);
  EXPECT_NE(reason(std::string("\0\0\0\x0cjP  ", 8)).find("ends in its header"), std::string::npos);
}

TEST(PictureHeader, OfABitmapIsOneOfThoseThatAreKnown) {
  EXPECT_EQ(reason("BM" + std::string(12, '\0') + std::string("\x28\0\0\0", 4)), "");
  for (const std::string& size :
       {std::string("\x29\0\0\0", 4), std::string("\x28\0\0\1", 4), std::string("\x28", 1)})
    EXPECT_NE(reason("BM" + std::string(12, '\0') + size), "") << size;
}

TEST(PictureHeader, OtherBytesPass) {
  for (const char* bytes : {"", "P5 3 3 255\n", "II*"}) EXPECT_EQ(reason(bytes), "") << bytes;
}

}  // namespace
}  // namespace octotomy::voxel
