// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/boolean/corefine_batches.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "brep/boolean/boolean.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

constexpr Wanted all_results = {true, true, true, true};
constexpr std::size_t small_batches = 400;

/// Balls in a row; every third of b is away from those of a, and each of a's has a cavity.
struct Rows {
  Triangles a, b;
};

Triangles turned(Triangles surface) {
  for (auto& face : surface.faces) std::swap(face[1], face[2]);
  return surface;
}

Rows rows(int count) {
  Rows rows;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 at(10.0 * i, 0.1 * (i % 7), 0.0);
    rows.a = shapes::together(rows.a,
                              shapes::together(shapes::sphere(at, 3, 2), turned(shapes::sphere(at, 1, 1))));
    rows.b = shapes::together(rows.b, shapes::sphere(at + glm::dvec3(0.3, i % 3 == 0 ? 50 : 2.4, 0.2), 2, 2));
  }
  return rows;
}

void expect_same(const Corefined& apart, const Corefined& whole) {
  ASSERT_EQ(apart.failure, "");
  for (std::size_t r = 0; r < whole.results.size(); ++r) {
    ASSERT_EQ(apart.results[r].has_value(), whole.results[r].has_value()) << r;
    if (!whole.results[r]) continue;
    EXPECT_EQ(apart.results[r]->points_mm, whole.results[r]->points_mm) << r;
    EXPECT_EQ(apart.results[r]->faces.size(), whole.results[r]->faces.size()) << r;
    EXPECT_NEAR(size_of(*apart.results[r]).volume_mm3, size_of(*whole.results[r]).volume_mm3, 1e-9) << r;
    EXPECT_TRUE(health(*apart.results[r]).solid()) << r;
  }
}

TEST(CorefineInBatches, HasTheResultsOfTheWhole) {
  const Rows both = rows(31);
  const Mesh a = mesh_of(both.a), b = mesh_of(both.b);
  const Corefined apart = corefine_in_batches(a, b, all_results, {}, small_batches);
  const Corefined whole = corefine(a, b, all_results);
  expect_same(apart, whole);
  auto uncut = whole.uncut;
  for (std::size_t side = 0; side < 2; ++side) {
    auto found = apart.uncut[side];
    std::sort(found.begin(), found.end());
    std::sort(uncut[side].begin(), uncut[side].end());
    EXPECT_EQ(found, uncut[side]) << side;
    EXPECT_FALSE(found.empty());
  }
}

TEST(CorefineInBatches, BitsDoNotDependOnThreads) {
  const Rows both = rows(20);
  const Mesh a = mesh_of(both.a), b = mesh_of(both.b);
  const auto answer = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return corefine_in_batches(a, b, all_results, {}, small_batches);
  };
  const Corefined one = answer(1), four = answer(4);
  for (std::size_t r = 0; r < one.results.size(); ++r) {
    EXPECT_EQ(one.results[r]->points_mm, four.results[r]->points_mm);
    EXPECT_EQ(one.results[r]->faces, four.results[r]->faces);
  }
}

TEST(CorefineInBatches, AShellWithinAnotherStaysWithIt) {
  // The small balls of b lie within the large one of a, and a ball of a lies far away with one of b's on it.
  const Triangles a = shapes::together(shapes::sphere({0, 0, 0}, 20, 3), shapes::sphere({60, 0, 0}, 5, 3));
  Triangles b = shapes::sphere({63, 0.1, 0.2}, 4, 3);
  for (int i = -1; i < 2; ++i) b = shapes::together(b, shapes::sphere({8.0 * i, 1, 2}, 2, 2));
  const Corefined apart = corefine_in_batches(mesh_of(a), mesh_of(b), all_results, {}, small_batches);
  expect_same(apart, corefine(mesh_of(a), mesh_of(b), all_results));
  EXPECT_EQ(health(*apart.results[of_a_minus_b]).shells, 5u);
}

