// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/enclose.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "brep/mesh/components.h"
#include "brep/mesh/distance.h"
#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "tests/brep/bad_meshes.h"

namespace octotomy::brep {
namespace {

using shapes::inside_out;
using shapes::sheet;
using shapes::sphere;
using shapes::together;
using shapes::torus;

double largest_mm(const Triangles& from, const Triangles& to) {
  const std::vector<double> distances = SurfaceTree(to).distances_mm(from.points_mm);
  return *std::max_element(distances.begin(), distances.end());
}

TEST(Enclose, PointsLieOnTheSurfaceAndNothingIsFurtherFromItThanACell) {
  const Triangles ball = sphere({1, 2, 3}, 5, 4);
  const Enclosed made = enclose(ball, {.cell_mm = 0.25});
  EXPECT_TRUE(health(made.solid).solid());
  EXPECT_LT(largest_mm(made.solid.triangles(), ball), 0.25 / 500);
  EXPECT_LT(largest_mm(ball, made.solid.triangles()), 0.02);
  EXPECT_EQ(made.points_across_holes, 0u);
  EXPECT_NEAR(made.solid.size().volume_mm3, size_of(ball).volume_mm3, 2.0);
}

TEST(Enclose, AHoleIsClosedByASheetAcrossIt) {
  Triangles open = sphere({0, 0, 0}, 5, 4);
  std::erase_if(open.faces, [&](const auto& f) { return open.points_mm[f[0]].z > 3.0; });
  const Enclosed made = enclose(open, {.cell_mm = 0.25});
  EXPECT_TRUE(health(made.solid).solid());
  EXPECT_GT(made.points_across_holes, 100u);
  // The volume of the sphere without its cap of height 2.
  const double cap = std::numbers::pi * 4.0 * (15.0 - 2.0) / 3.0,
               whole = 4.0 / 3.0 * std::numbers::pi * 125.0;
  EXPECT_NEAR(made.solid.size().volume_mm3, whole - cap, 0.03 * whole);
}

TEST(Enclose, ShellsThatCrossBecomeTheirUnion) {
  const Triangles a = sphere({0, 0, 0}, 5, 4), b = sphere({6, 0.1, 0.2}, 5, 4);
  const Enclosed made = enclose(together(a, b), {.cell_mm = 0.25});
  EXPECT_TRUE(health(made.solid).solid());
  EXPECT_EQ(components(made.solid).size(), 1u);
  const double d = std::sqrt(36.05),
               lens = std::numbers::pi * (10 - d) * (10 - d) * (d * d + 20 * d) / (12 * d);
  EXPECT_NEAR(made.solid.size().volume_mm3, 2 * size_of(a).volume_mm3 - lens, 5.0);
}

TEST(Enclose, TheHullHasNoCavitiesAndNothingInThem) {
  const Triangles hollow = together(together(sphere({0, 0, 0}, 8, 4), inside_out(sphere({0, 0, 0}, 6, 4))),
                                    sphere({0, 0, 0}, 3, 3));
  EXPECT_EQ(components(enclose(hollow, {.cell_mm = 0.5}).solid).size(), 2u);
  const Enclosed hull = enclose(hollow, {.cell_mm = 0.5, .hull = true});
  EXPECT_EQ(hull.cavities_filled, 2u);
  EXPECT_NEAR(hull.solid.size().volume_mm3, 4.0 / 3.0 * std::numbers::pi * 512.0, 40.0);
}

TEST(Enclose, RefusesWhatEnclosesNothingAndCellsThatAreNone) {
  EXPECT_THROW(enclose(sheet(5, 10)), Error);
  EXPECT_THROW(enclose(inside_out(sphere({0, 0, 0}, 5, 3))), Error);
  EXPECT_THROW(enclose({}), Error);
  EXPECT_THROW(enclose(sphere({0, 0, 0}, 5, 3), {.cell_mm = 0.0}), std::invalid_argument);
  EXPECT_THROW(enclose(sphere({0, 0, 0}, 5, 3), {.cell_mm = 1e-7}), Error);
}

TEST(Enclose, ALongSpikeCostsItsLengthNotItsBox) {
  Triangles spiked = sphere({0, 0, 0}, 10, 2);
  spiked.points_mm[0] = {65000, 40000, 30000};  // a box of 6 * 10^11 cells
  const Enclosed made = enclose(spiked, {.cell_mm = 5.0});
  EXPECT_TRUE(health(made.solid).solid());
  // What is thinner than a cell is lost.
  EXPECT_NEAR(made.solid.size().high_mm.x, 10.0, 0.5);
}

TEST(Enclose, TooManyCellsAreRefusedBeforeTheyAreCounted) {
  try {
    enclose(shapes::box({0, 0, 0}, {1000, 1000, 1000}), {.cell_mm = 0.002});
    FAIL() << "10^12 cells were entered";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("too many along the surface"), std::string::npos)
        << error.what();
  }
}

TEST(Enclose, HasTheSameBitsOnOneThread) {
  Triangles open = torus(10, 3, 60, 30);
  open.faces.resize(open.faces.size() - 100);
  const Enclosed many = enclose(open, {.cell_mm = 0.5});
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(enclose(open, {.cell_mm = 0.5}).solid.triangles().points_mm, many.solid.triangles().points_mm);
}

}  // namespace
}  // namespace octotomy::brep
