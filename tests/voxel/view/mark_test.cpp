// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/mark.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "voxel/solid/combine.h"
#include "voxel/view/render.h"

namespace octotomy::voxel {
namespace {

ImagePlane plane_of(const std::string& view) {
  return {parse_view(view), {640, 480}, {3.0, -7.0}, 0.4, -120.0, 300.0};
}

TEST(Mark, APointSeenInTwoViewsIsFoundAgainFromItsPixels) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-80.0, 80.0), turn(-180.0, 180.0), lift(-80.0, 80.0);
    const glm::dvec3 truth(place(random), place(random), place(random));
    const ImagePlane one = plane_of(std::to_string(turn(random)) + "," + std::to_string(lift(random)));
    const ImagePlane two = plane_of(std::to_string(turn(random)) + "," + std::to_string(lift(random)));
    if (glm::length(glm::cross(one.view.look, two.view.look)) < 0.1) continue;
    const SpaceMark mark = mark_between(sight_line(one, pixel_position(one, truth)),
                                        sight_line(two, pixel_position(two, truth)));
    EXPECT_NEAR(glm::distance(mark.point_mm, truth), 0.0, 1e-9) << "seed " << seed;
    EXPECT_NEAR(mark.miss_mm, 0.0, 1e-9) << "seed " << seed;
  }
}

TEST(Mark, MarksThatContradictEachOtherMissByTheirDifferenceAndMeetHalfway) {
  // From the front the point is 10 mm up, from the left 16 mm up.
  const SpaceMark mark = mark_between(sight_line(parse_view("anterior"), {5.0, 10.0}),
                                      sight_line(parse_view("left"), {-20.0, 16.0}));
  EXPECT_NEAR(glm::distance(mark.point_mm, glm::dvec3(5.0, -20.0, 13.0)), 0.0, 1e-12);
  EXPECT_NEAR(mark.miss_mm, 6.0, 1e-12);
  // The twin without the contradiction does not miss.
  EXPECT_NEAR(mark_between(sight_line(parse_view("anterior"), {5.0, 10.0}),
                           sight_line(parse_view("left"), {-20.0, 10.0}))
                  .miss_mm,
              0.0, 1e-12);
}

TEST(Mark, ViewsThatLookTheSameWayOrOppositeWaysAreRefused) {
  const SightLine front = sight_line(parse_view("anterior"), {0.0, 0.0});
  EXPECT_THROW(mark_between(front, sight_line(parse_view("5,0"), {0.0, 0.0})), std::invalid_argument);
  EXPECT_THROW(mark_between(front, sight_line(parse_view("posterior"), {0.0, 0.0})), std::invalid_argument);
  EXPECT_NO_THROW(mark_between(front, sight_line(parse_view("6,0"), {0.0, 0.0})));
}

TEST(Mark, ALineOfSightPassesThroughThePointThatItsPixelShows) {
  const Universe universe = universe_around({glm::dvec3(-32.0), glm::dvec3(32.0)}, 1.0);
  RenderOptions options;
  options.view = parse_view("40,-25");
  options.size_px = {90, 70};
  const Picture picture =
      render({{"ball", combine(universe, Expression(Sphere{{5.0, -3.0, 8.0}, 15.0}))}}, options);
  int lit = 0;
  for (int y = 0; y < 70; y += 7)
    for (int x = 0; x < 90; x += 9) {
      const auto point = picture.point_mm({x, y});
      if (!point) continue;
      ++lit;
      const SightLine line = sight_line(picture.plane(), {x + 0.5, y + 0.5});
      EXPECT_NEAR(glm::length(glm::cross(*point - line.start_mm, line.direction)), 0.0, 1e-9);
      EXPECT_GT(glm::dot(*point - line.start_mm, line.direction), 0.0);
      EXPECT_NEAR(glm::distance(pixel_position(picture.plane(), *point), {x + 0.5, y + 0.5}), 0.0, 1e-9);
    }
  EXPECT_GT(lit, 20);
}

}  // namespace
}  // namespace octotomy::voxel
