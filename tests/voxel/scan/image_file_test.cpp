// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/image_file.h"

#include <OpenImageIO/imageio.h>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <stdexcept>

#include "tests/file_bytes.h"
#include "tests/voxel/scan/dicom_bytes.h"
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

/// A picture of 16 x 12 pixels put together by hand, its samples as numbers.
std::vector<double> samples_of(const std::string& bytes) {
  const ScratchFolder folder;
  tests::write_bytes(folder / "slice.tif", bytes);  // whatever the name says
  const std::vector<StoredImage> pages = read_images(folder / "slice.tif");
  EXPECT_EQ(pages.size(), 1u);
  const StoredImage& page = pages.at(0);
  EXPECT_EQ(page.width, 16);
  EXPECT_EQ(page.height, 12);
  std::vector<double> samples;
  const auto take = [&](auto sample) {
    for (std::size_t at = 0; at + sizeof sample <= page.bytes.size(); at += sizeof sample) {
      std::memcpy(&sample, &page.bytes[at], sizeof sample);
      samples.push_back(static_cast<double>(sample));
    }
  };
  switch (page.type) {
    case StoredImage::Type::UInt8:
      take(std::uint8_t{});
      break;
    case StoredImage::Type::UInt16:
      take(std::uint16_t{});
      break;
    case StoredImage::Type::Int16:
      take(std::int16_t{});
      break;
    case StoredImage::Type::Float:
      take(float{});
      break;
  }
  return samples;
}

/// The values of a function of the pixel's number, for every pixel.
template <typename Sample>
std::vector<double> every(const Sample& sample) {
  std::vector<double> samples;
  for (std::uint32_t i = 0; i < 16 * 12; ++i) samples.push_back(static_cast<double>(sample(i)));
  return samples;
}

TEST(ReadImages, TakesPicturesPutTogetherByHand) {
  for (const std::string& bytes : {tests::pgm(), tests::bmp(), tests::tiff_of_tiles(16, 16), tests::exr()})
    EXPECT_EQ(samples_of(bytes), every(tests::picture_shade));
  EXPECT_EQ(samples_of(tests::tiff()), every([](std::uint32_t i) { return 1000 + 37 * i % 5000; }));
  const std::string blank = tests::blank_codestream(16, 12);
  for (const std::string& bytes : {blank, tests::jp2(blank), tests::jp2(blank, "more")})
    EXPECT_EQ(samples_of(bytes), std::vector<double>(16 * 12, 128.0));
}

TEST(ReadImages, SamplesOfAnyDepthKeepTheirValues) {
  for (const std::uint32_t largest : {1u, 15u, 100u, 254u, 256u, 1000u, 4095u, 40000u, 65534u, 65535u})
    EXPECT_EQ(samples_of(tests::pgm(largest)), every([=](std::uint32_t i) { return 37 * i % (largest + 1); }))
        << largest;

  // Samples up to the largest: in binary and in text, grey and of equal channels.
  for (const std::uint32_t largest : {255u, 1000u, 32767u, 32768u, 40000u, 65534u, 65535u}) {
    const auto sample = [=](std::uint32_t i) { return largest - (i * 343) % largest; };
    const std::string size = "16 12\n# a comment\n" + std::to_string(largest) + "\n";
    std::string grey, grey_text, colours, colour_text;
    for (std::uint32_t i = 0; i < 16 * 12; ++i) {
      std::string bytes;
      if (largest > 255) bytes += static_cast<char>(sample(i) >> 8);
      bytes += static_cast<char>(sample(i));
      const std::string text = std::to_string(sample(i)) + (i % 16 == 15 ? "\n" : " ");
      grey += bytes;
      grey_text += text;
      colours += bytes + bytes + bytes;
      colour_text += text + text + text;
    }
    EXPECT_EQ(sample(0), largest);
    EXPECT_EQ(samples_of("P5\n" + size + grey), every(sample)) << largest;
    EXPECT_EQ(samples_of("P2\n" + size + grey_text), every(sample)) << largest;
    EXPECT_EQ(samples_of("P6\n" + size + colours), every(sample)) << largest;
    EXPECT_EQ(samples_of("P3\n" + size + colour_text), every(sample)) << largest;
  }

  std::string rows, covered;
  for (std::uint32_t i = 0; i < 16 * 12; ++i) {
    if (i % 16 == 0) rows += '\0', covered += '\0';  // the row's filter: none
    if (i % 2 == 0) rows += static_cast<char>((i % 16) << 4 | (i + 1) % 16);
    covered += {static_cast<char>(tests::picture_shade(i)), static_cast<char>(i)};
  }
  EXPECT_EQ(samples_of(tests::png(4, 0, rows)), every([](std::uint32_t i) { return i % 16; }));
  EXPECT_EQ(samples_of(tests::png(8, 4, covered)), every(tests::picture_shade));

  std::string bytes, words, whole, packed;
  for (std::uint32_t i = 0; i < 16 * 12; ++i) {
    bytes += static_cast<char>(i - 100);
    words += tests::DicomBytes::number(i * 1000, 4);
    whole += tests::DicomBytes::number(i * 1000 - 70000, 4);
    const std::uint32_t a = 21 * i, b = 21 * (i + 1);
    if (i % 2 == 0)
      packed += {static_cast<char>(a >> 4), static_cast<char>(a << 4 | b >> 8), static_cast<char>(b)};
  }
  EXPECT_EQ(samples_of(tests::tiff_of(8, 2, bytes)), every([](std::uint32_t i) { return int(i) - 100; }));
  EXPECT_EQ(samples_of(tests::tiff_of(32, 1, words)), every([](std::uint32_t i) { return i * 1000; }));
  EXPECT_EQ(samples_of(tests::tiff_of(32, 2, whole)),
            every([](std::uint32_t i) { return int(i) * 1000 - 70000; }));
  EXPECT_EQ(samples_of(tests::tiff_of(12, 1, packed)), every([](std::uint32_t i) { return 21 * i; }));
  EXPECT_EQ(samples_of(tests::blank_codestream(16, 12, 11)), std::vector<double>(16 * 12, 2048.0));
}

TEST(ReadImages, RefusesWhatItsReaderWouldTakeMemoryFor) {
  const ScratchFolder folder;
  const std::string blank = tests::blank_codestream(1u << 14, 1u << 13);
  for (const std::string& bytes : {tests::tiff_of_tiles(1u << 14, 1u << 14), blank,
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

TEST(ReadImages, RefusesTilesOfNoSize) {
  const ScratchFolder folder;
  constexpr std::uint32_t negative = 0xffffffffu;  // as OpenImageIO takes it
  for (const auto& [width, height] : {std::pair{16u, negative},
                                      {negative, 16u},
                                      {negative, negative},
                                      {16u, 0u},
                                      {0u, 16u},
                                      {16u, 0x80000000u}}) {
    tests::write_bytes(folder / "slice.tif", tests::tiff_of_tiles(width, height));
    EXPECT_THROW(read_images(folder / "slice.tif"), Error) << width << " x " << height;
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
