// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/archive/png_pixels.h"

#include <gtest/gtest.h>

#include "voxel/scan/image_file.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

std::vector<std::uint8_t> pattern(const glm::ivec2& size_px) {
  std::vector<std::uint8_t> rgb;
  for (int i = 0; i < 3 * size_px.x * size_px.y; ++i)
    rgb.push_back(static_cast<std::uint8_t>(i * i * 7 + i / 5));
  return rgb;
}

std::string png_of(const glm::ivec2& size_px, const std::vector<std::uint8_t>& rgb) {
  const std::vector<std::uint8_t> bytes = encode_image("png", size_px, rgb);
  return {bytes.begin(), bytes.end()};
}

TEST(PngPixels, WrittenPixelsComeBack) {
  for (const glm::ivec2& size_px : {glm::ivec2(1, 1), glm::ivec2(37, 5), glm::ivec2(64, 128)}) {
    const ColourPixels read = png_pixels(png_of(size_px, pattern(size_px)));
    EXPECT_EQ(read.size_px, size_px);
    EXPECT_EQ(read.rgb, pattern(size_px));
  }
}

TEST(PngPixels, DamageIsRefused) {
  const std::string png = png_of({37, 5}, pattern({37, 5}));
  for (std::size_t length = 0; length < png.size(); length += 3)
    EXPECT_THROW(png_pixels(png.substr(0, length)), Error) << length;
  std::string other = png;
  other[16] = 0x7f;  // a width of two milliards
  EXPECT_THROW(png_pixels(other), Error);
  other = png;
  other[24] = 16;  // bits a channel
  EXPECT_THROW(png_pixels(other), Error);
  other = png;
  other[23] = 6;  // more rows than there are
  EXPECT_THROW(png_pixels(other), Error);
}

}  // namespace
}  // namespace octotomy::voxel
