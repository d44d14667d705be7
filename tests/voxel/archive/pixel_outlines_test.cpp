// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/archive/pixel_outlines.h"

#include <gtest/gtest.h>
#include <random>
#include <string>

namespace octotomy::voxel {
namespace {

/// A slice of the rows' letters: # is set.
SliceBits slice_of(const std::vector<std::string>& rows, int side) {
  SliceBits slice{side, (side + 63) / 64, {}};
  slice.words.resize(static_cast<std::size_t>(side * slice.words_per_row));
  for (std::size_t y = 0; y < rows.size(); ++y)
    for (std::size_t x = 0; x < rows[y].size(); ++x)
      if (rows[y][x] == '#')
        slice.words[y * static_cast<std::size_t>(slice.words_per_row) + x / 64] |= std::uint64_t{1}
                                                                                   << (x % 64);
  return slice;
}

bool is_set(const SliceBits& slice, int x, int y) {
  return ((slice.row(y)[x / 64] >> (x % 64)) & 1) != 0;
}

/// Whether a pixel's centre lies inside by the even-odd rule of all outlines.
bool is_inside(const std::vector<PixelOutline>& outlines, int x, int y) {
  bool inside = false;
  for (const PixelOutline& outline : outlines)
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const glm::ivec2 a = outline[i], b = outline[(i + 1) % outline.size()];
      // A ray to the right crosses the edges along y that span the centre's row.
      if (a.x == b.x && a.x > x && std::min(a.y, b.y) <= y && y < std::max(a.y, b.y)) inside = !inside;
    }
  return inside;
}

TEST(PixelOutlines, ListsTheBendsOfABlockAlone) {
  const std::vector<PixelOutline> outlines = pixel_outlines(slice_of({"", " ###", " ###"}, 4));
  ASSERT_EQ(outlines.size(), 1U);
  EXPECT_EQ(outlines[0], (PixelOutline{{4, 1}, {4, 3}, {1, 3}, {1, 1}}));
  EXPECT_EQ(doubled_area(outlines[0]), 12);
}

TEST(PixelOutlines, AHoleHasANegativeArea) {
  const std::vector<PixelOutline> outlines = pixel_outlines(slice_of({"####", "#  #", "####"}, 4));
  ASSERT_EQ(outlines.size(), 2U);
  EXPECT_EQ(doubled_area(outlines[0]), 24);
  EXPECT_EQ(doubled_area(outlines[1]), -4);
}

TEST(PixelOutlines, PixelsThatTouchByACornerHaveOutlinesOfTheirOwn) {
  const std::vector<PixelOutline> outlines = pixel_outlines(slice_of({"# ", " #"}, 4));
  ASSERT_EQ(outlines.size(), 2U);
  for (const PixelOutline& outline : outlines) EXPECT_EQ(doubled_area(outline), 2);
}

TEST(PixelOutlines, HoldTheAreaAndTheCentresOfRandomSlices) {
  int holes = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const int side = seed % 2 == 0 ? 16 : 128;
    std::vector<std::string> rows(static_cast<std::size_t>(side),
                                  std::string(static_cast<std::size_t>(side), ' '));
    long long count = 0;
    for (std::string& row : rows)
      for (char& letter : row)
        if (random() % 100 < 10 + 2 * seed) {
          letter = '#';
          ++count;
        }
    const SliceBits slice = slice_of(rows, side);
    const std::vector<PixelOutline> outlines = pixel_outlines(slice);
    long long area = 0;
    for (const PixelOutline& outline : outlines) {
      area += doubled_area(outline);
      holes += doubled_area(outline) < 0;
    }
    EXPECT_EQ(area, 2 * count);
    if (side > 16) continue;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        EXPECT_EQ(is_inside(outlines, x, y), is_set(slice, x, y)) << x << " " << y;
  }
  EXPECT_GT(holes, 100);
}

}  // namespace
}  // namespace octotomy::voxel
