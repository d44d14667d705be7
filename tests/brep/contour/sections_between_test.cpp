// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/contour/sections_between.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "brep/mesh/solid.h"

namespace octotomy::brep {
namespace {

Contour circle(double radius_mm, const glm::dvec2& middle_mm = {0.0, 0.0}, int points = 240) {
  Contour contour;
  for (int i = 0; i < points; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / points;
    contour.points_mm.push_back(middle_mm + radius_mm * glm::dvec2(std::cos(angle), std::sin(angle)));
  }
  return contour;
}

Contour square(double half_mm) {
  return {{{-half_mm, -half_mm}, {half_mm, -half_mm}, {half_mm, half_mm}, {-half_mm, half_mm}}};
}

double volume_of(const std::vector<Section>& sections) {
  const Triangles tiles = tile_sections(sections).surface;
  EXPECT_TRUE(health(tiles, {.self_intersections = true}).crossing.empty());
  return volume_mm3(trusted_solid(tiles, Proof::Construction));
}

TEST(SectionsBetween, BetweenTwoCirclesTheRadiusIsInterpolated) {
  const std::vector<Section> sections =
      sections_between({{0.0, {circle(10.0)}}, {8.0, {circle(14.0)}}}, {.step_mm = 1.0});
  std::size_t between = 0;
  for (const Section& section : sections) {
    if (section.z_mm <= 0.0 || section.z_mm >= 8.0) continue;
    ++between;
    ASSERT_EQ(section.contours.size(), 1u) << section.z_mm;
    for (const glm::dvec2& p : section.contours[0].points_mm)
      EXPECT_NEAR(glm::length(p), 10.0 + 0.5 * section.z_mm, 2e-3) << section.z_mm;
  }
  EXPECT_EQ(between, 7u);
  EXPECT_TRUE(sections.front().contours.empty());
  EXPECT_TRUE(sections.back().contours.empty());
}

TEST(SectionsBetween, AFrustumAndItsFlatEndsHaveTheirVolume) {
  const double tiled = volume_of(sections_between({{0.0, {circle(10.0)}}, {8.0, {circle(14.0)}}}));
  // The truth is the frustum, and a cylinder of half a gap at either end.
  const double frustum = std::numbers::pi * 8.0 / 3.0 * (100.0 + 140.0 + 196.0),
               ends = std::numbers::pi * 4.0 * (100.0 + 196.0);
  EXPECT_NEAR(tiled, frustum + ends, 2e-3 * (frustum + ends));
}

TEST(SectionsBetween, TheVolumeConvergesAtSecondOrder) {
  // The outline between two circles that are apart has no closed form, so the finest volume is the reference.
  const std::vector<Section> drawn{{0.0, {circle(10.0)}}, {6.0, {circle(6.0, {8.0, 0.0})}}};
  const double fine = volume_of(sections_between(drawn, {.step_mm = 0.5}));
  const double at_1_5 = std::abs(volume_of(sections_between(drawn, {.step_mm = 1.5})) - fine),
               at_3 = std::abs(volume_of(sections_between(drawn, {.step_mm = 3.0})) - fine);
  EXPECT_LT(at_1_5, 0.5 * at_3);
  EXPECT_LT(at_1_5, 1e-2 * fine);
}

TEST(SectionsBetween, NextToAnEmptySectionTheObjectEndsHalfWayInAFlatFace) {
  const double tiled = volume_of(sections_between({{0.0, {square(5.0)}}, {2.0, {square(5.0)}}, {8.0, {}}}));
  EXPECT_NEAR(tiled, 100.0 * (1.0 + 2.0 + 3.0), 0.5);
}

TEST(SectionsBetween, WhereTheNearerSectionDecidesThereIsAStepHalfWay) {
  const double tiled = volume_of(
      sections_between({{0.0, {square(5.0)}}, {4.0, {square(8.0)}}}, {.between = Between::nearest}));
  EXPECT_NEAR(tiled, 4.0 * (100.0 + 256.0), 1.0);
}

TEST(SectionsBetween, HolesAndBranchesAreInterpolatedToo) {
  const std::vector<Section> sections =
      sections_between({{0.0, {square(10.0), square(4.0)}}, {4.0, {square(10.0), square(6.0)}}});
  for (const Section& section : sections)
    if (section.z_mm > 0.0 && section.z_mm < 4.0) {
      EXPECT_EQ(section.contours.size(), 2u) << section.z_mm;
    }
  const std::vector<Section> branching =
      sections_between({{0.0, {circle(10.0)}}, {6.0, {circle(3.0, {-7.0, 0.0}), circle(3.0, {7.0, 0.0})}}});
  std::size_t one = 0, two = 0;
  for (const Section& section : branching) {
    one += section.contours.size() == 1 ? 1 : 0;
    two += section.contours.size() == 2 ? 1 : 0;
  }
  EXPECT_GT(one, 1u);
  EXPECT_GT(two, 2u) << "the outline parts between the slices";
  volume_of(branching);
}

TEST(SectionsBetween, TheSameBitsEachTime) {
  const std::vector<Section> drawn{{0.0, {circle(10.0)}}, {9.0, {circle(6.0, {8.0, 0.0})}}};
  const std::vector<Section> first = sections_between(drawn), second = sections_between(drawn);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t s = 0; s < first.size(); ++s) {
    ASSERT_EQ(first[s].contours.size(), second[s].contours.size());
    for (std::size_t c = 0; c < first[s].contours.size(); ++c)
      EXPECT_EQ(first[s].contours[c].points_mm, second[s].contours[c].points_mm);
  }
}

TEST(SectionsBetween, SpoiledSectionsAreRefused) {
  const auto refusal = [](const std::vector<Section>& drawn, double step_mm = 1.0) -> std::string {
    try {
      sections_between(drawn, {.step_mm = step_mm});
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal({{0.0, {square(1.0)}}}).find("two sections"), std::string::npos);
  EXPECT_NE(refusal({{1.0, {square(1.0)}}, {0.0, {square(1.0)}}}).find("not higher"), std::string::npos);
  EXPECT_NE(refusal({{0.0, {{{{0, 0}, {1, 0}}}}}, {1.0, {}}}).find("fewer than three"), std::string::npos);
  EXPECT_NE(refusal({{0.0, {{{{0, 0}, {1, 0}, {0, NAN}}}}}, {1.0, {}}}).find("not finite"),
            std::string::npos);
  EXPECT_NE(refusal({{0.0, {square(1.0)}}, {1.0, {}}}, 0.0).find("step"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::brep
