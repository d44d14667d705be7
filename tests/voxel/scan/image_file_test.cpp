// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/image_file.h"

#include <OpenImageIO/imageio.h>
#include <cmath>
#include <gtest/gtest.h>
#include <stdexcept>

#include "tests/file_bytes.h"
#include "tests/voxel/scan/picture_bytes.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;
using tests::ScratchFolder;

constexpr glm::ivec2 ramp_px(48, 32);

/// Red grows to the right, green downwards; so neither a flip nor an exchange of channels goes unseen.
std::vector<std::uint8_t> ramp() {
  std::vector<std::uint8_t> rgb;
  for (int y = 0; y < ramp_px.y; ++y)
    for (int x = 0; x < ramp_px.x; ++x) {
      rgb.push_back(static_cast<std::uint8_t>(5 * x));
      rgb.push_back(static_cast<std::uint8_t>(7 * y));
      rgb.push_back(30);
    }
  return rgb;
}

std::vector<std::uint8_t> decode(const fs::path& path) {
  const std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::open(path.string());
  if (!in) throw std::runtime_error("not an image: " + OIIO::geterror());
  EXPECT_EQ(in->spec().width, ramp_px.x);
  EXPECT_EQ(in->spec().height, ramp_px.y);
  EXPECT_EQ(in->spec().nchannels, 3);
  std::vector<std::uint8_t> rgb(std::size_t{3} * ramp_px.x * ramp_px.y);
  in->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, rgb.data());
  return rgb;
}

TEST(WriteImage, PngKeepsEveryPixel) {
  const ScratchFolder folder;
  write_image(folder / "ramp.png", ramp_px, ramp());
  EXPECT_EQ(decode(folder / "ramp.png"), ramp());
}

TEST(WriteImage, LossyFormatsStayNearThePicture) {
  const ScratchFolder folder;
  for (const char* name : {"ramp.jpg", "ramp.JPEG", "ramp.webp"}) {
    write_image(folder / name, ramp_px, ramp());
    const std::vector<std::uint8_t> rgb = decode(folder / name);
    double sum = 0.0;
    for (std::size_t i = 0; i < rgb.size(); ++i) sum += std::abs(rgb[i] - ramp()[i]);
    EXPECT_LT(sum / static_cast<double>(rgb.size()), 4.0) << name;  // halved chroma moves by 2 to 3 of 255
  }
}

TEST(EncodeImage, GivesTheBytesThatWriteImageWrites) {
  const ScratchFolder folder;
  for (const std::string format : {"png", "jpeg", "webp"}) {
    const std::vector<std::uint8_t> encoded = encode_image(format, ramp_px, ramp());
    write_image(folder / ("ramp." + format), ramp_px, ramp());
    EXPECT_EQ(std::string(encoded.begin(), encoded.end()), tests::bytes_of(folder / ("ramp." + format)))
        << format;
  }
}

TEST(ReadImages, TakesGreyOfEveryFormatAndNoColour) {
  const ScratchFolder folder;
  std::vector<std::uint8_t> grey;
  for (int i = 0; i < ramp_px.x * ramp_px.y; ++i)
    grey.insert(grey.end(), 3, static_cast<std::uint8_t>(40 + 5 * (i % ramp_px.x) / 2));
  for (const char* name : {"slice.png", "slice.jpg", "slice.webp"}) {
    write_image(folder / name, ramp_px, grey);
    const std::vector<StoredImage> pages = read_images(folder / name);
    ASSERT_EQ(pages.size(), 1u) << name;
    ASSERT_EQ(pages[0].bytes.size() * 3, grey.size()) << name;
    for (std::size_t i = 0; i < pages[0].bytes.size(); ++i)
      ASSERT_NEAR(static_cast<std::uint8_t>(pages[0].bytes[i]), grey[3 * i], 8) << name << " at " << i;
    write_image(folder / name, ramp_px, ramp());
    EXPECT_THROW(read_images(folder / name), Error) << name;
  }
}

