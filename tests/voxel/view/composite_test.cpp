// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/composite.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <optional>
#include <tbb/global_control.h>

#include "tests/unit_universe.h"
#include "tests/voxel/dense.h"
#include "tests/voxel/field_scene.h"
#include "voxel/tree/interpolate.h"
#include "voxel/view/object_normals.h"
#include "voxel/view/srgb.h"

namespace octotomy::voxel {
namespace {

using tests::universe_about_origin;

GreyOctree grey_of(const std::function<double(const glm::dvec3& p_mm)>& sample, std::int16_t background = 0) {
  return grey_octree_of(universe_about_origin(5),
                        tests::field_scene<std::int16_t>(universe_about_origin(5).lattice(), sample),
                        background);
}

ImagePlane plane_of(const GreyOctree& grey, const std::string& view, int size_px = 40,
                    double width_mm = 40.0) {
  return image_plane(grey.universe(), parse_view(view), glm::ivec2(size_px), {glm::dvec2(0.0), width_mm});
}

const glm::vec3 green{0.2f, 0.7f, 0.3f};
TransferFunction even(double per_mm) {
  return {{{0.0, green, per_mm}, {1000.0, green, per_mm}}, 50.0};
}

/// Length of a pixel's ray among the voxels' centres, a cube of 31 mm about the origin.
double chord_mm(const ImagePlane& plane, const glm::dvec2& p_px) {
  const glm::dvec3 start = plane.lps_mm(p_px, 0.0);
  double from = -1e9, until = 1e9;
  for (int axis = 0; axis < 3; ++axis) {
    const double along = plane.view.look[axis];
    if (std::abs(along) < 1e-12) {
      if (std::abs(start[axis]) > 15.5) return 0.0;
      continue;
    }
    const double a = (-15.5 - start[axis]) / along, b = (15.5 - start[axis]) / along;
    from = std::max(from, std::min(a, b));
    until = std::min(until, std::max(a, b));
  }
  return std::max(0.0, until - from);
}

TEST(Composite, AHomogeneousSlabLetsThroughTheExponentialOfItsThickness) {
  const GreyOctree grey = grey_of([](const glm::dvec3&) { return 500.0; }, 500);
  for (const char* view : {"anterior", "superior", "30,20", "-77,-41"}) {
    const ImagePlane plane = plane_of(grey, view);
    const Composite image = composite(grey, plane, {even(0.03), {}, {}});
    double most = 0.0;
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x) {
        const double opacity = 1.0 - std::exp(-0.03 * chord_mm(plane, {x + 0.5, y + 0.5}));
        const glm::vec4& light = image.light[static_cast<std::size_t>(y * 40 + x)];
        ASSERT_NEAR(light.w, opacity, 1e-5) << view << " " << x << ", " << y;
        // Glowing matter of one colour: as much light of it as it is opaque.
        const glm::vec3 colour = linear_from_srgb(green);
        for (int channel = 0; channel < 3; ++channel)
          ASSERT_NEAR(light[channel], opacity * colour[channel], 1e-5);
        most = std::max(most, opacity);
      }
    EXPECT_GT(most, 0.5) << view;
  }
}

TEST(Composite, TheLargestNumbersAllowedGiveAPictureOfFiniteLight) {
  const GreyOctree grey = grey_of([](const glm::dvec3& p) { return 10.0 * p.x; });
  CompositeOptions options{{{{-TransferPoint::max_sample, green, 0.0},
                             {TransferPoint::max_sample, green, TransferPoint::max_per_mm}},
                            1e-300},
                           {},
                           {}};
  const Composite image = composite(grey, plane_of(grey, "30,20"), options);
  float most = 0.0f;
  for (const glm::vec4& light : image.light) {
    for (int channel = 0; channel < 4; ++channel) ASSERT_TRUE(std::isfinite(light[channel]));
    most = std::max(most, light.w);
  }
  EXPECT_EQ(most, 1.0f);
  options.transfer.points.back().per_mm = 1e308;
  EXPECT_THROW(composite(grey, plane_of(grey, "30,20"), options), std::invalid_argument);
}

TEST(Composite, HalfOfTheLightIsLostWhereTheExponentialSaysSo) {
  const GreyOctree grey = grey_of([](const glm::dvec3&) { return 500.0; }, 500);
  const ImagePlane plane = plane_of(grey, "left");
  const Composite image = composite(grey, plane, {even(0.1), {}, {}});
  // The first voxels' centres are half a voxel behind the plane of depth 0; steps are half a voxel.
  const double truth_mm = 0.5 + std::log(2.0) / 0.1;
  EXPECT_NEAR(image.depth_mm[20 * 40 + 20], truth_mm, 0.5);
  EXPECT_EQ(image.depth_mm[0], std::numeric_limits<float>::infinity());
}

/// The integral without skipped blocks, early ends or kept samples.
glm::vec4 reference(const GreyOctree& grey, const ImagePlane& plane, const TransferFunction& transfer,
                    const glm::dvec2& p_px, const std::optional<glm::dvec2>& ramp = std::nullopt) {
  const TransferTable table(transfer, {-1000, 1000});
  const glm::dvec3 start_mm = plane.lps_mm(p_px, 0.0);
  double from = -1e9, until = 1e9;
  for (int axis = 0; axis < 3; ++axis) {
    const double along = plane.view.look[axis];
    if (std::abs(along) < 1e-12) {
      if (std::abs(start_mm[axis]) > 15.5) return glm::vec4(0.0f);
      continue;
    }
    const double a = (-15.5 - start_mm[axis]) / along, b = (15.5 - start_mm[axis]) / along;
    from = std::max(from, std::min(a, b));
    until = std::min(until, std::max(a, b));
  }
  if (from > until) return glm::vec4(0.0f);
  glm::dvec3 light(0.0);
  double behind = 1.0;
  for (double at = from; at < until; at += 0.5) {
    const double length = std::min(0.5, until - at);
    const glm::dvec3 p_mm = start_mm + (at + 0.5 * length) * plane.view.look;
    const glm::dvec3 p = grey.universe().lattice().voxel(p_mm);
    const auto entry = table.at(interpolate(grey, p, Interpolation::Linear));
    double facing = 1.0;
    const glm::dvec3 gradient = 0.5 * grey_normal(grey, p);
    if (glm::length(gradient) > 0.0) {
      glm::dvec3 normal = glm::normalize(gradient);
      if (glm::dot(normal, plane.view.look) > 0.0) normal = -normal;
      double lit = Scenery{}.ambient;
      for (const Light& each : Scenery{}.lights) {
        const glm::dvec3 towards = glm::normalize(glm::dvec3(each.towards));
        lit += each.strength * std::max(0.0, glm::dot(normal, plane.view.right) * towards.x +
                                                 glm::dot(normal, plane.view.up) * towards.y +
                                                 glm::dot(normal, plane.view.look) * towards.z);
      }
      facing += std::min(1.0, glm::length(gradient) / transfer.surface_per_mm) * (lit - 1.0);
    }
    double per_mm = entry.per_mm;
    if (ramp) per_mm *= std::clamp((glm::length(gradient) - ramp->x) / (ramp->y - ramp->x), 0.0, 1.0);
    const double share = behind * (1.0 - std::exp(-per_mm * length));
    light += share * facing * glm::dvec3(entry.light);
    behind -= share;
  }
  return {glm::vec3(light), static_cast<float>(1.0 - behind)};
}

TEST(Composite, SkippingEndingEarlyAndKeepingSamplesChangeNothingThatIsSeen) {
  // Two balls and a wall apart from each other, so that there is much to skip between.
  const GreyOctree grey = grey_of(
      [](const glm::dvec3& p) {
        const double one = 300.0 - 80.0 * std::abs(glm::distance(p, glm::dvec3(-6, -7, 4)) - 3.0);
        const double two = 500.0 - 90.0 * glm::distance(p, glm::dvec3(7, 5, -6));
        const double wall = 400.0 - 120.0 * std::abs(p.y - 13.0) - 60.0 * std::max(0.0, p.z);
        return std::max({one, two, wall, -200.0});
      },
      -200);
  const TransferFunction transfer{{{0.0, {0.9f, 0.3f, 0.2f}, 0.0},
                                   {150.0, {0.9f, 0.3f, 0.2f}, 0.4},
                                   {200.0, {0.2f, 0.4f, 0.9f}, 0.0},
                                   {250.0, {0.2f, 0.4f, 0.9f}, 0.0},
                                   {400.0, {0.9f, 0.9f, 0.6f}, 6.0}},
                                  100.0};
  for (const char* view : {"anterior", "35,25", "-120,-15"}) {
    const ImagePlane plane = plane_of(grey, view, 48, 44.0);
    const Composite image = composite(grey, plane, {transfer, {}, {}});
    int partly = 0, wholly = 0;
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 48; ++x) {
        const glm::vec4 truth = reference(grey, plane, transfer, {x + 0.5, y + 0.5});
        const glm::vec4& light = image.light[static_cast<std::size_t>(y * 48 + x)];
        for (int channel = 0; channel < 4; ++channel)
          ASSERT_NEAR(light[channel], truth[channel], 1.1 / 1024.0) << view << " " << x << ", " << y;
        partly += truth.w > 0.05f && truth.w < 0.9f;
        wholly += truth.w > 0.999f;
      }
    EXPECT_GT(partly, 100) << view;
    EXPECT_GT(wholly, 20) << view;
  }
}

