// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/saw.h"

#include <gtest/gtest.h>

#include "brep/boolean/boolean.h"
#include "brep/mesh/components.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

TEST(SawBlade, APlaneCutTakesItsKerfAndLeavesTwoPieces) {
  const Solid block = solid_of(shapes::box({0, 0, 0}, {10, 10, 10}));
  const Solid blade = saw_blade({{{-5, -5, 4}, {15, -5, 4}}, {0, 1, 0}, 30.0, 0.8});
  const BooleanResult cut = boolean(block, Operation::Difference, blade);
  EXPECT_NEAR(volume_mm3(cut.solid), 1000 - 80, 1e-9);
  const auto pieces = components(cut.solid);
  ASSERT_EQ(pieces.size(), 2u);
  EXPECT_NEAR(pieces[0].volume_mm3, 560, 1e-9);
  EXPECT_NEAR(pieces[1].volume_mm3, 360, 1e-9);
  EXPECT_TRUE(health(cut.solid).solid());
}

TEST(SawBlade, AStepIsAsWideAsItsKerfAllAlong) {
  // Three pieces of 4, 3 and 4 mm at right angles, square ends; mitres neither add nor take.
  const Solid blade = saw_blade({{{0, 0, 0}, {4, 0, 0}, {4, 0, 3}, {8, 0, 3}}, {0, 2, 0}, 5.0, 0.5});
  EXPECT_NEAR(volume_mm3(blade), 5.0 * 0.5 * (4 + 3 + 4), 1e-12);
  EXPECT_TRUE(health(blade).solid());
  const Measures measures = measure(blade);
  EXPECT_NEAR(measures.low_mm.y, 0.0, 1e-12);
  EXPECT_NEAR(measures.high_mm.y, 5.0, 1e-12);
}

TEST(SawBlade, ADepthShortOfTheBoneLeavesAHinge) {
  const Solid block = solid_of(shapes::box({0, 0, 0}, {10, 10, 10}));
  const Solid blade = saw_blade({{{-5, -1, 4}, {15, -1, 4}}, {0, 1, 0}, 8.0, 0.8});
  const BooleanResult cut = boolean(block, Operation::Difference, blade);
  EXPECT_NEAR(volume_mm3(cut.solid), 1000 - 7 * 10 * 0.8, 1e-9);
  EXPECT_EQ(components(cut.solid).size(), 1u);
}

TEST(SawBlade, RefusesWhatCannotBeSawn) {
  EXPECT_THROW(saw_blade({{{0, 0, 0}}, {0, 1, 0}, 5, 1}), std::invalid_argument);
  EXPECT_THROW(saw_blade({{{0, 0, 0}, {0, 3, 0}}, {0, 1, 0}, 5, 1}), std::invalid_argument);
  EXPECT_THROW(saw_blade({{{0, 0, 0}, {3, 0, 0}}, {0, 0, 0}, 5, 1}), std::invalid_argument);
  EXPECT_THROW(saw_blade({{{0, 0, 0}, {3, 0, 0}}, {0, 1, 0}, 5, 0}), std::invalid_argument);
  EXPECT_THROW(saw_blade({{{0, 0, 0}, {3, 0, 0}, {0, 0, 0}}, {0, 1, 0}, 5, 1}), std::invalid_argument);
}

TEST(BooleanOfMany, UnitesIntersectsAndSubtractsAllAtOnce) {
  std::vector<Solid> boxes;
  for (int i = 0; i < 5; ++i)
    boxes.push_back(
        solid_of(shapes::box({0.5 * i, 0.1 * i, 0.03 * i}, {0.5 * i + 3, 0.1 * i + 2, 0.03 * i + 1})));
  const double united = volume_mm3(boolean(boxes, Operation::Union).solid);
  const double common = volume_mm3(boolean(boxes, Operation::Intersection).solid);
  EXPECT_NEAR(common, (3 - 2.0) * (2 - 0.4) * (1 - 0.12), 1e-12);
  EXPECT_GT(united, 6 + 4 * 0.5 * 2 - 1e-9);
  const std::vector<Solid> others(boxes.begin() + 1, boxes.end());
  const BooleanResult rest = boolean(boxes, Operation::Difference);
  EXPECT_NEAR(volume_mm3(rest.solid), united - volume_mm3(boolean(others, Operation::Union).solid), 1e-12);
  ASSERT_TRUE(rest.residual);
  EXPECT_LT(*rest.residual, 1e-12);
  EXPECT_THROW(boolean(std::vector<Solid>(), Operation::Union), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::brep