TEST(ReadImages, RefusesAChunkLongerThanItsFile) {
  const ScratchFolder folder;
  const std::vector<std::uint8_t> grey(std::size_t{3} * ramp_px.x * ramp_px.y, 90);
  write_image(folder / "slice.png", ramp_px, grey, ImageText{"key", "text"});
  ASSERT_EQ(read_images(folder / "slice.png").size(), 1u);
  std::string bytes = tests::bytes_of(folder / "slice.png");
  bytes[bytes.find("tEXt") - 4] = '\x10';  // the length's highest byte: 256 MiB, which libpng would take
  tests::write_bytes(folder / "slice.png", bytes);
  try {
    read_images(folder / "slice.png");
    FAIL() << "was read";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Input);
    EXPECT_NE(std::string(error.what()).find("ends within a chunk"), std::string::npos) << error.what();
  }
}

TEST(ReadImages, TakesPicturesPutTogetherByHand) {
  const ScratchFolder folder;
  const auto shades_of = [&](const std::string& bytes) {
    tests::write_bytes(folder / "slice.tif", bytes);  // whatever the name says
    const std::vector<StoredImage> pages = read_images(folder / "slice.tif");
    EXPECT_EQ(pages.size(), 1u);
    EXPECT_EQ(pages.at(0).width, 16);
    EXPECT_EQ(pages.at(0).height, 12);
    return pages.at(0).bytes;
  };
  std::vector<char> shades;
  for (std::uint32_t i = 0; i < 16 * 12; ++i) shades.push_back(static_cast<char>(tests::picture_shade(i)));
  for (const std::string& bytes :
       {tests::pgm(), tests::bmp(), tests::bmp_of_runs(), tests::tiff_of_tiles(16)})
    EXPECT_EQ(shades_of(bytes), shades);
  EXPECT_EQ(shades_of(tests::tiff()).size(), 2u * 16 * 12);
  EXPECT_EQ(shades_of(tests::exr()).size(), sizeof(float) * 16 * 12);
  const std::string blank = tests::blank_codestream(16, 12);
  for (const std::string& bytes : {blank, tests::jp2(blank), tests::jp2(blank, "more")})
    EXPECT_EQ(shades_of(bytes), std::vector<char>(16 * 12, '\x80'));
}

TEST(ReadImages, RefusesWhatItsReaderWouldTakeMemoryFor) {
  const ScratchFolder folder;
  const std::string blank = tests::blank_codestream(1u << 14, 1u << 13);
  for (const std::string& bytes : {tests::bmp_of_runs(20000, 20000), tests::tiff_of_tiles(1u << 14), blank,
                                   tests::jp2(blank, tests::blank_codestream(16, 12))}) {
    tests::write_bytes(folder / "slice.png", bytes);
    try {
      read_images(folder / "slice.png");
      ADD_FAILURE() << "was read";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("than the file can hold"), std::string::npos) << error.what();
    }
  }
}

TEST(ReadImages, RefusesAPictureThatEndsEarly) {
  const ScratchFolder folder;
  const std::string pgm = "P5\n16 12\n255\n" + std::string(16 * 12, 'g');
  tests::write_bytes(folder / "whole.pgm", pgm);
  EXPECT_EQ(read_images(folder / "whole.pgm").front().bytes.size(), std::size_t{16} * 12);
  for (const std::size_t kept : {pgm.size() - 1, pgm.size() / 2, std::size_t{14}}) {
    tests::write_bytes(folder / "cut.pgm", pgm.substr(0, kept));
    EXPECT_THROW(read_images(folder / "cut.pgm"), Error) << kept;
  }
}

TEST(EncodeImage, RefusesUnknownFormatsAndWrongSizes) {
  EXPECT_THROW(encode_image("dicom", ramp_px, ramp()), std::runtime_error);
  EXPECT_THROW(encode_image("png", {47, 32}, ramp()), std::invalid_argument);
  EXPECT_THROW(encode_image("png", {-48, -32}, ramp()), std::invalid_argument);
  EXPECT_THROW(write_image("/nowhere/at/all.png", ramp_px, ramp()), std::runtime_error);
  EXPECT_THROW(write_image("no_extension", ramp_px, ramp()), std::runtime_error);
}

}  // namespace
}  // namespace octotomy::voxel