TEST(Composite, OpacityFromDensityAndGradientIsTheRampTimesTheTransferFunctions) {
  // A ball whose inside is even: by its gradient only its shell is seen, and what is behind it.
  const GreyOctree grey = grey_of(
      [](const glm::dvec3& p) {
        const double ball = std::clamp(60.0 * (10.0 - glm::length(p)), -200.0, 300.0);
        return std::max(ball, 300.0 - 40.0 * glm::distance(p, glm::dvec3(0, 13, 0)));
      },
      -200);
  const TransferFunction transfer{
      {{0.0, {0.9f, 0.3f, 0.2f}, 0.0}, {100.0, {0.9f, 0.3f, 0.2f}, 0.03}, {300.0, green, 0.06}}, 100.0};
  for (const char* view : {"anterior", "35,25"}) {
    const ImagePlane plane = plane_of(grey, view);
    const Composite plain = composite(grey, plane, {transfer, {}, {}});
    CompositeOptions options{transfer, {}, {}};
    options.gradient = GradientOpacity{10.0, 50.0};
    const Composite image = composite(grey, plane, options);
    int lighter = 0;
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x) {
        const glm::vec4 truth = reference(grey, plane, transfer, {x + 0.5, y + 0.5}, glm::dvec2(10.0, 50.0));
        const auto pixel = static_cast<std::size_t>(y * 40 + x);
        for (int channel = 0; channel < 4; ++channel)
          ASSERT_NEAR(image.light[pixel][channel], truth[channel], 1.1 / 1024.0)
              << view << " " << x << ", " << y;
        lighter += image.light[pixel].w < plain.light[pixel].w - 0.1f;
      }
    EXPECT_GT(lighter, 50) << view;
  }
  for (const GradientOpacity bad : {GradientOpacity{-1.0, 5.0}, GradientOpacity{5.0, 5.0},
                                    GradientOpacity{0.0, INFINITY}, GradientOpacity{NAN, 5.0}}) {
    CompositeOptions options{transfer, {}, {}};
    options.gradient = bad;
    EXPECT_THROW(composite(grey, plane_of(grey, "left"), options), std::invalid_argument);
  }
}

