// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/lettering.h"

#include <gtest/gtest.h>
#include <set>
#include <string>

namespace octotomy::voxel {
namespace {

/// The picture's bytes.
std::string written(const std::string& text, int width = 40) {
  std::vector<std::uint8_t> rgb(static_cast<std::size_t>(3 * width * 40), 255);
  draw_lines({{width, 40}, &rgb}, strokes_of_text(text, {8.0, 28.0}, 18.0), {1.5, {}, 0.0, {}});
  return {rgb.begin(), rgb.end()};
}

TEST(Lettering, EveryPrintableLetterHasAGlyphOfItsOwnInsideItsWidth) {
  std::set<std::string> pictures;
  for (char letter = '!'; letter <= '~'; ++letter) {
    const std::string text(1, letter);
    pictures.insert(written(text));
    const double width = text_width_px(text, 18.0);
    for (const Polyline& stroke : strokes_of_text(text, {0.0, 0.0}, 18.0)) {
      ASSERT_GE(stroke.size(), 2u) << letter;
      for (const glm::dvec2& point : stroke) {
        EXPECT_GE(point.x, 0.0) << letter;
        EXPECT_LE(point.x, width) << letter;
        // Two units a pixel: brackets rise to 10 units above the baseline, descenders fall to 4 below it.
        EXPECT_GE(point.y, -20.0) << letter;
        EXPECT_LE(point.y, 8.0) << letter;
      }
    }
  }
  EXPECT_EQ(pictures.size(), 94u);
  EXPECT_FALSE(pictures.contains(written(" ")));
}

TEST(Lettering, CapitalsAreAsHighAsAskedForAndStandOnTheLine) {
  double top = 0.0, bottom = -100.0;
  for (const Polyline& stroke : strokes_of_text("HE", {100.0, 50.0}, 27.0))
    for (const glm::dvec2& point : stroke) {
      top = std::min(top, point.y - 50.0);
      bottom = std::max(bottom, point.y - 50.0);
    }
  EXPECT_DOUBLE_EQ(top, -27.0);
  EXPECT_DOUBLE_EQ(bottom, 0.0);
}

TEST(Lettering, CodePointsBeyondAsciiAreOneBoxEach) {
  EXPECT_EQ(written("\u00e4"), written("\u2603"));
  EXPECT_EQ(text_width_px("\u00e4\u2603", 18.0), text_width_px("\u00e9\u00e9", 18.0));
  EXPECT_NE(written("\u00e4"), written(" "));
}

TEST(Lettering, TextThatDoesNotFitIsShortenedBetweenCodePoints) {
  const std::string text = "mandible \u00e4\u00e4\u00e4\u00e4 after";
  EXPECT_EQ(shortened(text, 1e6, 10.0), text);
  std::size_t last = 0;
  for (double width = 0.0; width < text_width_px(text, 10.0); width += 1.0) {
    const std::string fits = shortened(text, width, 10.0);
    EXPECT_LE(text_width_px(fits, 10.0), width);
    EXPECT_GE(fits.size(), last);
    last = fits.size();
    if (fits.empty()) continue;
    const std::string kept = fits.substr(0, fits.size() - 3);
    EXPECT_EQ(text.substr(0, kept.size()), kept);
    EXPECT_NE(static_cast<unsigned char>(text[kept.size()]) & 0xc0, 0x80) << fits;
  }
  EXPECT_GT(last, 10u);
}

}  // namespace
}  // namespace octotomy::voxel
