// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/picture/encode_png.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <random>

namespace octotomy::voxel {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes of_openimageio(const glm::ivec2& size_px, const Bytes& rgb) {
  OIIO::ImageSpec spec(size_px.x, size_px.y, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  spec.attribute("png:compressionLevel", 3);
  const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create("png");
  Bytes encoded;
  OIIO::Filesystem::IOVecOutput memory(encoded);
  EXPECT_TRUE(out && out->set_ioproxy(&memory) && out->open("image.png", spec) &&
              out->write_image(OIIO::TypeDesc::UINT8, rgb.data()) && out->close());
  return encoded;
}

/// Flat, smooth, sloping and noisy stretches, so that each of the filters is the best of some row.
Bytes picture(const glm::ivec2& size_px, unsigned seed) {
  std::mt19937 random(seed);
  Bytes rgb;
  for (int y = 0; y < size_px.y; ++y) {
    const unsigned kind = random() % 5, grey = random() % 256;
    for (int x = 0; x < size_px.x; ++x)
      for (int channel = 0; channel < 3; ++channel) {
        const bool has_above = y > 0 && kind != 0;
        const unsigned above = has_above ? rgb[rgb.size() - 3 * static_cast<std::size_t>(size_px.x)] : grey;
        const unsigned left = x > 0 ? rgb[rgb.size() - 3] : grey;
        rgb.push_back(static_cast<std::uint8_t>(kind == 0   ? grey
                                                : kind == 1 ? left + 1
                                                : kind == 2 ? above + random() % 3
                                                : kind == 3 ? (left + above) / 2 + random() % 2
                                                            : random()));
      }
  }
  return rgb;
}

TEST(EncodePng, WritesTheBytesThatOpenImageIOWrites) {
  std::array<std::size_t, 2> chunks{};
  for (const glm::ivec2& size_px :
       {glm::ivec2(1, 1), {1, 40}, {300, 1}, {17, 5}, {48, 32}, {73, 74}, {480, 97}})
    for (unsigned seed = 0; seed < 3; ++seed) {
      const Bytes rgb = picture(size_px, seed), png = encode_png(size_px, rgb);
      EXPECT_EQ(png, of_openimageio(size_px, rgb))
          << size_px.x << " x " << size_px.y << " pixels, seed " << seed;
      ++chunks[png.size() > 9000 ? 1 : 0];
    }
  EXPECT_GT(chunks[0], 0u);
  EXPECT_GT(chunks[1], 0u) << "no picture is of several chunks";
}

}  // namespace
}  // namespace octotomy::voxel
