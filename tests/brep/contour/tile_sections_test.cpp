// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/contour/tile_sections.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <tbb/global_control.h>

#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "tests/brep/told.h"

namespace octotomy::brep {
namespace {

using std::numbers::pi;
using tests::told;

Contour ring(const glm::dvec2& centre, double radius, int points = 48) {
  Contour contour;
  for (int k = 0; k < points; ++k) {
    const double t = 2.0 * pi * k / points;
    contour.points_mm.push_back(centre + radius * glm::dvec2(std::cos(t), std::sin(t)));
  }
  return contour;
}

Contour rectangle(const glm::dvec2& low, const glm::dvec2& high) {
  return {{low, {high.x, low.y}, high, {low.x, high.y}}, true};
}

/// Sections of a body at `count` heights, a step apart. `at` returns the body's contours at a height.
template <typename At>
std::vector<Section> sections_of(double low, double step, int count, const At& at) {
  std::vector<Section> sections;
  for (int s = 0; s < count; ++s) sections.push_back({low + s * step, at(low + s * step)});
  return sections;
}

/// Both ways of joining give a solid; returns the volume of the default one.
double expect_solid(const std::vector<Section>& sections, const std::string& what) {
  double volume = 0.0;
  for (const bool overlaid : {true, false}) {
    TileSectionsOptions options;
    if (overlaid) options.cost.reset();
    const TiledSections tiled = tile_sections(sections, options);
    const Health found = health(tiled.surface);
    EXPECT_TRUE(found.solid()) << what << (overlaid ? ", overlaid: " : ", strips: ") << told(found);
    volume = size_of(tiled.surface).volume_mm3;
  }
  return volume;
}

std::vector<Section> ball(int count) {
  const double step = 20.0 / count;
  return sections_of(-10.0 + 0.5 * step, step, count, [&](double z) {
    return std::vector<Contour>{ring({0.3, -0.2}, std::sqrt(100.0 - z * z), 8 * count)};
  });
}

TEST(TileSections, ABallsVolumeConvergesAtSecondOrder) {
  const double whole = 4.0 / 3.0 * pi * 1000.0;
  double last = 0.0;
  for (const int count : {10, 20, 40}) {
    const double error = std::abs(expect_solid(ball(count), "ball") - whole);
    if (last > 0.0) {
      EXPECT_GT(last / error, 2.8) << count;  // the roofs hold it below four
    }
    last = error;
  }
  EXPECT_LT(last, 2e-3 * whole);
}

TEST(TileSections, ATorusOnItsSideBranchesAndMerges) {
  // The ring's axis lies in the section planes: two contours merge into one and split again.
  const double big = 10.0, small = 3.0;
  const auto at = [&](double z) {
    // Where |sqrt(x^2 + z^2) - big| <= sqrt(small^2 - y^2), followed on fine samples.
    const int n = 121;
    const double spacing = 0.25;
    std::vector<float> samples(n * n);
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const double x = spacing * (i - n / 2), y = spacing * (j - n / 2);
        samples[static_cast<std::size_t>(j * n + i)] =
            static_cast<float>(small - std::hypot(std::hypot(x, z) - big, y));
      }
    return follow({samples, n, n, {spacing, spacing}}, {.threshold = 0.0});
  };
  const double whole = 2.0 * pi * pi * big * small * small;
  const auto sections = sections_of(-12.75, 0.5, 52, at);
  const double volume = expect_solid(sections, "torus");
  EXPECT_NEAR(volume, whole, 4e-3 * whole);
  const Health found = health(tile_sections(sections).surface);
  EXPECT_EQ(found.euler, 0);
  EXPECT_EQ(found.components, 1u);
}

TEST(TileSections, ABoxOfEqualSectionsHasItsVolume) {
  const auto sections = sections_of(0.5, 1.0, 6, [](double) {
    return std::vector<Contour>{rectangle({0, 0}, {4, 3})};
  });
  // Five slabs between sections and a roof above and below, each at least a third and at most all of a half.
  const double volume = expect_solid(sections, "box");
  EXPECT_GT(volume, 12 * (5 + 2.0 / 6.0) - 1e-6);
  EXPECT_LE(volume, 12 * 6 + 1e-6);
}

TEST(TileSections, NestedContoursAndHolesThatEndAreClosed) {
  // A ball with a cavity, and a ball in the cavity.
  const auto at = [](double z) {
    std::vector<Contour> contours;
    for (const double r : {10.0, 7.0, 3.0})
      if (z * z < r * r) contours.push_back(ring({0.1 * r, 0.0}, std::sqrt(r * r - z * z), 40));
    return contours;
  };
  const auto sections = sections_of(-9.9, 0.4, 50, at);
  const double whole = 4.0 / 3.0 * pi * (1000.0 - 343.0 + 27.0);
  EXPECT_NEAR(expect_solid(sections, "nested"), whole, 0.02 * whole);
  EXPECT_EQ(health(tile_sections(sections).surface).shells, 3u);
}

TEST(TileSections, UnevenSpacingDoesNotMatter) {
  std::vector<Section> sections;
  for (const double z : {-9.8, -9.4, -8.0, -7.5, -4.0, -1.0, 0.0, 2.5, 3.0, 6.0, 8.5, 9.3, 9.7})
    sections.push_back({z, {ring({0, 0}, std::sqrt(100.0 - z * z), 96)}});
  const double whole = 4.0 / 3.0 * pi * 1000.0;
  EXPECT_NEAR(expect_solid(sections, "uneven"), whole, 0.03 * whole);
}

TEST(TileSections, EveryCostGivesASolidOfContoursThatChangeMuchAndFallsBackHardly) {
  // Stars of uneven steps, turned from section to section: the best strips by area, volume and angle cross.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(0.0, 1.0);
  std::vector<Section> sections;
  for (int s = 0; s < 40; ++s) {
    Contour star;
    for (int k = 0; k < 60; ++k) {
      const double t = 2.0 * pi * (k + 0.5 * any(random)) / 60;
      star.points_mm.push_back((8.0 + 2.0 * std::cos(5.0 * t + 0.5 * s) + 0.4 * any(random)) *
                               glm::dvec2(std::cos(t), std::sin(t)));
    }
    sections.push_back({1.0 * s, {star}});
  }
  std::size_t clear = 0;
  for (const TileCost cost :
       {TileCost::shortest_span, TileCost::least_area, TileCost::greatest_volume, TileCost::least_angle}) {
    const TiledSections tiled = tile_sections(sections, {.cost = cost});
    const Health found = health(tiled.surface);
    EXPECT_TRUE(found.solid()) << static_cast<int>(cost) << ": " << told(found);
    EXPECT_EQ(tiled.strips + tiled.crossed_strips, 39u);
    // None of 39 is less than 2 %.
    EXPECT_EQ(tiled.crossed_strips + tiled.narrowed_strips, 0u) << static_cast<int>(cost);
    clear += tiled.clear_strips;
  }
  EXPECT_GT(clear, 40u);
}

TEST(TileSections, AStripWhoseLeastAreaIsTwoConesIsNoSurfaceAndIsNarrowed) {
  // The contours overlap at one corner only: two cones over each other's point there have less area than any
  // strip around.
  const std::vector<Section> sections{{0.0, {ring({0, 0}, 10.0)}}, {0.5, {ring({19.5, 0.0}, 10.0)}}};
  for (const TileCost cost : {TileCost::least_area, TileCost::greatest_volume, TileCost::least_angle})
    EXPECT_TRUE(health(tile_sections(sections, {.cost = cost}).surface).solid()) << static_cast<int>(cost);
}

/// Each cost gives a solid, and joins no pair of contours by anything but this cost.
void expect_no_fall_back(const std::vector<Section>& sections, std::size_t least_pairs,
                         const std::string& what) {
  for (const TileCost cost :
       {TileCost::shortest_span, TileCost::least_area, TileCost::greatest_volume, TileCost::least_angle}) {
    const TiledSections tiled = tile_sections(sections, {.cost = cost});
    const Health found = health(tiled.surface);
    EXPECT_TRUE(found.solid()) << what << ", " << static_cast<int>(cost) << ": " << told(found);
    EXPECT_GE(tiled.strips, least_pairs) << what;
    EXPECT_EQ(tiled.narrowed_strips, 0u) << what << ", " << static_cast<int>(cost);
    EXPECT_EQ(tiled.crossed_strips, 0u) << what << ", " << static_cast<int>(cost);
  }
}

TEST(TileSections, SmallContoursFarApartForTheirSizeAreJoinedByEachCost) {
  // Two cones that meet at a span have less area than any strip around, as a soap film tears.
  std::vector<Section> sections;
  for (int s = 0; s < 8; ++s)
    sections.push_back({4.0 * s, {ring({0.9 * (s % 2), 0.2 * s}, 1.0 + 0.3 * (s % 3), 4 + 2 * (s % 3))}});
  expect_no_fall_back(sections, 7, "small");
}

TEST(TileSections, ContoursThatCrossOrHaveFoldsThatTheOtherDoesNotSeeAreJoinedByEachCost) {
  // A comb over another one whose teeth stand between the first one's; a small contour at the end of a large
  // one.
  Contour comb, shifted;
  for (int tooth = 0; tooth < 4; ++tooth)
    for (const glm::dvec2& p : {glm::dvec2{0, -3}, glm::dvec2{0, 3}, glm::dvec2{1, 3}, glm::dvec2{1, -3}}) {
      comb.points_mm.push_back(p + glm::dvec2(2.0 * tooth, 0.01 * tooth));
      shifted.points_mm.push_back(p + glm::dvec2(2.0 * tooth + 0.6, 0.5 - 0.01 * tooth));
    }
  for (const glm::dvec2& p : {glm::dvec2{8, -4}, glm::dvec2{-1, -4}}) {
    comb.points_mm.push_back(p);
    shifted.points_mm.push_back(p + glm::dvec2(0.3, -0.2));
  }
  const Contour end = rectangle({6.3, -3.4}, {7.9, -2.7});
  expect_no_fall_back({{0.0, {comb}}, {1.0, {shifted}}, {2.0, {end}}}, 2, "comb");
}

TEST(TileSections, AThinUnevenWallThatLeansByMoreThanItsThicknessIsJoinedByEachCost) {
  // As the vault of a skull in thick slices, open at one place: spans of the outer side cross the inner side in
  // projection, and nothing in space.
  constexpr int steps = 200;
  std::vector<Section> sections;
  for (int s = 0; s < 3; ++s) {
    const double shift = 1.5 * s, radius = 20.0 - shift;
    Contour wall;
    const auto add = [&](int k, bool is_inner) {
      const double t = (100.0 + 340.0 * k / steps) * pi / 180.0;
      const double depth = 1.0 + 0.4 * std::sin(17.0 * t + 2.0 * s) * std::sin(5.0 * t + s);
      const double r = is_inner ? radius - depth : radius;
      wall.points_mm.emplace_back(shift + r * std::cos(t), r * std::sin(t));
    };
    for (int k = 0; k <= steps; ++k) add(k, false);
    for (int k = steps; k >= 0; --k) add(k, true);
    sections.push_back({5.0 * s, {wall}});
  }
  expect_no_fall_back(sections, 2, "wall");
}

TEST(TileSections, AWallWhoseEndPassesAnotherPieceBelowItsRoofIsJoinedByEachCost) {
  // As a vault that is one piece in one slice and two in the next, which lean by more than the wall's thickness: only
  // the first piece meets the wall, the second one has a roof of its own, and every strip passes that piece.
  const auto wall = [](double from_deg, double to_deg, double lean) {
    constexpr double step_deg = 2.0, thickness = 2.0;
    const auto steps = static_cast<int>((to_deg - from_deg) / step_deg);
    Contour contour;
    const auto add = [&](int k, bool is_inner) {
      const double deg = from_deg + (to_deg - from_deg) * k / steps, t = deg * pi / 180.0;
      const double r = 20.0 - lean * (0.9 + 1.3 * std::max(0.0, (deg - 120.0) / 60.0));
      const double end = (std::min(k, steps - k) + 0.3) / 6.0;
      const double depth = is_inner ? thickness * std::sqrt(std::clamp(end, 0.02, 1.0)) : 0.0;
      contour.points_mm.emplace_back((r - depth) * std::cos(t), (r - depth) * std::sin(t));
    };
    for (int k = 0; k <= steps; ++k) add(k, false);
    for (int k = steps; k >= 0; --k) add(k, true);
    return contour;
  };
  std::vector<Section> sections{{0.0, {wall(10.0, 300.0, 0.0)}},
                                {5.0, {wall(12.0, 200.0, 1.0), wall(206.0, 300.0, 1.0)}}};
  for (const bool is_turned : {false, true}) {
    if (is_turned) std::swap(sections[0].contours, sections[1].contours);
    for (const TileCost cost :
         {TileCost::shortest_span, TileCost::least_area, TileCost::greatest_volume, TileCost::least_angle}) {
      const TiledSections tiled = tile_sections(sections, {.cost = cost});
      const Health found = health(tiled.surface);
      EXPECT_TRUE(found.solid()) << static_cast<int>(cost) << ": " << told(found);
      EXPECT_EQ(tiled.strips, 1u) << static_cast<int>(cost);
      EXPECT_EQ(tiled.crossed_strips, 0u) << static_cast<int>(cost);
    }
  }
}

TEST(TileSections, ContoursOfASmoothFieldWithHolesAndIslandsFallBackOnLessThanTwoInAHundred) {
  constexpr int n = 26;
  std::array<std::size_t, 4> pairs{}, fallen{};
  for (unsigned seed = 0; seed < 6; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> any(0.0, 1.0);
    std::array<std::array<double, 4>, 12> waves{};
    for (auto& wave : waves)
      for (double& part : wave) part = any(random);
    std::vector<Section> sections;
    for (int s = 0; s < 10; ++s) {
      std::vector<float> samples;
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          double sum = 0.1 * any(random);
          for (const auto& wave : waves)
            sum += std::cos(0.6 * (wave[0] * i + wave[1] * j + wave[2] * s) + 3.0 * wave[3]);
          samples.push_back(static_cast<float>(sum));
        }
      sections.push_back({1.0 * s, follow({samples, n, n, {1.0, 1.0}}, {.threshold = 1.5})});
    }
    for (std::size_t cost = 0; cost < pairs.size(); ++cost) {
      const TiledSections tiled = tile_sections(sections, {.cost = static_cast<TileCost>(cost)});
      const Health found = health(tiled.surface);
      EXPECT_TRUE(found.solid()) << "seed " << seed << ", " << cost << ": " << told(found);
      pairs[cost] += tiled.strips + tiled.crossed_strips;
      fallen[cost] += tiled.narrowed_strips + tiled.crossed_strips;
    }
  }
  for (std::size_t cost = 0; cost < pairs.size(); ++cost) {
    EXPECT_GT(pairs[cost], 200u) << cost;
    EXPECT_LE(50 * fallen[cost], pairs[cost]) << cost << ": " << fallen[cost] << " of " << pairs[cost];
  }
}

