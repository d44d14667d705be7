// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/brush.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>

#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"

namespace octotomy::brep {
namespace {

double ball_mm3(double radius_mm) {
  return 4.0 / 3.0 * std::numbers::pi * std::pow(radius_mm, 3.0);
}

TEST(Brush, ADabHasTheBallsVolumeAndTheStatedDeviation) {
  const glm::dvec3 centre_mm(10.0, -20.0, 30.0);
  const Solid dab = brush_solid({{{centre_mm}, 3.0}}).solid;
  EXPECT_NEAR(volume_mm3(dab), ball_mm3(3.0), 1e-9 * ball_mm3(3.0));
  EXPECT_TRUE(health(dab).solid());
  EXPECT_EQ(dab.triangles().points_mm.size(), 60u);
  for (const glm::dvec3& corner_mm : dab.triangles().points_mm)
    EXPECT_NEAR(glm::distance(corner_mm, centre_mm), 1.04873 * 3.0, 1e-4);
  double nearest_mm = std::numeric_limits<double>::infinity();
  for (const auto& face : dab.triangles().faces) {
    const auto& p = dab.triangles().points_mm;
    const glm::dvec3 normal = glm::normalize(glm::cross(p[face[1]] - p[face[0]], p[face[2]] - p[face[0]]));
    nearest_mm = std::min(nearest_mm, glm::dot(normal, p[face[0]] - centre_mm));
    EXPECT_LT(std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)}), 0.99)
        << "no face is normal to an axis";
  }
  EXPECT_NEAR(nearest_mm, 0.96756 * 3.0, 1e-4);
}

TEST(Brush, ASlabHasTheDiscsVolumeAndItsThickness) {
  BrushTrace slab{{{0.0, 0.0, 5.0}}, 4.0};
  slab.disc = BrushTrace::Disc{{0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}, 1.5};
  const Solid dab = brush_solid({slab}).solid;
  EXPECT_NEAR(volume_mm3(dab), 16.0 * std::numbers::pi * 1.5, 1e-9);
  EXPECT_NEAR(measure(dab).low_mm.z, 4.25, 1e-12);
  EXPECT_NEAR(measure(dab).high_mm.z, 5.75, 1e-12);
  slab.points_mm.push_back({10.0, 0.0, 5.0});
  EXPECT_NEAR(measure(brush_solid({slab}).solid).high_mm.z, 5.75, 1e-12);
}

TEST(Brush, AStraightStrokeAddsItsCrossSectionTimesItsLength) {
  const auto swept_mm3 = [](double length_mm) {
    return volume_mm3(brush_solid({{{{0.0, 0.0, 0.0}, length_mm * glm::dvec3(0.6, 0.48, 0.64)}, 2.0}}).solid);
  };
  const double section_mm2 = (swept_mm3(5.0) - ball_mm3(2.0)) / 5.0;
  EXPECT_NEAR(section_mm2, std::numbers::pi * 4.0, 0.06 * std::numbers::pi * 4.0);
  EXPECT_NEAR(swept_mm3(10.0), ball_mm3(2.0) + 10.0 * section_mm2, 1e-9);
}

/// Consecutive hulls share faces of the dab between them; a stroke that returns lies on itself.
TEST(Brush, StrokesThatTurnAndReturnAreOneSolid) {
  const BooleanResult there = brush_solid({{{{0, 0, 0}, {4, 0, 0}, {4, 3, 0}}, 1.5}});
  const BooleanResult back = brush_solid({{{{0, 0, 0}, {4, 0, 0}, {4, 3, 0}, {4, 0, 0}, {0, 0, 0}}, 1.5}});
  EXPECT_NEAR(volume_mm3(back.solid), volume_mm3(there.solid), 1e-9);
  EXPECT_TRUE(health(there.solid).solid());
  EXPECT_EQ(components(there.solid).size(), 1u);
  EXPECT_EQ(there.shift_mm, 0.0);
  const Solid apart = brush_solid({{{{0, 0, 0}}, 1.5}, {{{9, 0, 0}}, 1.5}}).solid;
  EXPECT_EQ(components(apart).size(), 2u);
}

TEST(Brush, RefusesWhatCannotBeDrawn) {
  EXPECT_THROW(brush_solid({}), std::invalid_argument);
  EXPECT_THROW(brush_solid({{{}, 1.0}}), std::invalid_argument);
  EXPECT_THROW(brush_solid({{{{0, 0, 0}}, 0.0}}), std::invalid_argument);
  BrushTrace slab{{{0.0, 0.0, 0.0}}, 4.0};
  slab.disc = BrushTrace::Disc{{0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}, -1.0};
  EXPECT_THROW(brush_solid({slab}), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::brep
