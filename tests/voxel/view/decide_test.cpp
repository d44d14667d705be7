// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/decide.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/unit_universe.h"
#include "tests/voxel/field_scene.h"
#include "voxel/tree/interpolate.h"
#include "voxel/view/layer.h"
#include "voxel/view/object_normals.h"

namespace octotomy::voxel {
namespace {

using tests::universe_about_origin;

DrawnObject object_of(const std::function<double(const glm::dvec3& p_mm)>& sample,
                      const std::optional<Lattice>& scan = std::nullopt) {
  const Universe universe = universe_about_origin(6);
  const GreyOctree grey = grey_octree_of(
      universe, tests::field_scene<std::int16_t>(scan.value_or(universe.lattice()), sample), -1000);
  return {"field", grey.scan(), glm::vec3(0.5f), grey, 0.0};
}

RenderOptions options_of(const char* view, int side_px = 40) {
  RenderOptions options;
  options.view = parse_view(view);
  options.size_px = glm::ivec2(side_px);
  options.centre_mm = glm::dvec2(0.0);
  options.width_mm = 60.0;
  return options;
}

/// Two shells of bone with marrow between, in air, and a small dense ball in the middle.
double shells(const glm::dvec3& p) {
  const double r = glm::length(p);
  const double shell = 900.0 - 250.0 * std::abs(r - 21.0);
  const double inner = 700.0 - 300.0 * std::abs(r - 13.0);
  const double core = 1500.0 - 100.0 * r;
  const double marrow = r < 21.0 ? 50.0 : -1000.0;
  return std::max({shell, inner, core, marrow});
}

/// The depth by every step, without skipped blocks and kept cells.
float plain_depth_mm(const GreyOctree& grey, const ImagePlane& plane, const Decision& decision,
                     const glm::dvec2& p_px) {
  const glm::dmat4 voxel_from_lps = glm::inverse(grey.universe().lps_from_voxel);
  const glm::dvec3 start_mm = plane.lps_mm(p_px, 0.0);
  const glm::dvec3 start(voxel_from_lps * glm::dvec4(start_mm, 1.0));
  const glm::dvec3 per_mm = glm::dmat3(voxel_from_lps) * plane.view.look;
  const auto span = span_among_centres(start, per_mm, grey.universe().side());
  if (!span) return std::numeric_limits<float>::infinity();
  const auto f = [&](double mm) { return interpolate(grey, start + mm * per_mm, Interpolation::Linear); };
  const auto holds = [&](double mm) {
    const glm::dvec3 p = start + mm * per_mm;
    if (decision.by == Criterion::Range) return f(mm) >= decision.low && f(mm) <= decision.high;
    const glm::ivec3 cell(glm::floor(p));
    if (glm::any(glm::lessThan(cell, glm::ivec3(1))) ||
        glm::any(glm::greaterThan(cell, glm::ivec3(grey.universe().side() - 3))))
      return false;
    return decision.by == Criterion::Derivative
               ? f(mm + 0.5) - f(mm - 0.5) > decision.steeper_per_mm
               : glm::length(0.5 * grey_normal(grey, p)) > decision.steeper_per_mm;
  };
  bool before = false;
  int passed = 0;
  for (int i = 0; span->near_mm + 0.5 * i <= span->far_mm; ++i) {
    const double at = span->near_mm + 0.5 * i;
    const bool now = holds(at);
    if (now && !before && passed++ == decision.peeled) {
      if (i == 0) return static_cast<float>(at);
      double low = at - 0.5, high = at;
      for (int k = 0; k < 9; ++k) (holds(0.5 * (low + high)) ? high : low) = 0.5 * (low + high);
      return static_cast<float>(high);
    }
    before = now;
  }
  return std::numeric_limits<float>::infinity();
}

TEST(Decide, EachFunctionEndsRaysWhereAPlainWalkOfAllStepsDoesForEveryLayer) {
  const DrawnObject object = object_of(shells);
  std::size_t lit = 0, dark = 0;
  for (const Decision& decision :
       {Decision{Criterion::Range, 300.0, 800.0, 0.0, 0}, Decision{Criterion::Range, 300.0, 800.0, 0.0, 1},
        Decision{Criterion::Range, 300.0, 800.0, 0.0, 3}, Decision{Criterion::Derivative, 0, 0, 120.0, 0},
        Decision{Criterion::Derivative, 0, 0, 120.0, 2}, Decision{Criterion::Gradient, 0, 0, 200.0, 0},
        Decision{Criterion::Gradient, 0, 0, 200.0, 1}})
    for (const char* view : {"anterior", "35,15", "-120,-60"}) {
      const Picture picture = decide(object, options_of(view), decision);
      for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 40; ++x) {
          const float wanted = plain_depth_mm(*object.grey, picture.plane(), decision, {x + 0.5, y + 0.5});
          const float found = picture.depth_mm[static_cast<std::size_t>(40 * y + x)];
          ASSERT_EQ(std::isfinite(found), std::isfinite(wanted)) << view << " " << x << ", " << y;
          if (std::isfinite(wanted)) {
            ASSERT_NEAR(found, wanted, 2e-3) << view << " " << x << ", " << y;
          }
          (std::isfinite(wanted) ? lit : dark)++;
        }
    }
  EXPECT_GT(lit, 5000u);
  EXPECT_GT(dark, 5000u);
}

TEST(Decide, PeelingShowsTheShellsOneAfterTheOtherAtTheirRadii) {
  const DrawnObject object = object_of(shells);
  // The shells reach 300 at 2.4 mm and 1.333 mm about their middles; the core at 12 mm from the centre. Rays
  // through the centre enter each shell from outside and leave it, then meet the core.
  const double depth_of_centre = [&] {
    const Picture picture = decide(object, options_of("anterior"), {Criterion::Range, 300.0, 5000.0, 0.0, 0});
    return picture.plane().view.look.y * 0.0 - picture.nearest_mm;
  }();
  const double outer = 21.0 + 600.0 / 250.0;
  const Picture first = decide(object, options_of("anterior", 41), {Criterion::Range, 300.0, 5000.0, 0.0, 0});
  const Picture second =
      decide(object, options_of("anterior", 41), {Criterion::Range, 300.0, 5000.0, 0.0, 1});
  const std::size_t middle = 41 * 20 + 20;
  EXPECT_NEAR(first.depth_mm[middle], depth_of_centre - outer, 0.1);
  // The inner shell's outside at 13 + 400/300; it runs into the core.
  EXPECT_NEAR(second.depth_mm[middle], depth_of_centre - (13.0 + 400.0 / 300.0), 0.1);
  const Picture fourth =
      decide(object, options_of("anterior", 41), {Criterion::Range, 300.0, 5000.0, 0.0, 3});
  EXPECT_FALSE(std::isfinite(fourth.depth_mm[middle]));
  EXPECT_GT(first.lit_pixels, second.lit_pixels);
}

TEST(Decide, TheScansOwnBorderIsNoChangeOfSamples) {
  // Even samples in a box amid the background of -1000: the step at its faces is no surface.
  Lattice box = universe_about_origin(6).lattice();
  box.dims = glm::ivec3(40);
  const DrawnObject object = object_of([](const glm::dvec3&) { return 500.0; }, box);
  for (const Criterion by : {Criterion::Derivative, Criterion::Gradient})
    EXPECT_EQ(decide(object, options_of("35,15"), {by, 0.0, 0.0, 1.0, 0}).lit_pixels, 0u);
  EXPECT_GT(decide(object, options_of("35,15"), {Criterion::Range, 400.0, 600.0, 0.0, 0}).lit_pixels, 100u);
}

TEST(Decide, ACutOpensTheShellsAndItsFaceIsTheSurface) {
  const DrawnObject object = object_of(shells);
  RenderOptions options = options_of("anterior", 41);
  options.cuts = {HalfSpace{{0, -1, 0}, 0.0}};
  const Picture picture = decide(object, options, {Criterion::Range, 300.0, 5000.0, 0.0, 0});
  // In front of the middle plane all is taken away; the core is cut there.
  EXPECT_NEAR(picture.point_mm({20, 20}).value().y, 0.0, 0.5);
}

TEST(Decide, IsTheSameOnOneThreadAndOnTwoAndRefusesWhatItCannotDecideBy) {
  const DrawnObject object = object_of(shells);
  const Picture two = decide(object, options_of("35,15"), {Criterion::Gradient, 0.0, 0.0, 200.0, 0});
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const Picture alone = decide(object, options_of("35,15"), {Criterion::Gradient, 0.0, 0.0, 200.0, 0});
    EXPECT_EQ(alone.rgb, two.rgb);
    EXPECT_EQ(alone.depth_mm, two.depth_mm);
  }
  for (const Decision& bad :
       {Decision{Criterion::Range, 1.0, 0.0, 0.0, 0}, Decision{Criterion::Range, 0.0, NAN, 0.0, 0},
        Decision{Criterion::Gradient, 0.0, 0.0, 0.0, 0},
        Decision{Criterion::Derivative, 0.0, 0.0, INFINITY, 0},
        Decision{Criterion::Range, 0.0, 1.0, 0.0, -1}})
    EXPECT_THROW(decide(object, options_of("left"), bad), std::invalid_argument);
  DrawnObject bare = object;
  bare.grey.reset();
  EXPECT_THROW(decide(bare, options_of("left"), {Criterion::Range, 0.0, 1.0, 0.0, 0}), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
