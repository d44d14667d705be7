// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/shells.h"

#include <gtest/gtest.h>

#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

TEST(Shells, AreConnectedAcrossEdgesAndNotAcrossCorners) {
  // The second box touches the first in a corner; the third has lost two triangles.
  Triangles surface = shapes::box({0, 0, 0}, {1, 1, 1});
  append(shapes::box({1, 1, 1}, {2, 2, 2}), surface);
  append(shapes::box({5, 0, 0}, {6, 1, 1}), surface);
  surface.faces.resize(surface.faces.size() - 2);
  const auto found = shells(linked(surface));
  ASSERT_EQ(found.size(), 3u);
  std::uint32_t next = 0;
  for (const auto& shell : found)
    for (const std::uint32_t f : shell) EXPECT_EQ(f, next++);
  EXPECT_EQ(found[0].size(), 12u);
  EXPECT_EQ(found[2].size(), 10u);
}

TEST(Shells, AnAppendedSurfaceKeepsItsVolumeAndPoints) {
  Triangles surface = shapes::box({0, 0, 0}, {1, 2, 3});
  append(shapes::sphere({9, 0, 0}, 2, 3), surface);
  EXPECT_TRUE(health(surface).solid());
  EXPECT_NEAR(size_of(surface).volume_mm3, 6.0 + size_of(shapes::sphere({9, 0, 0}, 2, 3)).volume_mm3, 1e-12);
}

}  // namespace
}  // namespace octotomy::brep
