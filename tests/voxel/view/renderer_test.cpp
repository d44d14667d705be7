// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/renderer.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "tests/unit_universe.h"
#include "tests/voxel/all_samples.h"
#include "tests/voxel/field_scene.h"
#include "tests/voxel/view/ball.h"
#include "voxel/solid/combine.h"

namespace octotomy::voxel {
namespace {

using tests::ball;
using tests::universe_about_origin;

/// Samples that fall with the distance from the middle: 0 at 18 mm.
GreyOctree grey_ball() {
  return grey_octree_of(
      universe_about_origin(6),
      tests::field_scene<std::int16_t>(universe_about_origin(6).lattice(), [](const glm::dvec3& p_mm) {
        return 50.0 * (18.0 - glm::length(p_mm));
      }));
}

DrawnObject drawn_from(const GreyOctree& grey, double low) {
  DrawnObject object{"window", combine(grey.universe(), Expression(Window{grey, low}))};
  object.grey = grey;
  object.threshold = low;
  return object;
}

RenderOptions options_for(const std::string& view) {
  RenderOptions options;
  options.view = parse_view(view);
  options.size_px = {90, 70};
  options.centre_mm = glm::dvec2(0.0);
  options.width_mm = 90.0;
  return options;
}

void expect_same(const Picture& a, const Picture& b, const std::string& what) {
  EXPECT_EQ(a.rgb, b.rgb) << what;
  EXPECT_EQ(a.depth_mm, b.depth_mm) << what;
  EXPECT_EQ(a.object, b.object) << what;
  EXPECT_EQ(a.lit_pixels, b.lit_pixels) << what;
}

/// One change of a scene as a user makes it; returns its name.
std::string change(std::mt19937& random, const GreyOctree& grey, std::vector<DrawnObject>& objects,
                   RenderOptions& options) {
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  DrawnObject& object = objects[static_cast<std::size_t>(below(static_cast<int>(objects.size())))];
  switch (below(9)) {
    case 0:
      object.colour = glm::vec3(below(10), below(10), below(10)) / 10.0f;
      return "colour";
    case 1:
      object.opacity = 0.5f * static_cast<float>(below(3));
      return "opacity";
    case 2:
      objects[1].octree = ball(glm::dvec3(below(30) - 15, below(30) - 15, below(30) - 15), 6.0 + below(6));
      return "move";
    case 3: {
      const float opacity = objects[0].opacity;
      objects[0] = drawn_from(grey, 50.0 * below(6));
      objects[0].opacity = opacity;
      return "window";
    }
    case 4:
      options.view = parse_view(below(2) == 0 ? "left" : std::to_string(below(360)) + ",20");
      return "view";
    case 5:
      options.shading = static_cast<Shading>(below(7));
      return "shading";
    case 6:
      options.cuts.clear();
      if (below(3) > 0)
        options.cuts.emplace_back(HalfSpace{glm::normalize(glm::dvec3(1, -1, 1)), below(20) - 10.0});
      return "cut";
    case 7:
      options.cut_tones.reset();
      if (below(2) == 0) options.cut_tones = CutTones{tests::all_samples(grey), -500.0, 900.0 + below(3)};
      return "tones";
    default:
      options.lights = {Light{glm::vec3(below(5) - 2, below(5) - 2, -2), 0.9f}};
      return "light";
  }
}

TEST(Renderer, FramesThatReuseAreTheSameBitsAsFramesFromNothing) {
  const GreyOctree grey = grey_ball();
  std::uint64_t kept = 0, drawn = 0, same = 0, different = 0;
  for (unsigned seed = 0; seed < 6; ++seed) {
    std::mt19937 random(seed);
    std::vector<DrawnObject> objects{drawn_from(grey, 0.0),
                                     {"piece", ball({0, -15, 0}, 8.0), {0.8f, 0.4f, 0.1f}},
                                     {"other", ball({15, 0, 5}, 7.0), {0.1f, 0.4f, 0.8f}}};
    RenderOptions options = options_for("anterior");
    Renderer renderer;
    Picture before = renderer.frame(objects, options);
    for (int step = 0; step < 25; ++step) {
      const std::string what = "seed " + std::to_string(seed) + " step " + std::to_string(step) + ": " +
                               change(random, grey, objects, options);
      const Picture picture = renderer.frame(objects, options);
      expect_same(picture, Renderer().frame(objects, options), what);
      (picture.rgb == before.rgb ? same : different) += 1;
      before = picture;
    }
    kept += renderer.tally().layers_kept;
    drawn += renderer.tally().layers_drawn;
  }
  // The changes were changes to be seen, and there was something to keep.
  EXPECT_GT(different, 60u);
  EXPECT_GT(kept, 60u);
  EXPECT_GT(drawn, 60u);
}

TEST(Renderer, ColoursAreShadedAnewOverLayersThatStay) {
  std::vector<DrawnObject> objects{{"one", ball(glm::dvec3(0.0), 15.0)}, {"two", ball({12, -9, 0}, 8.0)}};
  Renderer renderer;
  const Picture first = renderer.frame(objects, options_for("30,20"));
  EXPECT_EQ(renderer.tally().layers_drawn, 2u);
  objects[1].colour = {0.1f, 0.2f, 0.9f};
  const Picture recoloured = renderer.frame(objects, options_for("30,20"));
  EXPECT_EQ(renderer.tally().layers_drawn, 2u);
  EXPECT_EQ(renderer.tally().layers_kept, 2u);
  EXPECT_EQ(renderer.tally().pictures_shaded, 2u);
  EXPECT_NE(first.rgb, recoloured.rgb);
  EXPECT_EQ(first.depth_mm, recoloured.depth_mm);
  // Nothing changed: the picture itself.
  expect_same(renderer.frame(objects, options_for("30,20")), recoloured, "kept");
  EXPECT_EQ(renderer.tally().pictures_kept, 1u);
  EXPECT_EQ(renderer.tally().pictures_shaded, 2u);
  // A fragment moves: only its own layer is drawn. An object that was hidden and comes back is not.
  objects[1].octree = ball({14, -9, 0}, 8.0);
  renderer.frame(objects, options_for("30,20"));
  EXPECT_EQ(renderer.tally().layers_drawn, 3u);
  objects[0].opacity = 0.0f;
  renderer.frame(objects, options_for("30,20"));
  objects[0].opacity = 0.4f;
  renderer.frame(objects, options_for("30,20"));
  EXPECT_EQ(renderer.tally().layers_drawn, 3u);
  // Another view is all anew.
  renderer.frame(objects, options_for("31,20"));
  EXPECT_EQ(renderer.tally().layers_drawn, 5u);
}

TEST(Renderer, ShowsWhatRenderShows) {
  const std::vector<DrawnObject> objects{drawn_from(grey_ball(), 0.0),
                                         {"piece", ball({4, -15, 3}, 8.0), {0.8f, 0.4f, 0.1f}}};
  for (const char* view : {"40,25", "-100,-30"})
    expect_same(Renderer().frame(objects, options_for(view)), render(objects, options_for(view)), view);
  const Picture one = Renderer().frame(objects, options_for("left")),
                other = render(objects, options_for("left"));
  std::size_t lit = 0, other_object = 0;
  for (std::size_t i = 0; i < one.object.size(); ++i) {
    EXPECT_EQ(one.object[i] >= 0, other.object[i] >= 0);
    if (one.object[i] < 0) continue;
    ++lit;
    other_object += one.object[i] != other.object[i];
    EXPECT_NEAR(one.depth_mm[i], other.depth_mm[i], 2.0) << i;
  }
  EXPECT_GT(lit, 900u);
  EXPECT_LT(other_object, lit / 50);
}

TEST(Renderer, RefinesFromAQuarterToAHalfToTheWhole) {
  std::vector<DrawnObject> objects{{"one", ball(glm::dvec3(0.0), 15.0)}};
  RenderOptions options = options_for("20,10");
  options.centre_mm.reset();
  options.width_mm.reset();
  Renderer renderer;
  std::vector<Picture> shown;
  const auto show = [&](const Picture& picture) { shown.push_back(picture); };
  renderer.refine(objects, options, show);
  ASSERT_EQ(shown.size(), 3u);
  EXPECT_EQ(shown[0].size_px, glm::ivec2(23, 18));
  EXPECT_EQ(shown[1].size_px, glm::ivec2(45, 35));
  expect_same(shown[2], Renderer().frame(objects, options), "whole");
  for (const Picture& picture : shown) {
    // The same ball in the same place: as large, to the pixels of its outline.
    const double lit_mm2 = static_cast<double>(picture.lit_pixels) * picture.pixel_mm * picture.pixel_mm;
    EXPECT_NEAR(lit_mm2, M_PI * 225.0, 2.0 * M_PI * 15.0 * picture.pixel_mm);
  }
  // A colour changes: nothing is drawn, so the whole picture comes at once.
  shown.clear();
  objects[0].colour = {0.9f, 0.1f, 0.1f};
  renderer.refine(objects, options, show);
  EXPECT_EQ(shown.size(), 1u);
}

TEST(Renderer, StopsBetweenPicturesAndGoesOnWhereItStopped) {
  const std::vector<DrawnObject> objects{{"one", ball(glm::dvec3(0.0), 15.0)},
                                         {"two", ball({12, -9, 0}, 8.0)}};
  Renderer renderer;
  std::stop_source stop;
  int shown = 0;
  EXPECT_THROW(renderer.refine(objects, options_for("20,10"),
                               [&](const Picture&) {
                                 if (++shown == 2) stop.request_stop();
                               },
                               {stop.get_token(), {}}),
               Stopped);
  EXPECT_EQ(shown, 2);
  EXPECT_EQ(renderer.tally().layers_drawn, 4u);
  renderer.refine(objects, options_for("20,10"), [&](const Picture&) { ++shown; });
  EXPECT_EQ(shown, 5);
  // Both coarse pictures were kept.
  EXPECT_EQ(renderer.tally().layers_drawn, 6u);
  EXPECT_EQ(renderer.tally().pictures_kept, 2u);
}

TEST(Renderer, RefusesWhatRenderRefusesAndCounting) {
  RenderOptions options = options_for("left");
  Renderer renderer;
  EXPECT_THROW(renderer.frame({}, options), std::invalid_argument);
  options.count = true;
  EXPECT_THROW(renderer.frame({{"one", ball(glm::dvec3(0.0), 9.0)}}, options), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
