// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/picture_frame.h"

#include <gtest/gtest.h>

#include "tests/planner/ball_scan.h"

namespace octotomy::planner {
namespace {

voxel::ImagePlane plane_of(const std::string& view) {
  return {voxel::parse_view(view), {20, 10}, {7.0, -3.0}, 0.5, -80.0, 0.0};
}

TEST(PictureFrameTest, PixelsLieWhereThePlaneSays) {
  for (const char* view : {"anterior", "posterior", "left", "right", "superior", "inferior", "35,15",
                           "-120,-40", "30,90", "-45,-90"}) {
    const voxel::ImagePlane plane = plane_of(view);
    const PictureFrame frame = frame_of(plane);
    const glm::dvec2 shown_mm(frame.view_mm_from_pixel() * glm::dvec3(4.0, 9.0, 1.0));
    EXPECT_LT(glm::distance(shown_mm, plane.view_mm({4.5, 9.5})), 1e-9) << view;
    EXPECT_EQ(name_of(frame.view()), view);
  }
}

TEST(PictureFrameTest, GoesWithTheFile) {
  const tests::ScratchFolder folder;
  const PictureFrame frame = frame_of(plane_of("35,15"));
  voxel::write_image(folder / "a.png", {20, 10}, std::vector<std::uint8_t>(600, 9), image_text(frame));
  const PictureFrame read = read_frame(folder / "a.png");
  EXPECT_EQ(read.size_px, frame.size_px);
  EXPECT_EQ(read.lps_from_pixel, frame.lps_from_pixel);
}

TEST(PictureFrameTest, RefusesPicturesWithoutOneOrOfAnotherSize) {
  const tests::ScratchFolder folder;
  const auto refusal = [&](const char* name) -> std::string {
    try {
      read_frame(folder / name);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  const std::vector<std::uint8_t> rgb(600, 9);
  voxel::write_image(folder / "none.png", {20, 10}, rgb);
  EXPECT_NE(refusal("none.png").find("none.png: "), std::string::npos);
  voxel::write_image(folder / "scaled.png", {10, 20}, rgb, image_text(frame_of(plane_of("left"))));
  EXPECT_NE(refusal("scaled.png").find("was 20 x 10 pixels when it was drawn and is 10 x 20"),
            std::string::npos);
  voxel::ImageText text = image_text(frame_of(plane_of("left"))).value();
  text.text.resize(60);
  voxel::write_image(folder / "cut.png", {20, 10}, rgb, text);
  EXPECT_NE(refusal("cut.png").find("cannot be read"), std::string::npos);
  voxel::write_image(folder / "a.jpg", {20, 10}, rgb);
  EXPECT_NE(refusal("a.jpg").find("is no PNG"), std::string::npos);
  PictureFrame flat = frame_of(plane_of("left"));
  flat.lps_from_pixel[1] = flat.lps_from_pixel[0];
  voxel::write_image(folder / "flat.png", {20, 10}, rgb, image_text(flat));
  EXPECT_NE(refusal("flat.png").find("flat.png: "), std::string::npos);
}

TEST(PictureFrameTest, AViewTurnedInItsPlaneHasNoName) {
  voxel::View view = voxel::parse_view("left");
  std::swap(view.up, view.right);
  view.right = -view.right;
  EXPECT_EQ(name_of(view), "");
}

}  // namespace
}  // namespace octotomy::planner
