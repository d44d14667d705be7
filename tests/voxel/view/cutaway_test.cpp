// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/cutaway.h"

#include <cmath>
#include <gtest/gtest.h>

#include "tests/unit_universe.h"
#include "tests/voxel/all_samples.h"
#include "tests/voxel/dense.h"
#include "tests/voxel/view/ball.h"
#include "voxel/solid/combine.h"
#include "voxel/view/render.h"

namespace octotomy::voxel {
namespace {

using tests::universe_about_origin;

Octree whole_ball() {
  return tests::ball(glm::dvec3(0.0), 24.0);
}

RenderOptions options_for(const std::string& view, Algorithm algorithm) {
  RenderOptions options;
  options.view = parse_view(view);
  options.size_px = {96, 96};
  options.centre_mm = glm::dvec2(0.0);
  options.width_mm = 64.0;
  options.algorithm = algorithm;
  return options;
}

/// Depth, from the plane of depth 0 of a picture, at which a pixel's ray meets a plane.
double depth_of_plane(const Picture& picture, const glm::ivec2& pixel, const HalfSpace& plane) {
  const glm::dvec2 p_mm =
      picture.centre_mm + picture.pixel_mm * glm::dvec2(pixel.x + 0.5 - 48.0, 48.0 - 0.5 - pixel.y);
  const glm::dvec3 start =
      picture.view.right * p_mm.x + picture.view.up * p_mm.y + picture.view.look * picture.nearest_mm;
  return (plane.offset_mm - glm::dot(plane.normal, start)) / glm::dot(plane.normal, picture.view.look);
}

class Cuts : public testing::TestWithParam<Algorithm> {};

TEST_P(Cuts, AnObliqueFaceIsFlatToTheLastPlaceWhereItsVoxelsAreSteps) {
  // Towards the observer, the patient's left and the head.
  const HalfSpace kept{glm::normalize(glm::dvec3(0.4, -1.0, 0.3)), 5.0};
  RenderOptions options = options_for("anterior", GetParam());
  options.cuts = {kept};
  const Picture flat = render({{"ball", whole_ball()}}, options);
  options.cuts.clear();
  const Octree stepped_ball = combine(universe_about_origin(6), Expression(whole_ball()) & Expression(kept));
  const Picture stepped = render({{"ball", stepped_ball}}, options);
  EXPECT_EQ(flat.object, stepped.object);
  int faces = 0;
  double flat_error = 0.0, step_error = 0.0;
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) {
      const auto point = flat.point_mm({x, y});
      // The face's disc, without its rim.
      if (!point || std::abs(glm::dot(kept.normal, *point) - 5.0) > 0.9 || glm::length(*point) > 22.5)
        continue;
      ++faces;
      const std::size_t pixel = static_cast<std::size_t>(y * 96 + x);
      const double truth = depth_of_plane(flat, {x, y}, kept);
      flat_error = std::max(flat_error, std::abs(flat.depth_mm[pixel] - truth));
      step_error = std::max(step_error, std::abs(stepped.depth_mm[pixel] - truth));
    }
  EXPECT_GT(faces, 1500);
  EXPECT_LT(flat_error, 1e-4);
  // The twin that does not know the plane: steps, also where columns are averaged.
  EXPECT_GT(step_error, 0.25);
}

INSTANTIATE_TEST_SUITE_P(All, Cuts,
                         testing::Values(Algorithm::NodeTrace, Algorithm::RayCast, Algorithm::FrontToBack));

TEST(Cutaway, APlaneTakesAwayTheNormalsSideAndABoxWhatIsInIt) {
  const Octree left_half =
      combine(universe_about_origin(6), without(Expression(whole_ball()), {HalfSpace{{-1, 0, 0}, 0.0}}));
  EXPECT_TRUE(left_half.contains({40, 32, 32}));
  EXPECT_FALSE(left_half.contains({20, 32, 32}));
  const Octree hollow =
      combine(universe_about_origin(6), without(Expression(whole_ball()), {Box{{0, -40, 0}, {40, 0, 40}}}));
  EXPECT_FALSE(hollow.contains({40, 24, 40}));
  EXPECT_TRUE(hollow.contains({40, 40, 40}));
  EXPECT_TRUE(hollow.contains({24, 24, 40}));
}

TEST(Cutaway, ABoxesFarFacesAreWhereTheBoxEndsWhereverThatIsInAVoxel) {
  // The box ends 0.3 mm off the middle of a voxel; the voxels' face lies 0.2 mm from there.
  RenderOptions options = options_for("anterior", Algorithm::NodeTrace);
  options.cuts = {Box{{-10, -40, -10}, {10, 3.2, 10}}};
  const Picture picture = render({{"ball", whole_ball()}}, options);
  const auto point = picture.point_mm({48, 48});
  ASSERT_TRUE(point.has_value());
  EXPECT_NEAR(point->y, 3.2, 1e-4);
  // Beside the box the ball is as it was.
  const auto beside = picture.point_mm({48 + 24, 48});
  ASSERT_TRUE(beside.has_value());
  EXPECT_NEAR(beside->y, -std::sqrt(24.0 * 24.0 - beside->x * beside->x), 1.0);
}

TEST(Cutaway, FacesFacingAwayAreLeftAsTheyAre) {
  // What is kept ends behind: seen from before, no pixel shows the plane.
  RenderOptions options = options_for("anterior", Algorithm::NodeTrace);
  const Picture whole = render({{"ball", whole_ball()}}, options);
  options.cuts = {HalfSpace{{0, 1, 0}, 0.0}};
  const Picture half = render({{"ball", whole_ball()}}, options);
  EXPECT_EQ(half.depth_mm, whole.depth_mm);
  EXPECT_EQ(half.object, whole.object);
}

TEST(Cutaway, GreyFacesShowTheSamplesThatAreThereAndNothingElseIsPainted) {
  const Universe universe = universe_about_origin(6);
  // Samples grow by 10 a millimetre towards the patient's left.
  Scene scene;
  scene.lattice = universe.lattice();
  Int16Samples samples;
  for (std::size_t i = 0; i < scene.lattice.sample_count(); ++i)
    samples.push_back(static_cast<std::int16_t>(10.0 * (static_cast<double>(i % 64) - 31.5)));
  scene.samples = std::move(samples);
  RenderOptions options = options_for("anterior", Algorithm::NodeTrace);
  options.antialias = false;
  options.cuts = {HalfSpace{glm::normalize(glm::dvec3(0, -1.0, 0.2)), 3.0}};
  options.cut_tones = CutTones{tests::all_samples(grey_octree_of(universe, scene)), -320.0, 320.0};
  const DrawnObject red{"ball", whole_ball(), {0.9f, 0.1f, 0.1f}};
  const Picture picture = render({red}, options);
  int painted = 0;
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) {
      const auto point = picture.point_mm({x, y});
      if (!point) continue;
      const std::uint8_t* rgb = &picture.rgb[3 * static_cast<std::size_t>(y * 96 + x)];
      const double off = std::abs(glm::dot(std::get<HalfSpace>(options.cuts[0]).normal, *point) - 3.0);
      if (off < 1e-4) {
        ++painted;
        const double tone = std::lround(255.0 * (10.0 * point->x + 320.0) / 640.0);
        ASSERT_NEAR(rgb[0], tone, 1.0) << x << ", " << y;
        ASSERT_EQ(rgb[0], rgb[1]);
        ASSERT_EQ(rgb[0], rgb[2]);
      } else {
        ASSERT_GT(rgb[0], rgb[1]) << "at " << x << ", " << y;
      }
    }
  EXPECT_GT(painted, 1500);
}

TEST(Cutaway, RefusesNormalsThatAreNoneAndSamplesOfAnotherUniverse) {
  EXPECT_THROW(without(Expression(whole_ball()), {HalfSpace{{0, 0, 2}, 0.0}}), std::invalid_argument);
  RenderOptions options = options_for("anterior", Algorithm::NodeTrace);
  options.cuts = {HalfSpace{}};
  const Universe other{3, glm::dmat4(1.0)};
  options.cut_tones = CutTones{tests::all_samples(grey_octree_of_bricks(other, 0, {}, {})), 0.0, 1.0};
  EXPECT_THROW(render({{"ball", whole_ball()}}, options), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
