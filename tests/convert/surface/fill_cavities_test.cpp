// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/surface/fill_cavities.h"

#include <gtest/gtest.h>

#include "brep/mesh/measure.h"
#include "tests/convert/surfaces.h"

namespace octotomy::convert {
namespace {

using tests::ball;
using tests::inside_out;
using tests::together;

TEST(FillCavities, OnlyCavitiesSmallerThanTheVolumeAreFilledAndCounted) {
  const brep::Triangles small = ball({5, 0, 0}, 0.01, 0), medium = ball({-5, 0, 0}, 2.0, 2),
                        outer = ball({0, 0, 0}, 20.0, 3);
  const brep::Solid solid = brep::solid_of(together(together(outer, inside_out(small)), inside_out(medium)));
  const FilledCavities filled = fill_cavities(solid, 1.0);
  EXPECT_EQ(filled.cavities, 1u);
  EXPECT_NEAR(filled.volume_mm3, tests::volume_mm3(small), 1e-12);
  EXPECT_NEAR(brep::volume_mm3(filled.solid), tests::volume_mm3(outer) - tests::volume_mm3(medium), 1e-9);
  EXPECT_EQ(fill_cavities(solid, 100.0).cavities, 2u);
}

TEST(FillCavities, ASmallBodyIsNoCavityAndASolidWithoutAnyStaysAsItIs) {
  const brep::Solid bodies = brep::solid_of(together(ball({0, 0, 0}, 20.0, 3), ball({50, 0, 0}, 0.01, 0)));
  const FilledCavities filled = fill_cavities(bodies, 1.0);
  EXPECT_EQ(filled.cavities, 0u);
  EXPECT_EQ(filled.solid.mesh().n_faces(), bodies.mesh().n_faces());
  EXPECT_THROW(fill_cavities(bodies, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::convert
