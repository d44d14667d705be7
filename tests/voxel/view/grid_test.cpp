// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/grid.h"

#include <gtest/gtest.h>

namespace octotomy::voxel {
namespace {

constexpr int grid_width = 200, grid_height = 120;

std::vector<std::uint8_t> blank() {
  return std::vector<std::uint8_t>(std::size_t{3} * grid_width * grid_height, 255);
}
bool is_drawn(const std::vector<std::uint8_t>& rgb, int x, int y) {
  return rgb[static_cast<std::size_t>(3 * (y * grid_width + x))] != 255;
}
std::string refusal(const Grid& grid) {
  std::vector<std::uint8_t> rgb = blank();
  try {
    draw_grid({{grid_width, grid_height}, &rgb}, grid);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Grid, LinesStandAtMultiplesInTheViewsMillimetres) {
  std::vector<std::uint8_t> rgb = blank();
  // u from -13 to 87, v from 31 down to -29; half a millimetre a pixel.
  draw_grid({{grid_width, grid_height}, &rgb}, {10.0, {-13.0, 31.0}, 0.5});
  for (int x = 0; x < grid_width; ++x) EXPECT_EQ(is_drawn(rgb, x, 1), (x - 6) % 20 == 0) << x;
  for (int y = 0; y < grid_height; ++y) EXPECT_EQ(is_drawn(rgb, 1, y), (y - 2) % 20 == 0) << y;
}

TEST(Grid, IsThatOfAPicturesPlane) {
  const ImagePlane plane{parse_view("left"), {grid_width, grid_height}, {7.0, -3.0}, 0.25, 0.0, 0.0};
  const Grid grid = grid_of(plane, 5.0);
  EXPECT_DOUBLE_EQ(grid.corner_mm.x, 7.0 - 100 * 0.25);
  EXPECT_DOUBLE_EQ(grid.corner_mm.y, -3.0 + 60 * 0.25);
}

TEST(Grid, MarginLeavesAllPixelsWhereTheyWere) {
  const Grid grid{10.0, {-13.0, 31.0}, 0.5};
  std::vector<std::uint8_t> rgb = blank();
  draw_grid({{grid_width, grid_height}, &rgb}, grid);
  const std::vector<std::uint8_t> drawn = rgb;
  const glm::ivec2 size_px = add_grid_margin(rgb, {grid_width, grid_height}, grid);
  EXPECT_GT(size_px.x, grid_width);
  EXPECT_GT(size_px.y, grid_height);
  ASSERT_EQ(rgb.size(), static_cast<std::size_t>(3 * size_px.x * size_px.y));
  std::size_t dark_in_margin = 0;
  for (int y = 0; y < size_px.y; ++y)
    for (int x = 0; x < size_px.x; ++x) {
      const std::uint8_t red = rgb[static_cast<std::size_t>(3 * (y * size_px.x + x))];
      // A round end of a tick may touch the picture's last row.
      if (x < grid_width - 1 && y < grid_height - 1)
        EXPECT_EQ(red, drawn[static_cast<std::size_t>(3 * (y * grid_width + x))]) << x << ", " << y;
      else if (red < 100)
        ++dark_in_margin;
    }
  EXPECT_GT(dark_in_margin, 100u) << "no labels";
}

TEST(Grid, RefusesLinesThatAreTooNearOrNone) {
  EXPECT_NE(refusal({1.0, {0.0, 0.0}, 0.5}).find("choose at least 2 mm"), std::string::npos)
      << refusal({1.0, {0.0, 0.0}, 0.5});
  EXPECT_NE(refusal({500.0, {3.0, -3.0}, 0.5}).find("choose a smaller one"), std::string::npos);
  EXPECT_EQ(refusal({2.0, {0.0, 0.0}, 0.5}), "");
}

}  // namespace
}  // namespace octotomy::voxel
