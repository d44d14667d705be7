// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/measure/distance_histogram.h"

#include <gtest/gtest.h>
#include <stdexcept>

namespace octotomy::planner {
namespace {

brep::Difference difference(const std::vector<double>& shares) {
  brep::Difference difference;
  difference.histogram = {-1.0, 2.0 / static_cast<double>(shares.size()), shares};
  return difference;
}

/// Pixels of one colour.
int count(const HistogramPicture& picture, const glm::u8vec3& colour) {
  int pixels = 0;
  for (std::size_t i = 0; i < picture.rgb.size(); i += 3)
    pixels += picture.rgb[i] == colour.x && picture.rgb[i + 1] == colour.y && picture.rgb[i + 2] == colour.z;
  return pixels;
}

TEST(DistanceHistogram, BarsHaveTheMeshsColoursAndHeightsByShare) {
  // Bins about -0.8, -0.4, 0, 0.4 and 0.8.
  const HistogramPicture picture = draw_histogram(difference({0.1, 0.2, 0.4, 0.2, 0.1}), 1.0);
  ASSERT_EQ(picture.rgb.size(), static_cast<std::size_t>(3 * picture.size_px.x * picture.size_px.y));
  const int inside = count(picture, distance_colour(-0.8, 1.0)),
            further = count(picture, distance_colour(-0.4, 1.0)),
            outside = count(picture, distance_colour(0.8, 1.0));
  EXPECT_GT(inside, 5000);
  EXPECT_EQ(inside, outside);
  EXPECT_NEAR(static_cast<double>(further) / inside, 2.0, 0.05);
}

TEST(DistanceHistogram, ColoursSaturateAtTheRangeAndTellTheSides) {
  EXPECT_EQ(distance_colour(0.0, 1.0), glm::u8vec3(247));
  EXPECT_EQ(distance_colour(5.0, 1.0), distance_colour(1.0, 1.0));
  EXPECT_GT(distance_colour(1.0, 1.0).x, distance_colour(1.0, 1.0).z);
  EXPECT_GT(distance_colour(-1.0, 1.0).z, distance_colour(-1.0, 1.0).x);
  EXPECT_EQ(distance_colour(3.0, 0.0), glm::u8vec3(247));
}

TEST(DistanceHistogram, SurfacesWithoutADifferenceHaveAPictureToo) {
  brep::Difference none = difference({1.0});
  none.histogram.width_mm = 0.0;
  EXPECT_FALSE(draw_histogram(none, 0.0).rgb.empty());
  none.histogram.shares.clear();
  EXPECT_THROW(draw_histogram(none, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::planner
