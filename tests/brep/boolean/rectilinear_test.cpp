// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/boolean/rectilinear.h"

#include <gtest/gtest.h>

#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

constexpr Wanted all_wanted{true, true, true, true};

double volume_of(const std::optional<Results>& results, ResultPlace place) {
  return size_of(results.value()[place].value()).volume_mm3;
}

TEST(Rectilinear, BoxesThatShareAnEdgeHaveAllFourResults) {
  const std::optional<Results> results = rectilinear_results(
      shapes::box({0, 0, 0}, {2, 2, 2}), shapes::box({2, 2, 0}, {3, 4, 2}), all_wanted, 0.0);
  EXPECT_DOUBLE_EQ(volume_of(results, of_union), 12.0);
  EXPECT_DOUBLE_EQ(volume_of(results, of_intersection), 0.0);
  EXPECT_DOUBLE_EQ(volume_of(results, of_a_minus_b), 8.0);
  EXPECT_DOUBLE_EQ(volume_of(results, of_b_minus_a), 4.0);
  const Health found = health((*results)[of_union].value());
  EXPECT_TRUE(found.closed && found.manifold && found.oriented);
  EXPECT_EQ(found.self_intersections, 0u);
}

TEST(Rectilinear, APlugFillsItsCavity) {
  const Triangles hollow = shapes::together(shapes::box({0, 0, 0}, {4, 4, 4}),
                                            shapes::inside_out(shapes::box({1, 1, 1}, {3, 3, 3})));
  const std::optional<Results> results =
      rectilinear_results(hollow, shapes::box({1, 1, 1}, {3, 3, 3}), all_wanted, 0.0);
  EXPECT_DOUBLE_EQ(volume_of(results, of_union), 64.0);
  EXPECT_DOUBLE_EQ(volume_of(results, of_intersection), 0.0);
  EXPECT_DOUBLE_EQ(volume_of(results, of_a_minus_b), 56.0);
}

TEST(Rectilinear, CoordinatesWithinTheToleranceAreOnePlane) {
  const std::optional<Results> results = rectilinear_results(
      shapes::box({0, 0, 0}, {2, 2, 2}), shapes::box({2 + 1e-13, 0, 1e-13}, {4, 2, 2}), all_wanted, 1e-12);
  EXPECT_EQ((*results)[of_intersection].value().faces.size(), 0u);
  EXPECT_NEAR(volume_of(results, of_union), 16.0, 1e-12);
  EXPECT_EQ((*results)[of_union].value().faces.size(), 2u * (2 * 2 + 2 * 2 + 2));
}

TEST(Rectilinear, AnObliqueFaceAndAnOverlapAreRefused) {
  const Triangles box = shapes::box({0, 0, 0}, {2, 2, 2});
  EXPECT_FALSE(rectilinear_results(box, shapes::sphere({0, 0, 0}, 1, 1), all_wanted, 0.0));
  EXPECT_FALSE(
      rectilinear_results(shapes::together(box, shapes::box({1, 1, 1}, {3, 3, 3})), box, all_wanted, 0.0));
}

}  // namespace
}  // namespace octotomy::brep