TEST(Composite, ACutTakesAwayJustWhatItSays) {
  const GreyOctree grey = grey_of([](const glm::dvec3&) { return 500.0; }, 500);
  const ImagePlane plane = plane_of(grey, "anterior");
  // Of 31 mm, what is more than 4.25 mm behind the middle stays: 11.25 mm; a box takes another 5 of them.
  CompositeOptions options{even(0.1), {HalfSpace{{0, -1, 0}, -4.25}}, {}};
  const double whole = composite(grey, plane, {even(0.1), {}, {}}).light[20 * 40 + 20].w;
  EXPECT_NEAR(whole, 1.0 - std::exp(-3.1), 1e-5);
  EXPECT_NEAR(composite(grey, plane, options).light[20 * 40 + 20].w, 1.0 - std::exp(-1.125), 0.02);
  // The cut's face is lit as a face towards the observer, not as the samples in it would be.
  const Composite solid = composite(grey, plane, {even(20.0), {HalfSpace{{0, -1, 0}, -4.25}}, {}});
  double facing = Scenery{}.ambient;
  for (const Light& light : Scenery{}.lights)
    facing += light.strength * -glm::normalize(glm::dvec3(light.towards)).z;
  EXPECT_NEAR(solid.light[20 * 40 + 20].y / linear_from_srgb(green).y, facing, 1e-3);
  options.cuts.emplace_back(Box{{-5, 6, -5}, {5, 11, 5}});
  EXPECT_NEAR(composite(grey, plane, options).light[20 * 40 + 20].w, 1.0 - std::exp(-0.625), 0.04);
}

