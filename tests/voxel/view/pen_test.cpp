// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/pen.h"

#include <gtest/gtest.h>

namespace octotomy::voxel {
namespace {

const Pen black{4.0, glm::vec3(0.0f), 0.0, glm::vec3(1.0f)};

int dark_pixels(const std::vector<std::uint8_t>& rgb) {
  int count = 0;
  for (std::size_t i = 0; i < rgb.size(); i += 3) count += rgb[i] == 0;
  return count;
}

TEST(Pen, ALineAlongARowCoversItsWidthOfRowsWholly) {
  std::vector<std::uint8_t> rgb(3 * 40 * 20, 255);
  draw_lines({{40, 20}, &rgb}, {{{10.0, 10.0}, {30.0, 10.0}}}, black);
  for (int x = 12; x < 28; ++x)
    for (int y = 0; y < 20; ++y)
      EXPECT_EQ(rgb[3 * static_cast<std::size_t>(y * 40 + x)], y >= 8 && y < 12 ? 0 : 255) << x << ", " << y;
}

TEST(Pen, LinesThatCrossCoverAPixelOnceAndAHaloOnlyPaintsBesideThem) {
  std::vector<std::uint8_t> once(3 * 40 * 40, 128), twice = once;
  Pen pen = black;
  pen.halo_px = 2.0;
  const Polyline line{{5.3, 7.1}, {31.2, 30.8}};
  draw_lines({{40, 40}, &once}, {line}, pen);
  draw_lines({{40, 40}, &twice}, {line, line}, pen);
  EXPECT_EQ(once, twice);
  EXPECT_GT(dark_pixels(once), 80);
  int white = 0;
  for (std::size_t i = 0; i < once.size(); i += 3) white += once[i] == 255;
  EXPECT_GT(white, 80);
}

TEST(Pen, WhatLiesOffThePictureIsLeftOutAndADotIsRound) {
  std::vector<std::uint8_t> rgb(3 * 10 * 10, 255);
  draw_lines({{10, 10}, &rgb}, {{{-50.0, -50.0}, {-20.0, 90.0}}, {{60.0, 5.0}, {90.0, 5.0}}}, black);
  EXPECT_EQ(rgb, std::vector<std::uint8_t>(300, 255));
  draw_lines({{10, 10}, &rgb}, {{{5.0, 5.0}, {5.0, 5.0}}}, black);
  EXPECT_EQ(dark_pixels(rgb), 4);
  fill_rectangle({{10, 10}, &rgb}, {-5, -5}, {50, 1}, glm::vec3(0.0f));
  EXPECT_EQ(dark_pixels(rgb), 14);
}

}  // namespace
}  // namespace octotomy::voxel
