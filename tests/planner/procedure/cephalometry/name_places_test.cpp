// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/procedure/cephalometry/name_places.h"

#include <gtest/gtest.h>

#include "voxel/view/lettering.h"

namespace octotomy::planner {
namespace {

constexpr double cap_px = 15.0;

/// The letters of a placed name, without the room around them.
PixelBox letters_of(const std::string& name, const glm::dvec2& start_px) {
  return {start_px - glm::dvec2(0.0, cap_px), start_px + glm::dvec2(voxel::text_width_px(name, cap_px), 0.0)};
}

bool touch(const PixelBox& a, const PixelBox& b) {
  return a.low.x < b.high.x && b.low.x < a.high.x && a.low.y < b.high.y && b.low.y < a.high.y;
}

TEST(NamePlaces, NamesOfCrowdedPointsCoverNeitherEachOtherNorADot) {
  const std::vector<std::pair<std::string, glm::dvec2>> points{
      {"ans", {700, 300}},      {"a point", {705, 312}},      {"incisor", {702, 330}},
      {"b point", {690, 352}},  {"pogonion", {692, 370}},     {"menton", {688, 378}},
      {"gnathion", {690, 375}}, {"lower incisor", {701, 332}}};
  NamePlaces places(glm::ivec2(900), cap_px);
  std::vector<PixelBox> taken;
  for (const auto& [name, at] : points) {
    taken.push_back({at - 4.0, at + 4.0});
    places.keep_off(taken.back());
  }
  for (const auto& [name, at] : points) {
    const auto start = places.place(name, at);
    ASSERT_TRUE(start) << name;
    const PixelBox letters = letters_of(name, *start);
    for (const PixelBox& other : taken) EXPECT_FALSE(touch(letters, other)) << name;
    taken.push_back(letters);
  }
}

TEST(NamePlaces, ALineIsAvoidedWhereThereIsRoomAndAnEdgeAlways) {
  NamePlaces places(glm::ivec2(300), cap_px);
  places.keep_off_line({0.0, 150.0}, {300.0, 150.0});
  const auto beside_line = places.place("sella", {150.0, 150.0});
  ASSERT_TRUE(beside_line);
  EXPECT_FALSE(touch(letters_of("sella", *beside_line), {{0.0, 149.9}, {300.0, 150.1}}));
  const auto at_edge = places.place("pogonion", {295.0, 60.0});
  ASSERT_TRUE(at_edge);
  EXPECT_LT(at_edge->x + voxel::text_width_px("pogonion", cap_px), 295.0);
}

TEST(NamePlaces, WithoutRoomThereIsNoPlace) {
  NamePlaces places(glm::ivec2(60), cap_px);
  EXPECT_FALSE(places.place("mandibular plane", {30.0, 30.0}));
  // Lines alone refuse no name.
  NamePlaces crossed(glm::ivec2(300), cap_px);
  for (int y = 0; y < 300; y += 5) crossed.keep_off_line({0.0, y}, {300.0, y});
  EXPECT_TRUE(crossed.place("sella", {150.0, 150.0}));
}

}  // namespace
}  // namespace octotomy::planner
