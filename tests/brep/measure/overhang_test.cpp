// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/measure/overhang.h"

#include <cmath>
#include <gtest/gtest.h>
#include <stdexcept>

#include "brep/shape/prism.h"

namespace octotomy::brep {
namespace {

/// A box of 30 x 20 x 10 mm whose lower side is at z = 0; `look` is along y.
Solid box(double from_y_mm, double to_y_mm, double low_mm, double high_mm, double half_mm) {
  Prism prism;
  prism.polygons_mm = {{{-half_mm, low_mm}, {half_mm, low_mm}, {half_mm, high_mm}, {-half_mm, high_mm}}};
  prism.from_mm = from_y_mm;
  prism.to_mm = to_y_mm;
  return solid_of(prism);
}

/// A roof whose lower faces are inclined from the bed by an angle: a wedge that stands on its edge.
Solid wedge(double incline_deg, double length_mm) {
  const double rise_mm = 10.0 * std::tan(glm::radians(incline_deg));
  Prism prism;
  prism.polygons_mm = {{{0, 0}, {10, rise_mm}, {-10, rise_mm}}};
  prism.from_mm = 0.0;
  prism.to_mm = length_mm;
  return solid_of(prism);
}

TEST(Overhangs, ABoxOnTheBedHasNone) {
  EXPECT_TRUE(overhangs(box(0, 20, 0, 10, 15).linked(), {}).empty());
}

TEST(Overhangs, ABoxThatStandsOnItsSideStillHasNone) {
  EXPECT_TRUE(overhangs(box(0, 20, 0, 10, 15).linked(), {{0, 1, 0}, 45.0, 0.1}).empty());
}

TEST(Overhangs, ATableTopHangsByItsLowerSideButItsFoot) {
  // A foot of 10 x 10 mm and a top of 30 x 20 mm: one profile swept along y would differ, so two shells.
  Prism prism;
  prism.polygons_mm = {{{-5, 0}, {5, 0}, {5, 10}, {15, 10}, {15, 12}, {-15, 12}, {-15, 10}, {-5, 10}}};
  prism.from_mm = 0.0;
  prism.to_mm = 20.0;
  const std::vector<Overhang> found = overhangs(solid_of(prism).linked(), {});
  ASSERT_EQ(found.size(), 2u);
  for (const Overhang& side : found) {
    EXPECT_NEAR(side.area_mm2, 10.0 * 20.0, 1e-9);
    EXPECT_NEAR(side.at_mm.z, 10.0, 1e-9);
  }
}

TEST(Overhangs, AnInclinedFaceCountsBelowTheAngleAlone) {
  const Solid roof = wedge(40.0, 20.0);
  const double side_mm2 = 10.0 / std::cos(glm::radians(40.0)) * 20.0;
  // Both faces meet at the lowest edge, so they are one place.
  const std::vector<Overhang> found = overhangs(roof.linked(), {{0, 0, 1}, 40.5, 0.1});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].area_mm2, 2.0 * side_mm2, 1e-9);
  EXPECT_TRUE(overhangs(roof.linked(), {{0, 0, 1}, 39.5, 0.1}).empty());
  // A face that is inclined by just the angle is no overhang.
  EXPECT_TRUE(overhangs(roof.linked(), {{0, 0, 1}, 40.0, 0.1}).empty());
  // Upside down it rests on its flat side.
  EXPECT_TRUE(overhangs(roof.linked(), {{0, 0, -1}, 89.0, 0.1}).empty());
}

TEST(Overhangs, RefusesADirectionThatIsNoUnitVectorAndAnAngleOutOfRange) {
  const Solid any = box(0, 20, 0, 10, 15);
  EXPECT_THROW(overhangs(any.linked(), {{0, 0, 2}, 45.0, 0.1}), std::invalid_argument);
  EXPECT_THROW(overhangs(any.linked(), {{0, 0, 1}, 91.0, 0.1}), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::brep
