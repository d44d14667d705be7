// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/picture_header.h"

#include <gtest/gtest.h>
#include <stdexcept>
#include <string>
#include <utility>

#include "tests/voxel/scan/picture_bytes.h"
#include "voxel/picture/png_chunk.h"

namespace octotomy::voxel {
namespace {

constexpr std::size_t most_bytes = std::size_t{1} << 26;

/// A codestream's first marker segments: size and offset of the picture, of its tiles, and its channels.
std::string codestream(std::uint32_t width, std::uint32_t height, std::uint32_t tile,
                       std::uint32_t channels) {
  std::string bytes("\xff\x4f\xff\x51\x00\x29\x00\x00", 8);
  for (const std::uint32_t number : {width, height, 0u, 0u, tile, tile, 0u, 0u}) bytes += big_endian(number);
  return bytes + big_endian(channels).substr(2) + "\x07\x01\x01";
}

/// A JPEG's segments up to its frame's header, of the kind that the marker states.
std::string jpeg(const std::string& marker, std::uint32_t width, std::uint32_t height, char channels) {
  const std::string comment("\xff\xfe\x00\x06\xff\xc2\x00\x01", 8);  // data like a frame's marker
  return "\xff\xd8" + comment + std::string("\xff\xff", 2) + marker + std::string("\x00\x0b\x08", 3) +
         big_endian(height).substr(2) + big_endian(width).substr(2) + channels + std::string(12, '\0');
}

/// The result for a picture: its format, or the reason for a refusal.
std::string told(const std::string& bytes) {
  try {
    return read_picture_header(bytes, most_bytes).format;
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

bool claims_too_much(const std::string& bytes) {
  return told(bytes).find("more than the file can hold") != std::string::npos;
}

TEST(PictureHeader, FormatsAreTheirFirstBytes) {
  using namespace std::string_literals;
  for (const auto& [bytes, format] :
       {std::pair{"P5 3 3 255\n"s, "pnm"}, std::pair{tests::pgm(), "pnm"}, std::pair{tests::tiff(), "tiff"},
        std::pair{"MM\0*\0\0\0\10"s, "tiff"}, std::pair{tests::bmp(), "bmp"},
        std::pair{tests::exr(), "openexr"}, std::pair{"RIFF\0\0\0\0WEBPVP8 "s, "webp"},
        std::pair{jpeg("\xff\xc0", 9, 9, 1), "jpeg"}})
    EXPECT_EQ(told(bytes), format);
  for (const std::string& bytes : {""s, "P"s, "P9 3 3"s, "RIFF"s, "GIF89a"s, "8BPS\0\1"s})
    EXPECT_NE(told(bytes).find("not a picture in a known format"), std::string::npos) << bytes;
}

TEST(PictureHeader, Jpeg2000MayClaimWhatMayBeDecoded) {
  for (const std::string& bytes :
       {codestream(512, 512, 512, 1), codestream(2048, 2048, 256, 3), codestream(4096, 4096, 4096, 1),
        codestream(4096, 4096, 1024, 1), tests::jp2(codestream(512, 512, 512, 1)),
        tests::jp2(codestream(512, 512, 512, 1), codestream(~0u, ~0u, 1, 1))})
    EXPECT_EQ(told(bytes), "jpeg2000");
  for (const std::string& bytes :
       {codestream(1u << 20, 21, 1u << 20, 1), codestream(32, 16, 16, 16384), codestream(4096, 4096, 16, 1),
        codestream(~0u, ~0u, 1, 1), tests::jp2(codestream(~0u, ~0u, 1, 1), codestream(16, 16, 16, 1))})
    EXPECT_TRUE(claims_too_much(bytes)) << told(bytes);
  EXPECT_NE(told(codestream(0, 5, 5, 1)).find("without pixels"), std::string::npos);
  EXPECT_NE(told(codestream(5, 5, 0, 1)).find("without pixels"), std::string::npos);
  EXPECT_NE(told(codestream(5, 5, 5, 1).substr(0, 30)).find("ends in its header"), std::string::npos);
  EXPECT_NE(told("\xff\x4f\xff\x30" + codestream(5, 5, 5, 1).substr(2)).find("not begin with its size"),
            std::string::npos);
}

TEST(PictureHeader, BoxesOfAJp2LeadToItsCodestream) {
  const std::string picture = codestream(1u << 20, 21, 1u << 20, 1), whole = tests::jp2(picture);
  const std::size_t at = whole.size() - picture.size() - 8;
  ASSERT_TRUE(claims_too_much(whole));
  EXPECT_TRUE(claims_too_much(whole.substr(0, at) + big_endian(0) + "jp2c" + picture));
  EXPECT_TRUE(claims_too_much(whole.substr(0, at) + big_endian(1) + "jp2c" + big_endian(0) +
                              big_endian(static_cast<std::uint32_t>(16 + picture.size())) + picture));
  for (const std::string& cut : {whole.substr(0, at), whole.substr(0, at + 4), whole.substr(0, 8),
                                 whole.substr(0, at) + big_endian(7) + "free" + whole.substr(at),
                                 whole.substr(0, at) + big_endian(~0u) + "free" + whole.substr(at)})
    EXPECT_NE(told(cut).find("without a codestream"), std::string::npos) << told(cut);
}

TEST(PictureHeader, AJpegsFrameIsFoundAmongItsSegments) {
  for (const char* marker : {"\xff\xc0", "\xff\xc2", "\xff\xca"}) {
    EXPECT_EQ(told(jpeg(marker, 4096, 4096, 3)), "jpeg");
    EXPECT_TRUE(claims_too_much(jpeg(marker, 16000, 16000, 1)));
    EXPECT_TRUE(claims_too_much(jpeg(marker, 6000, 6000, 3)));
  }
  // Tables, and frames that end early, are libjpeg's to refuse.
  EXPECT_EQ(told(jpeg("\xff\xc4", 16000, 16000, 1)), "jpeg");
  EXPECT_EQ(told(jpeg("\xff\xc2", 16000, 16000, 1).substr(0, 20)), "jpeg");
}

TEST(PictureHeader, OfABitmapIsOneOfThoseThatAreReadRightly) {
  EXPECT_EQ(told("BM" + std::string(12, '\0') + std::string("\x28\0\0\0", 4)), "bmp");
  for (const std::string& size :
       {std::string("\x29\0\0\0", 4), std::string("\x28\0\0\1", 4), std::string("\x28", 1)})
    EXPECT_NE(told("BM" + std::string(12, '\0') + size).find("unknown size"), std::string::npos);
  std::string runs = tests::bmp();
  for (const char packing : {'\1', '\2'}) {
    runs[30] = packing;
    EXPECT_NE(told(runs).find("run-length-encoded"), std::string::npos) << told(runs);
  }
}

TEST(PictureHeader, TellsTheLargestSampleWhereItsReaderDoesNot) {
  const auto largest = [](const std::string& bytes) {
    return read_picture_header(bytes, most_bytes).largest_sample;
  };
  EXPECT_EQ(largest(tests::pgm()), 255u);
  EXPECT_EQ(largest(tests::pgm(1000)), 1000u);
  EXPECT_EQ(largest("P6 # 1\n# 2\n\t3 4#5\n\r65535\n"), 65535u);
  for (const char* bytes : {"P5", "P5 3 4", "P5 3 4 #255", "P5 3 -4 255", "P5 3 4 0", "P5 3 4 65536"})
    EXPECT_NE(told(bytes).find("largest sample"), std::string::npos) << bytes;
  EXPECT_EQ(largest("P4 3 3 abc"), 0u);
  EXPECT_EQ(largest(tests::png(4, 0, "")), 15u);
  EXPECT_EQ(largest(tests::png(1, 0, "")), 1u);
  EXPECT_EQ(largest(tests::png(8, 0, "")), 0u);
  EXPECT_EQ(largest(tests::png(4, 3, "")), 0u) << "by a palette";
  EXPECT_EQ(largest(tests::blank_codestream(16, 12)), 255u);
  EXPECT_EQ(largest(tests::jp2(tests::blank_codestream(16, 12, 11))), 4095u);
  EXPECT_NE(told(tests::blank_codestream(16, 12, '\x8f')).find("signed"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::voxel
