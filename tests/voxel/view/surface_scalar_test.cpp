// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/surface_scalar.h"

#include <gtest/gtest.h>

#include "tests/unit_universe.h"
#include "tests/voxel/view/ball.h"
#include "voxel/solid/combine.h"
#include "voxel/view/lab.h"
#include "voxel/view/render.h"
#include "voxel/view/srgb.h"

namespace octotomy::voxel {
namespace {

using tests::ball;
using tests::universe_about_origin;

/// How a reader without a kind of cone sees a colour (Vienot, Brettel, Mollon 1999), linear light.
glm::vec3 without_green_cones(const glm::vec3& srgb) {
  const glm::vec3 l = linear_from_srgb(srgb);
  const float red_green = 0.29275f * l.x + 0.70725f * l.y;
  const float blue = -0.02234f * l.x + 0.02234f * l.y + l.z;
  return {srgb_from_linear(red_green), srgb_from_linear(red_green),
          srgb_from_linear(glm::clamp(blue, 0.0f, 1.0f))};
}

TEST(DivergingColour, EndsAreEquallyDarkAndApartForReadersOfAnyColourVision) {
  const glm::vec3 low = diverging_colour(-1.0), middle = diverging_colour(0.0), high = diverging_colour(1.0);
  EXPECT_NEAR(lab_from_srgb(low).x, lab_from_srgb(high).x, 1.0);
  EXPECT_GT(low.z, low.x);
  EXPECT_GT(high.x, high.z);
  const auto apart = [](const glm::vec3& a, const glm::vec3& b) {
    return glm::distance(lab_from_srgb(without_green_cones(a)), lab_from_srgb(without_green_cones(b)));
  };
  EXPECT_GT(apart(low, high), 60.0);
  EXPECT_GT(apart(low, middle), 40.0);
  EXPECT_GT(apart(high, middle), 40.0);
  // The twin that is not safe: red and green of one lightness.
  EXPECT_LT(apart({0.76f, 0.32f, 0.22f}, {0.36f, 0.53f, 0.20f}), 20.0);
}

TEST(DivergingColour, GrowsDarkerEvenlyFromTheMiddleAndStopsAtTheEnds) {
  for (int i = 0; i < 10; ++i)
    for (const double sign : {-1.0, 1.0}) {
      const double nearer = lab_from_srgb(diverging_colour(sign * i / 10.0)).x;
      const double farther = lab_from_srgb(diverging_colour(sign * (i + 1) / 10.0)).x;
      EXPECT_NEAR(nearer - farther, 5.2, 0.5) << sign * i;
    }
  EXPECT_EQ(diverging_colour(7.0), diverging_colour(1.0));
  EXPECT_EQ(diverging_colours(3)[1], diverging_colour(0.0));
}

TEST(SurfaceScalar, DistancesToABallAreThoseOfItsRadiusAndNegativeInside) {
  const SurfaceScalar scalar = distance_to(ball(glm::dvec3(0.0), 12.0), ball(glm::dvec3(0.0), 20.0), 10.0);
  int asked = 0;
  for (double x = -18.0; x <= 18.0; x += 3.7)
    for (double y = -18.0; y <= 18.0; y += 3.1) {
      const glm::dvec3 p_mm(x, y, 2.3);
      const double r = glm::length(p_mm);
      if (r < 6.0 || r > 20.0) continue;
      ++asked;
      // Centres of voxels on either side of the surface are up to half a diagonal off it.
      EXPECT_NEAR(scalar.at(universe_about_origin(6).lattice().voxel(p_mm)), r - 12.0, 0.87)
          << x << ", " << y;
    }
  EXPECT_GT(asked, 50);
}

TEST(SurfaceScalar, ABallMovedToTheLeftIsOrangeAtItsLeftAndBlueAtItsRight) {
  const Octree before = ball(glm::dvec3(0.0), 18.0), after = ball({4.0, 0.0, 0.0}, 18.0);
  DrawnObject object{"after", after};
  object.scalar = std::make_shared<const SurfaceScalar>(distance_to(before, after, 4.0));
  RenderOptions options;
  options.view = parse_view("anterior");
  options.size_px = {80, 80};
  options.centre_mm = glm::dvec2(0.0);
  options.width_mm = 64.0;
  options.antialias = false;
  const Picture picture = render({object}, options);
  // Two thirds of the radius to the patient's left of its centre, which is right in the picture; and right.
  const auto colour = [&](int x) {
    const std::uint8_t* rgb = &picture.rgb[3 * static_cast<std::size_t>(40 * 80 + x)];
    return glm::ivec3(rgb[0], rgb[1], rgb[2]);
  };
  const glm::ivec3 left = colour(40 + 5 + 15), right = colour(40 + 5 - 15), middle = colour(44);
  EXPECT_GT(left.x, left.z + 30);
  EXPECT_GT(right.z, right.x + 30);
  EXPECT_LT(std::abs(middle.x - middle.z), 40);
  // Swapped, it is the other way round: the sign is the other's inside.
  object.octree = before;
  object.scalar = std::make_shared<const SurfaceScalar>(distance_to(after, before, 4.0));
  const Picture swapped = render({object}, options);
  const std::uint8_t* rgb = &swapped.rgb[3 * static_cast<std::size_t>(40 * 80 + 40 + 15)];
  EXPECT_GT(rgb[2], rgb[0] + 30);
}

TEST(SurfaceScalar, RefusesEmptyObjectsOtherUniversesAndRangesOfNothing) {
  const Octree some = ball(glm::dvec3(0.0), 9.0);
  EXPECT_THROW(distance_to(some, some, 0.0), std::invalid_argument);
  EXPECT_THROW(distance_to(Octree::empty(universe_about_origin(6)), some, 1.0), std::invalid_argument);
  EXPECT_THROW(distance_to(Octree::full(Universe()), some, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