TEST(TileSections, AnyNestedContoursWillDo) {
  // Contours followed in noise: of every shape, corner to corner, and unlike their neighbours.
  std::size_t strips = 0, overlaid = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> any(0.0F, 1.0F);
    std::vector<Section> sections;
    for (int s = 0; s < 4; ++s) {
      std::vector<float> samples(14 * 14);
      for (float& sample : samples) sample = any(random);
      sections.push_back({1.0 * s, follow({samples, 14, 14, {1.0, 1.0}}, {.threshold = 0.5})});
    }
    expect_solid(sections, "seed " + std::to_string(seed));
    const TiledSections tiled = tile_sections(sections);
    strips += tiled.strips;
    overlaid += tiled.overlaid;
  }
  EXPECT_GT(strips, 10u);
  EXPECT_GT(overlaid, 100u);
}

TEST(TileSections, WindingOfTheContoursDoesNotMatter) {
  auto sections = ball(8);
  const double volume = size_of(tile_sections(sections).surface).volume_mm3;
  for (Section& section : sections)
    std::reverse(section.contours[0].points_mm.begin(), section.contours[0].points_mm.end());
  EXPECT_NEAR(size_of(tile_sections(sections).surface).volume_mm3, volume, 0.01 * volume);
  EXPECT_GT(volume, 0.0);
}

TEST(TileSections, ThreadsDoNotChangeTheBits) {
  const auto sections = ball(12);
  const TiledSections many = tile_sections(sections);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const TiledSections alone = tile_sections(sections);
  EXPECT_EQ(many.surface.points_mm, alone.surface.points_mm);
  EXPECT_EQ(many.surface.faces, alone.surface.faces);
}

TEST(TileSections, ContoursThatCrossAreNamed) {
  std::vector<Section> sections = {{0.0, {ring({0, 0}, 2)}}, {2.5, {ring({0, 0}, 2), ring({3, 0}, 2)}}};
  try {
    tile_sections(sections);
    FAIL() << "crossing contours were tiled";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("cross"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("2.5"), std::string::npos) << error.what();
  }
  sections[1].z_mm = 0.0;
  EXPECT_THROW(tile_sections(sections), std::invalid_argument);
  EXPECT_THROW(tile_sections({{0.0, {{{{0, 0}, {1, 0}, {1, 1}}, false}}}}), std::invalid_argument);
  EXPECT_TRUE(tile_sections({}).surface.faces.empty());
}

}  // namespace
}  // namespace octotomy::brep
