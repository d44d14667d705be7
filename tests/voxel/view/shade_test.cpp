// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/shade.h"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>

namespace octotomy::voxel {
namespace {

DepthImage image_of(int side, const std::function<Seen(int x, int y)>& seen) {
  DepthImage image{{side, side}, {}};
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) image.pixels.push_back(seen(x, y));
  return image;
}

Scenery scenery_of(double pixel_mm = 1.0) {
  return {{{0.9f, 0.9f, 0.9f}, {0.9f, 0.2f, 0.1f}}, glm::vec3(1.0f), pixel_mm, 1.0, 1000.0};
}

/// The linear light of a plane's middle pixel without occlusion and depth cue.
double light_on(const glm::vec2& slope, const Scenery& asked) {
  const DepthImage image = image_of(33, [&](int x, int y) {
    return Seen{50.0f + slope.x * static_cast<float>(x) - slope.y * static_cast<float>(y), 0, false};
  });
  Scenery scenery = asked;
  scenery.colours = {glm::vec3(0.5f)};
  scenery.occlusion = scenery.depth_cue = false;
  const double srgb = shade(image, scenery)[3 * (16 * 33 + 16)] / 255.0;
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

TEST(Shade, IsPhongsModelForAnyAmbientDiffuseAndSpecularShareAndExponent) {
  const double albedo = std::pow((0.5 + 0.055) / 1.055, 2.4);
  int glossy = 0;
  for (const glm::vec2& slope : {glm::vec2(0.0f), glm::vec2(0.3f, -0.2f), glm::vec2(-0.1f, 0.25f)})
    for (const float exponent : {1.0f, 5.0f, 48.0f, 200.0f}) {
      Scenery scenery = scenery_of();
      scenery.ambient = 0.15f;
      scenery.lights = {Light{{-0.3f, 0.4f, -0.9f}, 0.5f}};
      scenery.gloss = 0.3f;
      scenery.exponent = exponent;
      // Equation 5.1: the surface's normal, the light and the direction halfway to the observer.
      const glm::dvec3 normal = glm::normalize(glm::dvec3(slope.x, slope.y, -1.0));
      const glm::dvec3 light = glm::normalize(glm::dvec3(-0.3, 0.4, -0.9));
      const glm::dvec3 halfway = glm::normalize(light + glm::dvec3(0, 0, -1));
      const double mirrored = 0.3 * std::pow(std::max(0.0, glm::dot(normal, halfway)), exponent);
      const double wanted = albedo * (0.15 + 0.5 * std::max(0.0, glm::dot(normal, light))) + mirrored;
      EXPECT_NEAR(light_on(slope, scenery), wanted, 0.006) << slope.x << ", exponent " << exponent;
      glossy += mirrored > 0.05;
    }
  EXPECT_GT(glossy, 5);
}

std::size_t at(const DepthImage& image, int x, int y) {
  return static_cast<std::size_t>(y * image.size_px.x + x);
}

TEST(Slopes, OfAPlaneAreItsOwnGrowingTowardsRightAndTopAlsoBesideABreak) {
  // Depth grows by 0.3 a pixel to the right and 0.2 a pixel to the top; row numbers grow downwards.
  const DepthImage image = image_of(32, [](int x, int y) {
    return Seen{50.0f + 0.3f * static_cast<float>(x) - 0.2f * static_cast<float>(y) + (x < 16 ? 0.0f : 40.0f),
                0, false};
  });
  const std::vector<glm::vec2> found = slopes(image, scenery_of());
  // Weights next to nothing let a ten-thousandth of the break through, by the weight of an equal number of
  // other differences, which is that of 0.3 before a limit of 4.
  const double leak = (40.0 + 0.3) * 1e-4 / (1.0 - std::pow(0.3 / 4.0, 2.0));
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      ASSERT_NEAR(found[at(image, x, y)].x, 0.3, leak) << x << ", " << y;
      ASSERT_NEAR(found[at(image, x, y)].y, 0.2, leak) << x << ", " << y;
    }
}

TEST(Slopes, PlainCentralDifferencesWouldMissThatBreak) {
  // The twin of the test above: were the break a steep slope, the slope there would show it.
  const DepthImage image = image_of(32, [](int x, int) {
    return Seen{50.0f + (x < 16 ? 0.0f : 1.5f), 0, false};
  });
  const std::vector<glm::vec2> found = slopes(image, scenery_of());
  EXPECT_GT(found[at(image, 15, 10)].x, 0.3);
}

TEST(Slopes, OfASteppedSurfaceComeCloseToThePlaneThatWasDigitised) {
  const double slope = 0.3;
  const DepthImage image = image_of(64, [&](int x, int) {
    return Seen{static_cast<float>(std::floor(slope * x)), 0, true};
  });
  const std::vector<glm::vec2> found = slopes(image, scenery_of());
  for (int x = 16; x < 48; ++x) {
    EXPECT_NEAR(found[at(image, x, 32)].x, slope, 0.06) << x;
    EXPECT_EQ(found[at(image, x, 32)].y, 0.0f) << x;
  }
}

TEST(Slopes, SmoothingMovesNoDepthByMoreThanHalfAVoxelSoThatARidgeStays) {
  // A ridge two voxels high and two wide: over five voxels it would be flattened to a third.
  const DepthImage image = image_of(64, [](int x, int) {
    return Seen{x == 31 || x == 32 ? 10.0f : 12.0f, 0, true};
  });
  const std::vector<glm::vec2> found = slopes(image, scenery_of());
  // From 10.5 at the most to 11.5 at the least on the way down, halved by the flat beyond it.
  EXPECT_GT(found[at(image, 33, 32)].x, 0.25);
  EXPECT_LT(found[at(image, 30, 32)].x, -0.25);
}

TEST(Shade, SurfacesTurnedToTheUpperLeftAreBrighterThanThoseTurnedToTheLowerRight) {
  const auto brightness = [](float to_right, float to_top) {
    const DepthImage image = image_of(33, [&](int x, int y) {
      return Seen{100.0f + to_right * static_cast<float>(x - 16) - to_top * static_cast<float>(y - 16), 0,
                  false};
    });
    return static_cast<int>(shade(image, scenery_of())[3 * at(image, 16, 16)]);
  };
  // A surface turned to the left recedes towards the left: its depth falls to the right.
  EXPECT_GT(brightness(-0.5f, 0.5f), brightness(0.5f, -0.5f) + 20);
  EXPECT_GT(brightness(-0.7f, 0.0f), brightness(0.7f, 0.0f));
  EXPECT_GT(brightness(0.0f, 0.7f), brightness(0.0f, -0.7f));
}

TEST(Shade, WhatLiesDeepWithinItsSurroundingsIsDarker) {
  const DepthImage image = image_of(64, [](int x, int y) {
    const bool pit = std::abs(x - 32) < 8 && std::abs(y - 32) < 8;
    return Seen{pit ? 30.0f : 10.0f, 0, false};
  });
  const std::vector<std::uint8_t> rgb = shade(image, scenery_of());
  EXPECT_LT(rgb[3 * at(image, 32, 32)] + 20, rgb[3 * at(image, 4, 32)]);
}

TEST(Shade, BackgroundIsTheColourAskedForToTheLastBit) {
  Scenery scenery = scenery_of();
  const DepthImage image = image_of(4, [](int, int) { return Seen(); });
  for (const std::uint8_t value : shade(image, scenery)) ASSERT_EQ(value, 255);
  for (int level = 0; level < 256; ++level) {
    scenery.background = glm::vec3(static_cast<float>(level) / 255.0f);
    ASSERT_EQ(shade(image, scenery)[0], level);
  }
}

TEST(Shade, LightBelowBlackIsBlackAndAboveWhiteIsWhite) {
  const DepthImage image = image_of(16, [](int, int) { return Seen{10.0f, 0, false}; });
  for (const auto& [colour, value] : {std::pair(-1.0f, 0), {-1e30f, 0}, {9.0f, 255}, {1e30f, 255}}) {
    Scenery scenery = scenery_of();
    scenery.colours[0] = glm::vec3(colour);
    for (const std::uint8_t shown : shade(image, scenery)) ASSERT_EQ(shown, value) << colour;
  }
}

TEST(EdgePixels, LieOnBothSidesOfABreakAndNowhereOnASlope) {
  const DepthImage image = image_of(16, [](int x, int y) {
    return Seen{2.0f * static_cast<float>(y) + (x < 8 ? 0.0f : 50.0f), 0, false};
  });
  const std::vector<std::uint32_t> edges = edge_pixels(image, scenery_of());
  EXPECT_EQ(edges.size(), 32u);
  for (const std::uint32_t edge : edges) EXPECT_TRUE(edge % 16 == 7 || edge % 16 == 8) << edge;
}

TEST(Blend, MixesLightNotNumbersAndTakesEachPartsColourFromItsOwnSurface) {
  const DepthImage image = image_of(3, [](int x, int) {
    return x == 0 ? Seen() : x == 1 ? Seen{10.0f, 0, false} : Seen{90.0f, 1, false};
  });
  std::vector<std::uint8_t> rgb(27, 255);
  for (std::size_t y = 0; y < 3; ++y)
    for (std::size_t channel = 0; channel < 3; ++channel) {
      rgb[3 * (3 * y + 1) + channel] = 0;
      rgb[3 * (3 * y + 2) + channel] = 188;
    }
  const std::array<Seen, 2> half{Seen{10.5f, 0, false}, Seen()};
  // Half of the light of white is sRGB 188, not 128.
  EXPECT_NEAR(blend(image, rgb, scenery_of(), 4, half)[0], 188, 1);
  const std::array<Seen, 1> other{Seen{89.0f, 1, false}};
  EXPECT_NEAR(blend(image, rgb, scenery_of(), 4, other)[0], 188, 1);
  const std::array<Seen, 1> self{Seen{10.0f, 0, false}};
  EXPECT_EQ(blend(image, rgb, scenery_of(), 4, self)[0], 0);
}

}  // namespace
}  // namespace octotomy::voxel
