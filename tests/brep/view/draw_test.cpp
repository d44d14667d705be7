// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/view/draw.h"

#include <cmath>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "brep/view/corner_normals.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

/// Looks along y at 20 x 20 pixels of 1 mm about the origin.
DrawOptions small_picture(FacetShading shading) {
  DrawOptions options;
  options.camera.size_px = {20, 20};
  options.shading = shading;
  return options;
}

/// Two triangles in the plane y = depth, seen from the front.
Triangles square(double left, double right, double depth) {
  Triangles t;
  t.points_mm = {{left, depth, -5}, {right, depth, -5}, {right, depth, 5}, {left, depth, 5}};
  t.faces = {{0, 1, 2}, {0, 2, 3}};
  return t;
}

std::size_t pixel(int column, int row) {
  return static_cast<std::size_t>(20 * row + column);
}

std::uint8_t srgb_byte(float linear) {
  return static_cast<std::uint8_t>(std::lround(255.0f * srgb_of_linear(glm::vec3(linear)).x));
}

TEST(DrawFacets, PixelsOnAnEdgeOfTwoTrianglesBelongToOneOfThem) {
  // The edges at -5, 0.5 and 5 run through pixels' centres or between them; the diagonals through centres.
  const Triangles left = square(-5, 0.5, 0), right = square(0.5, 5, 0);
  const DrawnScene scene{{{&left, glm::vec3(1.0f)}, {&right, glm::vec3(1.0f)}}, {}, {}};
  const DrawnPicture picture = draw(scene, small_picture(FacetShading::Flat));
  EXPECT_EQ(picture.lit_pixels, 100u);
  EXPECT_EQ(std::count(picture.item.begin(), picture.item.end(), 0) +
                std::count(picture.item.begin(), picture.item.end(), 1),
            100);
  // All pixels of the column at 0.5 belong to one side.
  const int owner = picture.item[pixel(10, 10)];
  for (int row = 5; row < 15; ++row) EXPECT_EQ(picture.item[pixel(10, row)], owner) << row;
}

TEST(DrawFacets, ATiltedTriangleHasThePlanesDepthAndItsOneTone) {
  Triangles t;
  t.points_mm = {{-9, -4.5, -9}, {9, 4.5, -9}, {9, 4.5, 9}, {-9, -4.5, 9}};  // y = x / 2
  t.faces = {{0, 1, 2}, {0, 2, 3}};
  DrawOptions options = small_picture(FacetShading::Flat);
  options.camera.nearest_mm = -4.5;
  options.lighting = {{{{0, 0, -1}, 0.8f}}, 0.1f, 0.0f, 32.0f};
  const DrawnPicture picture = draw({{{&t, glm::vec3(1.0f)}}, {}, {}}, options);
  for (int column = 1; column < 19; ++column)
    EXPECT_NEAR(picture.depth_mm[pixel(column, 7)], (column - 9.5) / 2 + 4.5, 1e-5) << column;
  // The normal is (1, -2, 0) / sqrt(5): Lambert's law.
  const std::uint8_t tone = srgb_byte(0.1f + 0.8f * 2.0f / std::sqrt(5.0f));
  EXPECT_EQ(picture.rgb[3 * pixel(4, 4)], tone);
  EXPECT_EQ(picture.rgb[3 * pixel(15, 12) + 1], tone);
}

