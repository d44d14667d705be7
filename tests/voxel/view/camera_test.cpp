// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Pictures from an eye at a finite distance, and from two.
#include "voxel/view/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "tests/voxel/spaced_universe.h"
#include "voxel/solid/combine.h"
#include "voxel/view/annotation.h"
#include "voxel/view/mark.h"
#include "voxel/view/render.h"

namespace octotomy::voxel {
namespace {

Universe universe_of_64_mm() {
  return tests::spaced_universe(7, glm::dvec3(0.5), {-20.0, -35.0, 10.0});
}
glm::dvec3 middle_mm() {
  const Box box = bounds(universe_of_64_mm().lattice());
  return 0.5 * (box.low_mm + box.high_mm);
}
DrawnObject drawn_ball(const glm::dvec3& centre_mm, double radius_mm) {
  return {"ball", combine(universe_of_64_mm(), Sphere{centre_mm, radius_mm})};
}

RenderOptions options_of(const char* view, double eye_mm) {
  RenderOptions options;
  options.view = parse_view(view);
  options.size_px = glm::ivec2(200);
  options.centre_mm = options.view.project(middle_mm());
  options.width_mm = 100.0;
  options.eye_mm = eye_mm;
  return options;
}

TEST(Camera, RaysOfAnEyePassThePointsThatTheirPixelsShow) {
  for (const char* view : {"anterior", "35,15", "-120,-40"}) {
    const View axes = parse_view(view);
    const ImagePlane plane = seen_from(image_plane(universe_of_64_mm(), axes, {200, 150},
                                                   {axes.project(middle_mm()) + glm::dvec2(3, -2), 90.0}),
                                       150.0);
    const VoxelRays rays = voxel_rays(universe_of_64_mm(), plane);
    for (const glm::dvec2& p_px : {glm::dvec2(0.0), glm::dvec2(13.5, 140.5), glm::dvec2(200.0, 75.0)})
      for (const double depth_mm : {0.0, 17.0, 80.0}) {
        const glm::dvec3 p_mm = plane.lps_mm(p_px, depth_mm);
        const glm::dvec3 p_voxel = rays.start(p_px) + depth_mm * rays.direction(p_px);
        EXPECT_LT(glm::distance(universe_of_64_mm().lattice().lps_mm(p_voxel), p_mm), 1e-9) << view;
        EXPECT_LT(glm::distance(pixel_position(plane, p_mm), p_px), 1e-9) << view;
        // All meet in the eye.
        const glm::dvec3 eye_mm = plane.lps_mm({0, 0}, plane.eye->depth_mm());
        EXPECT_LT(glm::distance(plane.lps_mm(p_px, plane.eye->depth_mm()), eye_mm), 1e-9);
      }
  }
}

TEST(Camera, ABallIsAsLargeAsItsConeOfSightWhereverTheEyeIs) {
  const double radius_mm = 18.0;
  for (const char* view : {"anterior", "35,15"})
    for (const double eye_mm : {60.0, 200.0, 5000.0}) {
      const Picture picture = render({drawn_ball(middle_mm(), radius_mm)}, options_of(view, eye_mm));
      // Its outline is where lines of sight touch it, at an angle whose sine is radius / distance.
      const double outline_mm = eye_mm * std::tan(std::asin(radius_mm / eye_mm));
      const double expected_px =
          std::numbers::pi * outline_mm * outline_mm / (picture.pixel_mm * picture.pixel_mm);
      // Voxels' corners reach beyond the ball by at most half a diagonal.
      const double edge_px =
          2.0 * std::numbers::pi * outline_mm * 0.45 / (picture.pixel_mm * picture.pixel_mm);
      EXPECT_NEAR(static_cast<double>(picture.lit_pixels), expected_px, edge_px) << view << " " << eye_mm;
      int on_ball = 0;
      for (int y = 0; y < 200; y += 7)
        for (int x = 0; x < 200; x += 7)
          if (const auto p_mm = picture.point_mm({x, y})) {
            EXPECT_NEAR(glm::distance(*p_mm, middle_mm()), radius_mm, 0.5) << view << " " << eye_mm;
            ++on_ball;
          }
      EXPECT_GT(on_ball, 50);
    }
}

TEST(Camera, OfTwoEqualBallsTheNearerIsLargerAndNothingBehindTheEyeIsSeen) {
  const View view = parse_view("anterior");
  const DrawnObject near = drawn_ball(middle_mm() - 20.0 * view.look - 15.0 * view.right, 6.0);
  const DrawnObject far = drawn_ball(middle_mm() + 20.0 * view.look + 15.0 * view.right, 6.0);
  const auto pixels_of = [&](double eye_mm) {
    const Picture picture = render({near, far}, options_of("anterior", eye_mm));
    return std::array<std::ptrdiff_t, 2>{std::count(picture.object.begin(), picture.object.end(), 0),
                                         std::count(picture.object.begin(), picture.object.end(), 1)};
  };
  const auto [near_px, far_px] = pixels_of(80.0);
  EXPECT_NEAR(static_cast<double>(near_px) / static_cast<double>(far_px), std::pow(100.0 / 60.0, 2.0), 0.35);
  EXPECT_EQ(pixels_of(10.0)[0], 0);
  EXPECT_GT(pixels_of(10.0)[1], 0);
}

TEST(Camera, NodeTracingRefusesAnEye) {
  RenderOptions options = options_of("anterior", 100.0);
  options.algorithm = Algorithm::NodeTrace;
  EXPECT_THROW(render({drawn_ball(middle_mm(), 9.0)}, options), std::invalid_argument);
  options.algorithm.reset();
  options.eye_mm = -1.0;
  EXPECT_THROW(render({drawn_ball(middle_mm(), 9.0)}, options), std::invalid_argument);
}

TEST(Camera, ViewsThatAreNoFrameAreRefused) {
  RenderOptions options = options_of("20,10", 100.0);
  EXPECT_TRUE(is_frame(options.view));
  options.view.right = -options.view.right;
  EXPECT_THROW(render({drawn_ball(middle_mm(), 9.0)}, options), std::invalid_argument);
  options.view = parse_view("anterior");
  options.view.right.x = std::nan("");
  EXPECT_FALSE(is_frame(options.view));
  EXPECT_THROW(render({drawn_ball(middle_mm(), 9.0)}, options), std::invalid_argument);
}

TEST(Camera, PicturesInPerspectiveBearNoScale) {
  RenderOptions options = options_of("anterior", 100.0);
  const auto changed_by_annotation = [&] {
    Picture picture = render({drawn_ball(middle_mm(), 9.0)}, options);
    const std::vector<std::uint8_t> before = picture.rgb;
    Annotation scale_only;
    scale_only.sides = false;
    annotate(picture.rgb, picture.plane(), scale_only);
    return picture.rgb != before;
  };
  EXPECT_FALSE(changed_by_annotation());
  options.eye_mm.reset();
  EXPECT_TRUE(changed_by_annotation());
}

TEST(Camera, TheLeftEyeSeesWhatIsNearerFartherToTheRight) {
  const View view = parse_view("20,10");
  const auto [left, right] = stereo_pair(view, 6.0);
  EXPECT_NEAR(glm::degrees(std::acos(glm::dot(left.look, right.look))), 6.0, 1e-9);
  const auto across = [&](const View& eye, const glm::dvec3& p_mm) { return eye.project(p_mm).x; };
  const glm::dvec3 near_mm = -30.0 * view.look, far_mm = 30.0 * view.look;
  EXPECT_GT(across(left, near_mm), across(right, near_mm));
  EXPECT_LT(across(left, far_mm), across(right, far_mm));
  for (const View& eye : {left, right}) {
    EXPECT_LT(glm::distance(glm::cross(eye.look, eye.up), eye.right), 1e-12);
    EXPECT_LT(glm::distance(eye.up, view.up), 1e-12);
  }
}

}  // namespace
}  // namespace octotomy::voxel
