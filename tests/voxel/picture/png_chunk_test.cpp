// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/picture/png_chunk.h"

#include <gtest/gtest.h>

#include "tests/file_bytes.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/scan/image_file.h"

namespace octotomy::voxel {
namespace {

std::vector<std::uint8_t> picture() {
  return encode_image("png", {4, 3}, std::vector<std::uint8_t>(36, 200));
}
std::string_view text_of(const std::vector<std::uint8_t>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST(PngText, ComesBackWithTheSize) {
  const PngText found = png_text(text_of(with_png_text(picture(), "key", "{\"a\": 1}")), "key");
  EXPECT_EQ(found.size_px, glm::ivec2(4, 3));
  EXPECT_EQ(found.text, "{\"a\": 1}");
  EXPECT_FALSE(png_text(text_of(picture()), "key").text);
  EXPECT_FALSE(png_text(text_of(with_png_text(picture(), "keys", "b")), "key").text);
}

TEST(PngText, LeavesAPictureThatOthersRead) {
  const tests::ScratchFolder folder;
  const std::vector<std::uint8_t> rgb(36, 200);
  write_image(folder / "a.png", {4, 3}, rgb, ImageText{"key", "text"});
  const std::vector<StoredImage> pages = read_images(folder / "a.png");
  ASSERT_EQ(pages.size(), 1u);
  EXPECT_EQ(png_text(tests::bytes_of(folder / "a.png"), "key").text, "text");
}

TEST(PngText, PassesOverWhatFollowsThePicture) {
  std::vector<std::uint8_t> png = with_png_text(picture(), "key", "text");
  png.insert(png.end(), {'e', 'n', 'd'});
  EXPECT_EQ(png_text(text_of(png), "key").text, "text");
}

TEST(PngText, RefusesWhatIsNoPngOrEndsEarly) {
  EXPECT_THROW(png_text("GIF89a", "key"), std::invalid_argument);
  EXPECT_THROW(with_png_text({1, 2, 3}, "key", "text"), std::invalid_argument);
  std::vector<std::uint8_t> cut = with_png_text(picture(), "key", "a longer text");
  cut.resize(50);
  EXPECT_THROW(png_text(text_of(cut), "key"), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