TEST(Composite, ShowsNothingBeyondTheScanEvenWhereItsBackgroundWouldShow) {
  // The scan fills the half of the universe to the patient's right.
  Lattice half = universe_about_origin(5).lattice();
  half.dims.x = 16;
  const GreyOctree grey =
      grey_octree_of(universe_about_origin(5),
                     tests::field_scene<std::int16_t>(half, [](const glm::dvec3&) { return 500.0; }), 500);
  const ImagePlane plane = plane_of(grey, "anterior");
  const Composite image = composite(grey, plane, {even(0.05), {}, {}});
  std::size_t seen = 0, missed = 0;
  for (int x = 0; x < 40; ++x) {
    const double side_mm = plane.lps_mm({x + 0.5, 20.5}, 0.0).x;
    const float light = image.light[static_cast<std::size_t>(40 * 20 + x)].w;
    if (side_mm > -15.0 && side_mm < -0.6) {
      EXPECT_NEAR(light, 1.0 - std::exp(-0.05 * 31.0), 1e-3) << side_mm;
      ++seen;
    } else if (side_mm > 0.6) {
      EXPECT_EQ(light, 0.0f) << side_mm;
      ++missed;
    }
  }
  EXPECT_GT(std::min(seen, missed), 10U);
}

TEST(Composite, IsTheSameOnOneThreadAndOnTwoAndStopsWhenAsked) {
  const GreyOctree grey = grey_of([](const glm::dvec3& p) { return 400.0 - 30.0 * glm::length(p); });
  const ImagePlane plane = plane_of(grey, "20,30", 64);
  std::vector<Composite> images;
  for (const std::size_t threads : {std::size_t{1}, std::size_t{2}}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    images.push_back(composite(grey, plane, {preset_transfer("bone"), {}, {}}));
  }
  EXPECT_EQ(images[0].light, images[1].light);
  EXPECT_EQ(images[0].depth_mm, images[1].depth_mm);
  EXPECT_EQ(over(images[0], glm::vec3(1.0f))[0], 255);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(composite(grey, plane, {preset_transfer("bone"), {}, {}}, {stop.get_token(), {}}), Stopped);
  EXPECT_THROW(composite(grey, plane, {}), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