TEST(DrawFacets, GouraudMixesTheCornersTonesAndPhongTheirNormals) {
  // A ridge seen from the front: at the ridge the corners' normals face the observer.
  Triangles ridge;
  ridge.points_mm = {{-8, 8, -8}, {0, 0, -8}, {0, 0, 8}, {-8, 8, 8}, {8, 8, -8}, {8, 8, 8}};
  ridge.faces = {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
  const std::vector<glm::dvec3> normals = corner_normals(ridge);
  EXPECT_NEAR(normals[1].y, -1.0, 1e-12);
  EXPECT_NEAR(normals[0].y, -std::sqrt(0.5), 1e-12);
  const DrawnScene scene{{{&ridge, glm::vec3(1.0f)}}, {}, {}};
  DrawOptions options = small_picture(FacetShading::Gouraud);
  options.lighting = {{{{0, 0, -1}, 1.0f}}, 0.0f, 0.0f, 32.0f};
  const DrawnPicture gouraud = draw(scene, options);
  options.shading = FacetShading::Phong;
  const DrawnPicture phong = draw(scene, options);
  options.shading = FacetShading::Flat;
  const DrawnPicture flat = draw(scene, options);
  for (int column = 3; column < 10; ++column) {
    // Four points a pixel, at quarters; both models are nearly linear over a pixel.
    const double part = (column + 0.5 - 2.0) / 8.0;  // 0 at the foot, 1 at the ridge
    const double mixed = std::sqrt(0.5) * (1 - part) + part;
    const glm::dvec2 normal =
        glm::normalize(glm::dvec2(-std::sqrt(0.5), -std::sqrt(0.5)) * (1 - part) + glm::dvec2(0, -1) * part);
    EXPECT_NEAR(gouraud.rgb[3 * pixel(column, 9)], srgb_byte(static_cast<float>(mixed)), 1) << column;
    EXPECT_NEAR(phong.rgb[3 * pixel(column, 9)], srgb_byte(static_cast<float>(-normal.y)), 1) << column;
    EXPECT_EQ(flat.rgb[3 * pixel(column, 9)], srgb_byte(std::sqrt(0.5f))) << column;
  }
  EXPECT_EQ(gouraud.depth_mm, phong.depth_mm);
}

TEST(DrawFacets, AnOpenSurfaceIsDrawnFromBothSidesUnlessItIsCulled) {
  const Triangles front = square(-5, 5, 0);
  DrawOptions options = small_picture(FacetShading::Flat);
  options.cull = true;
  EXPECT_EQ(draw({{{&front, glm::vec3(1.0f)}}, {}, {}}, options).lit_pixels, 100u);
  options.camera.right = -options.camera.right;
  options.camera.look = -options.camera.look;
  const DrawnPicture culled = draw({{{&front, glm::vec3(1.0f)}}, {}, {}}, options);
  EXPECT_EQ(culled.lit_pixels, 0u);
  EXPECT_EQ(culled.culled, (std::vector<std::uint64_t>{2}));
  options.cull = false;
  const DrawnPicture back = draw({{{&front, glm::vec3(1.0f)}}, {}, {}}, options);
  EXPECT_EQ(back.lit_pixels, 100u);
  options.camera = small_picture(FacetShading::Flat).camera;
  EXPECT_EQ(back.rgb, draw({{{&front, glm::vec3(1.0f)}}, {}, {}}, options).rgb);
}

TEST(DrawFacets, AWireFrameShowsItsEdgesAndHidesWhatIsBehindOnlyIfAsked) {
  const Triangles near = square(-5, 5, 0), far = square(-3, 3, 4);
  const DrawnScene scene{{{&near, glm::vec3(0.0f)}, {&far, glm::vec3(0.0f)}}, {}, {}};
  DrawOptions options = small_picture(FacetShading::Wire);
  const auto far_pixels = [&] {
    const DrawnPicture picture = draw(scene, options);
    return std::count(picture.item.begin(), picture.item.end(), 1);
  };
  EXPECT_GT(far_pixels(), 20);
  options.hide = true;
  EXPECT_EQ(far_pixels(), 0);
  EXPECT_GT(draw(scene, options).lit_pixels, 30u);
}

TEST(DrawLines, ALineOnASurfaceShowsAndOneBehindItDoesNot) {
  const Triangles wall = square(-8, 8, 0);
  const auto line_at = [](double depth) {
    return std::vector<glm::dvec3>{{-4, depth, 0.5}, {4, depth, 0.5}};
  };
  const auto line_pixels = [&](double depth) {
    const DrawnPicture picture =
        draw({{{&wall, glm::vec3(1.0f)}}, {{{line_at(depth)}, glm::vec3(0.0f), 1.0}}, {}},
             small_picture(FacetShading::Flat));
    return std::count(picture.item.begin(), picture.item.end(), 1);
  };
  EXPECT_EQ(line_pixels(0.0), 10);  // from -4 to 4, and half a pixel at either end
  EXPECT_EQ(line_pixels(-3.0), 10);
  EXPECT_EQ(line_pixels(3.0), 0);
}

TEST(DrawSheets, APictureInSpaceShowsItsOwnTonesWhereItIsShown) {
  DrawnSheet sheet;
  sheet.first_mm = {-1.5, 2, 1.5};
  sheet.per_column = {3, 0, 0};
  sheet.per_row = {0, 0, -3};
  sheet.size_px = {2, 2};
  sheet.rgb = {10, 10, 10, 200, 200, 200, 90, 90, 90, 40, 40, 40};
  sheet.is_shown = {1, 1, 1, 0};
  const DrawnPicture picture = draw({{}, {}, {sheet}}, small_picture(FacetShading::Flat));
  EXPECT_EQ(picture.lit_pixels, 27u);
  EXPECT_EQ(picture.rgb[3 * pixel(8, 8)], 10);
  EXPECT_EQ(picture.rgb[3 * pixel(11, 8)], 200);
  EXPECT_EQ(picture.rgb[3 * pixel(8, 11)], 90);
  EXPECT_EQ(picture.item[pixel(11, 11)], -1);
  EXPECT_FLOAT_EQ(picture.depth_mm[pixel(8, 8)], 2.0f);
}

TEST(DrawFacets, AnObserverSeesNearThingsLargerAndNothingBehind) {
  const Triangles sphere = shapes::sphere({0, 0, 0}, 6, 4);
  const DrawnScene scene{{{&sphere, glm::vec3(1.0f)}}, {}, {}};
  DrawOptions options = small_picture(FacetShading::Phong);
  options.camera.size_px = {200, 200};
  options.camera.pixel_mm = 0.1;
  options.camera.nearest_mm = -6;
  const double flat_area = static_cast<double>(draw(scene, options).lit_pixels) * 0.01;
  EXPECT_NEAR(flat_area, 36 * std::numbers::pi, 0.4);
  options.camera.observer = Observer{20.0, 6.0};
  // Rays that touch the ball lie on a cone: their radius in the plane through the middle.
  const double radius = 6 * 20 / std::sqrt(400.0 - 36.0);
  EXPECT_NEAR(static_cast<double>(draw(scene, options).lit_pixels) * 0.01, radius * radius * std::numbers::pi,
              0.4);
  const glm::dvec3 p(1.2, -3.0, 2.5);
  EXPECT_LT(
      glm::distance(options.camera.lps_mm(options.camera.position_px(p), options.camera.depth_mm(p)), p),
      1e-12);
  // From inside, all rays end on the ball.
  options.camera.observer = Observer{3.0, 6.0};
  const DrawnPicture inside = draw(scene, options);
  EXPECT_EQ(inside.lit_pixels, 40000u);
  for (const float depth : inside.depth_mm) ASSERT_GT(depth, 3.0f);
}

TEST(DrawFacets, ThePictureIsTheSameOnOneThreadAndOnMany) {
  const Triangles a = shapes::sphere({0, 0, 0}, 8, 3), b = shapes::box({-4, -9, -4}, {9, 3, 2});
  DrawnScene scene{{{&a, glm::vec3(0.9f)}, {&b, glm::vec3(0.2f, 0.5f, 0.9f)}}, {}, {}};
  scene.lines.push_back({{{{-9, -9, -9}, {9, 9, 9}, {9, -9, 2}}}, glm::vec3(0.0f), 1.5});
  DrawOptions options = small_picture(FacetShading::Phong);
  options.camera.size_px = {150, 130};
  options.camera.pixel_mm = 0.15;
  const DrawnPicture many = draw(scene, options);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const DrawnPicture alone = draw(scene, options);
  EXPECT_EQ(many.rgb, alone.rgb);
  EXPECT_EQ(many.item, alone.item);
  EXPECT_EQ(many.depth_mm, alone.depth_mm);
}

TEST(DrawFacets, APictureWithoutPixelsIsRefused) {
  DrawOptions options;
  options.camera.size_px = {0, 5};
  EXPECT_THROW(draw({}, options), InvalidInput);
  options.camera.size_px = {5, 5};
  options.camera.pixel_mm = 0.0;
  EXPECT_THROW(draw({}, options), InvalidInput);
}

}  // namespace
}  // namespace octotomy::brep
