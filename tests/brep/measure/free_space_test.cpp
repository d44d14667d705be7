// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/measure/free_space.h"

#include <gtest/gtest.h>
#include <stdexcept>

#include "brep/measure/local_thickness.h"
#include "brep/mesh/health.h"
#include "brep/shape/prism.h"

namespace octotomy::brep {
namespace {

/// A block of 30 x 20 x 10 mm with a slot of `slot_mm` from above to its middle.
Solid slotted(double slot_mm) {
  Prism prism;
  prism.polygons_mm = {{{-15, 0},
                        {15, 0},
                        {15, 10},
                        {0.5 * slot_mm, 10},
                        {0.5 * slot_mm, 5},
                        {-0.5 * slot_mm, 5},
                        {-0.5 * slot_mm, 10},
                        {-15, 10}}};
  prism.from_mm = 0.0;
  prism.to_mm = 20.0;
  return solid_of(prism);
}

TEST(FreeSpace, IsTheBoxLessTheSolid) {
  const Solid solid = slotted(0.4);
  const Solid free = free_space(solid, 3.0);
  EXPECT_NEAR(volume_mm3(free), 36.0 * 26.0 * 16.0 - (30.0 * 20.0 * 10.0 - 0.4 * 5.0 * 20.0), 1e-9);
  EXPECT_TRUE(health(free.triangles()).solid());
}

TEST(FreeSpace, ItsThinnestWallIsTheSlot) {
  const Solid free = free_space(slotted(0.4), 3.0);
  const LocalThickness found = local_thickness(free);
  ASSERT_TRUE(found.thinnest_wall);
  EXPECT_NEAR(found.surface[*found.thinnest_wall].thickness_mm, 0.4, 1e-6);
  EXPECT_GT(found.surface[*found.thinnest_wall].point.p_mm.z, 5.0 - 1e-9);
}

TEST(FreeSpace, RefusesTheEmptySetAndAMarginOfZero) {
  EXPECT_THROW(free_space(Solid(), 1.0), std::invalid_argument);
  EXPECT_THROW(free_space(slotted(0.4), 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::brep