TEST(CorefineInBatches, OneBatchIsTheWholeBitForBit) {
  const Rows both = rows(3);
  const Corefined apart = corefine_in_batches(mesh_of(both.a), mesh_of(both.b), all_results, {}, 100'000);
  const Corefined whole = corefine(mesh_of(both.a), mesh_of(both.b), all_results);
  for (std::size_t r = 0; r < whole.results.size(); ++r) {
    EXPECT_EQ(apart.results[r]->points_mm, whole.results[r]->points_mm);
    EXPECT_EQ(apart.results[r]->faces, whole.results[r]->faces);
  }
}

TEST(CorefineInBatches, AnOperandThatIntersectsItselfIsNamedFromItsBatch) {
  Rows both = rows(12);
  // Two balls of a cross each other where a ball of b cuts them.
  both.a = shapes::together(
      both.a, shapes::together(shapes::sphere({-30, 0, 0}, 3, 2), shapes::sphere({-27, 0, 0.1}, 3, 2)));
  both.b = shapes::together(both.b, shapes::sphere({-28.4, 2.5, 0.2}, 2, 2));
  const Corefined apart =
      corefine_in_batches(mesh_of(both.a), mesh_of(both.b), all_results, {}, small_batches);
  EXPECT_TRUE(apart.meets_itself || !apart.failure.empty());
}

TEST(CorefineInBatches, OpenPatchesEndAtTheirBorders) {
  // The upper parts of balls, cut by small balls far above their borders.
  Rows both = rows(24);
  std::erase_if(both.a.faces, [&](const auto& face) {
    return std::any_of(face.begin(), face.end(),
                       [&](std::uint32_t v) { return both.a.points_mm[v].y < -0.5; });
  });
  const Mesh a = mesh_of(both.a), b = mesh_of(both.b);
  const Wanted wanted = {true, true, false, false};
  const Corefined apart = corefine_in_batches(a, b, wanted, {}, small_batches),
                  whole = corefine(a, b, wanted);
  ASSERT_EQ(apart.failure, whole.failure);
  for (const std::size_t r : {of_union, of_intersection}) {
    ASSERT_TRUE(apart.results[r] && whole.results[r]);
    EXPECT_EQ(apart.results[r]->points_mm.size(), whole.results[r]->points_mm.size());
    EXPECT_NEAR(size_of(*apart.results[r]).area_mm2, size_of(*whole.results[r]).area_mm2, 1e-9);
  }
  EXPECT_EQ(apart.uncut[1].size(), whole.uncut[1].size());
}

TEST(CorefineInBatches, StopsWhenAsked) {
  const Rows both = rows(31);
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(
      corefine_in_batches(mesh_of(both.a), mesh_of(both.b), all_results, source.get_token(), small_batches),
      BooleanStopped);
}

TEST(CorefineInBatches, ABooleanOfManyCubesHasTheVolumeOfItsPairs) {
  // 1,000 pairs: two batches of the default size.
  Triangles a, b;
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 at(2.0 * (i % 10), 2.0 * (i / 10 % 10), 2.0 * (i / 100));
    a = shapes::together(a, shapes::box(at, at + 1.0));
    b = shapes::together(b, shapes::box(at + 0.37, at + 1.37));
  }
  const Solid solid_a = trusted_solid(a, Proof::Connection), solid_b = trusted_solid(b, Proof::Connection);
  const Booleans all = booleans(solid_a, solid_b, {true, true, true, true});
  const double common = 0.63 * 0.63 * 0.63;
  EXPECT_NEAR(all.intersection->size().volume_mm3, 1000 * common, 1e-8);
  EXPECT_NEAR(all.united->size().volume_mm3, 1000 * (2 - common), 1e-8);
  EXPECT_NEAR(all.a_minus_b->size().volume_mm3, 1000 * (1 - common), 1e-8);
  EXPECT_NEAR(all.b_minus_a->size().volume_mm3, 1000 * (1 - common), 1e-8);
  EXPECT_EQ(health(all.united->triangles()).shells, 1000u);
}

}  // namespace
}  // namespace octotomy::brep
