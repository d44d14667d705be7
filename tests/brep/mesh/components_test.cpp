// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/components.h"

#include <gtest/gtest.h>

#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

TEST(Components, ComeLargestFirstWithTheirCavities) {
  using shapes::box;
  Triangles t = box({20, 0, 0}, {21, 1, 1});
  t = shapes::together(t, box({0, 0, 0}, {10, 10, 10}));
  t = shapes::together(t, shapes::inside_out(box({1, 1, 1}, {9, 9, 9})));
  t = shapes::together(t, box({2, 2, 2}, {4, 4, 4}));  // an island in the cavity
  t = shapes::together(t, shapes::inside_out(box({2.5, 2.5, 2.5}, {3, 3, 3})));
  const Mesh mesh = mesh_of(t);
  const std::vector<Component> pieces = components(mesh);
  ASSERT_EQ(pieces.size(), 3u);
  EXPECT_NEAR(pieces[0].volume_mm3, 1000 - 512, 1e-10);
  EXPECT_NEAR(pieces[0].area_mm2, 600 + 384, 1e-10);
  EXPECT_EQ(pieces[0].cavities, 1u);
  EXPECT_NEAR(pieces[1].volume_mm3, 8 - 0.125, 1e-12);
  EXPECT_EQ(pieces[1].cavities, 1u);
  EXPECT_NEAR(pieces[2].volume_mm3, 1, 1e-12);
  EXPECT_EQ(pieces[2].cavities, 0u);

  const SurfaceTree tree(t);
  const std::vector<Component> of_list = components(linked(t), [&]() -> const SurfaceTree& { return tree; });
  ASSERT_EQ(of_list.size(), pieces.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    EXPECT_EQ(of_list[i].faces, pieces[i].faces);
    EXPECT_EQ(of_list[i].volume_mm3, pieces[i].volume_mm3);
    EXPECT_EQ(of_list[i].cavities, pieces[i].cavities);
  }

  const Mesh largest = part_of(mesh, pieces.front().faces);
  EXPECT_NEAR(measure(largest).volume_mm3, 488, 1e-10);
  EXPECT_EQ(largest.n_vertices(), 16u);
  EXPECT_TRUE(health(largest).solid());
}

TEST(Components, AShellTurnedInsideOutStandsAloneWithItsSign) {
  const auto pieces = components(mesh_of(shapes::inside_out(shapes::box({0, 0, 0}, {1, 1, 1}))));
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_NEAR(pieces[0].volume_mm3, -1, 1e-12);
}

TEST(Components, AnOpenMeshHasNone) {
  Triangles open = shapes::box({0, 0, 0}, {1, 1, 1});
  open.faces.pop_back();
  EXPECT_THROW(components(mesh_of(open)), std::invalid_argument);
  EXPECT_THROW(components(linked(open), {}), std::invalid_argument);
  EXPECT_TRUE(components(Mesh()).empty());
}

TEST(Components, ACavityThatTouchesItsShellAtItsLargestXIsStillItsCavity) {
  // A tetrahedron in a cube, one corner of it a corner of the cube's own; beyond it a smaller cube that the
  // ray from there passes.
  const Triangles cube = shapes::box({0, 0, 0}, {4, 4, 4});
  const Triangles hollow{{{4, 4, 4}, {1, 2, 2}, {2, 1, 2}, {2, 2, 1}},
                         {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}};
  Triangles inward = size_of(hollow).volume_mm3 < 0.0 ? hollow : shapes::inside_out(hollow);
  const auto found = components(
      mesh_of(shapes::together(shapes::together(cube, inward), shapes::box({6, 3.5, 3.5}, {7, 4.5, 4.5}))));
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].cavities, 1u);
  EXPECT_NEAR(found[0].volume_mm3, 64.0 + size_of(inward).volume_mm3, 1e-12);
  EXPECT_NEAR(found[1].volume_mm3, 1.0, 1e-12);
}

}  // namespace
}  // namespace octotomy::brep
