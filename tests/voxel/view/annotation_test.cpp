// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/annotation.h"

#include <gtest/gtest.h>

#include "voxel/solid/combine.h"
#include "voxel/view/render.h"

namespace octotomy::voxel {
namespace {

ImagePlane plane_of(const View& view, const glm::ivec2& size_px = {400, 300}, double pixel_mm = 0.5) {
  return {view, size_px, glm::dvec2(0.0), pixel_mm, 0.0, 0.0};
}

std::vector<std::uint8_t> annotated(const ImagePlane& plane, const Annotation& annotation,
                                    std::uint8_t paper = 255) {
  std::vector<std::uint8_t> rgb(static_cast<std::size_t>(3 * plane.size_px.x * plane.size_px.y), paper);
  annotate(rgb, plane, annotation);
  return rgb;
}

/// The rows and columns of a rectangle.
std::vector<std::uint8_t> part(const std::vector<std::uint8_t>& rgb, int width, const glm::ivec2& first,
                               const glm::ivec2& last) {
  std::vector<std::uint8_t> pixels;
  for (int y = first.y; y < last.y; ++y)
    for (int x = first.x; x < last.x; ++x)
      for (int channel = 0; channel < 3; ++channel)
        pixels.push_back(rgb[static_cast<std::size_t>(3 * (y * width + x) + channel)]);
  return pixels;
}

TEST(PatientSide, HasTheLettersOfTheContractsViews) {
  struct Row {
    const char* view;
    const char *left, *right, *top, *bottom;
  };
  for (const Row& row : {Row{"anterior", "R", "L", "S", "I"}, Row{"posterior", "L", "R", "S", "I"},
                         Row{"left", "A", "P", "S", "I"}, Row{"right", "P", "A", "S", "I"},
                         Row{"superior", "L", "R", "A", "P"}, Row{"inferior", "R", "L", "A", "P"},
                         // From the patient's left and front, and from above.
                         Row{"45,0", "RA", "LP", "S", "I"}, Row{"10,0", "R", "L", "S", "I"},
                         Row{"0,40", "R", "L", "SP", "IA"}}) {
    const View view = parse_view(row.view);
    EXPECT_EQ(patient_side(-view.right), row.left) << row.view;
    EXPECT_EQ(patient_side(view.right), row.right) << row.view;
    EXPECT_EQ(patient_side(view.up), row.top) << row.view;
    EXPECT_EQ(patient_side(-view.up), row.bottom) << row.view;
  }
}

TEST(Annotation, LettersChangeSidesInAMirroredView) {
  const View view = parse_view("anterior");
  const View mirrored{view.look, view.up, -view.right};
  Annotation annotation;
  annotation.scale = false;
  const std::vector<std::uint8_t> plain = annotated(plane_of(view), annotation);
  const std::vector<std::uint8_t> swapped = annotated(plane_of(mirrored), annotation);
  const auto left = [](const std::vector<std::uint8_t>& rgb) { return part(rgb, 400, {2, 130}, {20, 170}); };
  EXPECT_NE(left(plain), left(swapped));
  EXPECT_EQ(part(plain, 400, {100, 0}, {300, 300}), part(swapped, 400, {100, 0}, {300, 300}));
  // R as at the left of the plain picture is now at the right, as wide as it was.
  const auto ink = [](const std::vector<std::uint8_t>& pixels) {
    std::uint64_t sum = 0;
    for (const std::uint8_t value : pixels) sum += 255u - value;
    return sum;
  };
  const auto right = [](const std::vector<std::uint8_t>& rgb) {
    return part(rgb, 400, {380, 130}, {398, 170});
  };
  EXPECT_GT(ink(left(plain)), ink(right(plain)));
  EXPECT_LT(ink(left(swapped)), ink(right(swapped)));
}

TEST(Annotation, TheLetterLStandsWhereTheObjectAtThePatientsLeftIsDrawn) {
  // The twin: the same object in a picture whose letters were made for the other hand is on R's side.
  const Universe universe = universe_around({glm::dvec3(-32.0), glm::dvec3(32.0)}, 1.0);
  const Octree at_left = combine(universe, Expression(Sphere{{20.0, 0.0, 0.0}, 6.0}));
  for (const char* name : {"anterior", "posterior", "superior", "inferior", "30,10"}) {
    RenderOptions options;
    options.view = parse_view(name);
    options.size_px = {64, 64};
    options.centre_mm = glm::dvec2(0.0);
    options.width_mm = 64.0;
    const Picture picture = render({{"left", at_left}}, options);
    double mean_x = 0.0;
    for (std::size_t i = 0; i < picture.object.size(); ++i)
      if (picture.object[i] >= 0) mean_x += static_cast<double>(i % 64) - 31.5;
    ASSERT_GT(picture.lit_pixels, 0u);
    const bool lies_right = mean_x > 0.0;
    const View& view = picture.view;
    EXPECT_EQ(patient_side(lies_right ? view.right : -view.right)[0], 'L') << name;
    const View mirrored{view.look, view.up, -view.right};
    EXPECT_EQ(patient_side(lies_right ? mirrored.right : -mirrored.right)[0], 'R') << name;
  }
}

TEST(Annotation, ScalesAreOneTwoOrFiveTimesAPowerOfTen) {
  for (const auto& [most, round] : {std::pair{37.0, 20.0},
                                    {50.0, 50.0},
                                    {49.9, 20.0},
                                    {9.99, 5.0},
                                    {1.0, 1.0},
                                    {0.1, 0.1},
                                    {0.7, 0.5},
                                    {1999.0, 1000.0},
                                    {0.0021, 0.002}})
    EXPECT_NEAR(round_length(most), round, 1e-12 * round) << most;
}

TEST(Annotation, TheScalesBarIsAsLongAsItSays) {
  // A quarter of 400 pixels of 0.5 mm is 50 mm: 100 pixels.
  Annotation annotation;
  annotation.sides = false;
  const std::vector<std::uint8_t> rgb = annotated(plane_of(parse_view("left")), annotation);
  const int row = 300 - static_cast<int>(1.5 * 7.0) - 1;
  int longest = 0, run = 0;
  for (int y = row - 2; y <= row + 2; ++y)
    for (int x = 0; x < 400; ++x) {
      run = x > 0 && rgb[static_cast<std::size_t>(3 * (y * 400 + x))] < 140 ? run + 1 : 0;
      longest = std::max(longest, run);
    }
  EXPECT_NEAR(longest, 100, 2);
}

TEST(Annotation, IsLightOnDarkPicturesAndLeavesTheMiddleAlone) {
  Annotation annotation;
  annotation.title = "planned";
  annotation.legend = {{"skull", {0.9f, 0.8f, 0.7f}}, {"maxilla", {0.1f, 0.5f, 0.9f}}};
  annotation.bar = ColourBar{"mm", -2.0, 2.0, {glm::vec3(0.0f, 0.0f, 1.0f), glm::vec3(1.0f, 0.0f, 0.0f)}};
  const ImagePlane plane = plane_of(parse_view("30,10"));
  const std::vector<std::uint8_t> dark = annotated(plane, annotation, 0),
                                  light = annotated(plane, annotation);
  EXPECT_GT(*std::max_element(dark.begin(), dark.end()), 230);
  EXPECT_LT(*std::min_element(light.begin(), light.end()), 50);
  const auto middle = part(light, 400, {120, 60}, {280, 240});
  EXPECT_EQ(middle, std::vector<std::uint8_t>(middle.size(), 255));
  // The swatches have the objects' colours.
  const auto has = [&](const std::array<int, 3>& colour) {
    int count = 0;
    for (std::size_t i = 0; i < light.size(); i += 3)
      count += light[i] == colour[0] && light[i + 1] == colour[1] && light[i + 2] == colour[2];
    return count;
  };
  EXPECT_GT(has({230, 204, 179}), 50);
  EXPECT_GT(has({0, 0, 255}), 50);
  EXPECT_GT(has({255, 0, 0}), 50);
}

TEST(Annotation, RefusesPixelsOfAnotherSizeAndBarsOfNothing) {
  std::vector<std::uint8_t> rgb(30, 255);
  EXPECT_THROW(annotate(rgb, plane_of(parse_view("left")), {}), std::invalid_argument);
  Annotation annotation;
  annotation.bar = ColourBar{"mm", 1.0, 1.0, {glm::vec3(0.0f)}};
  EXPECT_THROW(annotated(plane_of(parse_view("left")), annotation), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
