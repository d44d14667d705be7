// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/edge_operator.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/voxel/field_scene.h"
#include "tests/voxel/linear_scene.h"

namespace octotomy::voxel {
namespace {

using tests::field_scene;
using tests::for_each_index;
using tests::sample_at;

TEST(ZuckerHummel, GivesALinearFieldsGradientOnAnyLattice) {
  const double truth = glm::length(glm::dvec3(17, -5, 3));
  for (const bool left_handed : {false, true}) {
    const Lattice lattice = tests::oblique_lattice(left_handed);
    const Scene edges = zucker_hummel(field_scene<float>(lattice, tests::linear_field));
    for_each_index(lattice, 1, [&](const glm::ivec3& p) { ASSERT_NEAR(sample_at(edges, p), truth, 1e-2); });
  }
}

TEST(ZuckerHummel, IsHighestOnAnEdgeAndZeroAwayFromIt) {
  const Lattice lattice = axis_aligned_lattice({20, 20, 20}, {1, 1, 1}, {-9.5, -9.5, -9.5});
  const Scene scene =
      field_scene<std::int16_t>(lattice, [](const glm::dvec3& p) { return p.x > 0 ? 1000.0 : 0.0; });
  const Scene edges = zucker_hummel(scene);
  for_each_index(lattice, 1, [&](const glm::ivec3& p) {
    // The step of 1000 lies between 9 and 10: each side sees half of it a millimetre.
    ASSERT_NEAR(sample_at(edges, p), p.x == 9 || p.x == 10 ? 500.0 : 0.0, 1e-3);
  });
}

TEST(MarrHildreth, GivesAQuadraticsLaplacian) {
  const Lattice lattice = axis_aligned_lattice({30, 34, 24}, {1, 0.8, 1.6}, {-15, -14, -19});
  const auto square = [](const glm::dvec3& p) {
    return 3 * p.x * p.x - p.y * p.y + 0.5 * p.z * p.z + 7 * p.x;
  };
  const Scene edges = marr_hildreth(field_scene<float>(lattice, square), 1.0);
  int compared = 0;
  for_each_index(lattice, 8, [&](const glm::ivec3& p) {
    ASSERT_NEAR(sample_at(edges, p), 2 * (3 - 1 + 0.5), 0.01);
    ++compared;
  });
  EXPECT_GT(compared, 1000);
}

TEST(MarrHildreth, PassesThroughZeroOnAnEdgePositiveOnItsDarkSide) {
  const Lattice lattice = axis_aligned_lattice({40, 16, 16}, {1, 1, 1}, {-20, -8, -8});
  for (const double edge_mm : {-3.5, 0.5, 6.5}) {  // between two samples
    const Scene scene = field_scene<std::int16_t>(
        lattice, [&](const glm::dvec3& p) { return p.x > edge_mm ? 800.0 : -200.0; });
    const Scene edges = marr_hildreth(scene, 1.5);
    int crossings = 0;
    for (int x = 6; x + 1 < 34; ++x) {
      const double here = sample_at(edges, {x, 8, 8});
      const double next = sample_at(edges, {x + 1, 8, 8});
      // The weights cut off leave a ripple of a thousandth of the step.
      if (!(here > 1.0 && next < -1.0)) continue;
      ++crossings;
      EXPECT_NEAR(lattice.lps_mm({x + here / (here - next), 8, 8}).x, edge_mm, 0.02);
    }
    EXPECT_EQ(crossings, 1) << edge_mm;
  }
}

TEST(RobertsAndPrewitt, GiveALinearFieldsGradientOnAnyLattice) {
  const double truth = glm::length(glm::dvec3(17, -5, 3));
  for (const bool left_handed : {false, true}) {
    const Lattice lattice = tests::oblique_lattice(left_handed);
    const Scene scene = field_scene<float>(lattice, tests::linear_field);
    const Scene sharp = roberts(scene), plane = prewitt(scene);
    for_each_index(lattice, 1, [&](const glm::ivec3& p) {
      ASSERT_NEAR(sample_at(sharp, p), truth, 1e-2);
      ASSERT_NEAR(sample_at(plane, p), truth, 1e-2);
    });
  }
}

TEST(RobertsAndPrewitt, SeeAStepOneCellWideAndTwoSamplesWide) {
  const Lattice lattice = axis_aligned_lattice({20, 20, 20}, {1, 1, 1}, {-9.5, -9.5, -9.5});
  const Scene scene =
      field_scene<std::int16_t>(lattice, [](const glm::dvec3& p) { return p.x > 0 ? 1000.0 : 0.0; });
  const Scene sharp = roberts(scene), plane = prewitt(scene);
  // The step lies between samples 9 and 10, which is the middle of cell 9: the result's lattice puts the
  // sample there.
  EXPECT_EQ(sharp.lattice.lps_mm({9, 9, 9}), glm::dvec3(0.0));
  EXPECT_EQ(plane.lattice.lps_mm({9, 9, 9}), lattice.lps_mm({9, 9, 9}));
  for_each_index(lattice, 1, [&](const glm::ivec3& p) {
    ASSERT_NEAR(sample_at(sharp, p), p.x == 9 ? 1000.0 : 0.0, 1e-3);
    ASSERT_NEAR(sample_at(plane, p), p.x == 9 || p.x == 10 ? 500.0 : 0.0, 1e-3);
  });
}

TEST(RobertsAndPrewitt, WeighTheSamplesAboutOneAsTheyAreDefined) {
  const Lattice lattice = axis_aligned_lattice({7, 7, 7}, {1, 1, 1}, {0, 0, 0});
  const Scene scene =
      field_scene<float>(lattice, [](const glm::dvec3& p) { return p == glm::dvec3(3, 3, 3) ? 36.0 : 0.0; });
  const Scene sharp = roberts(scene), plane = prewitt(scene);
  // Prewitt: a ninth of half the sample along each axis on which it lies ahead or behind.
  EXPECT_NEAR(sample_at(plane, {2, 3, 3}), 2.0, 1e-6);
  EXPECT_NEAR(sample_at(plane, {2, 2, 3}), 2.0 * std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(sample_at(plane, {2, 2, 2}), 2.0 * std::sqrt(3.0), 1e-6);
  EXPECT_NEAR(sample_at(plane, {3, 3, 3}), 0.0, 1e-6);
  // Roberts: the first sample of a cell is on three diagonals, one next to it on two, one across a face on one,
  // the opposite corner on none.
  EXPECT_NEAR(sample_at(sharp, {3, 3, 3}), 18.0 * std::sqrt(3.0), 1e-5);
  EXPECT_NEAR(sample_at(sharp, {2, 3, 3}), 9.0 * std::sqrt(6.0), 1e-5);
  EXPECT_NEAR(sample_at(sharp, {2, 2, 3}), 9.0 * std::sqrt(2.0), 1e-5);
  EXPECT_NEAR(sample_at(sharp, {2, 2, 2}), 0.0, 1e-6);
}

TEST(DifferenceOfGaussians, GivesAQuadraticsLaplacianAndAMarrHildrethsEdge) {
  const Lattice lattice = axis_aligned_lattice({34, 38, 28}, {1, 0.8, 1.6}, {-17, -16, -21});
  const auto square = [](const glm::dvec3& p) {
    return 3 * p.x * p.x - p.y * p.y + 0.5 * p.z * p.z + 7 * p.x;
  };
  const Scene laplacian = difference_of_gaussians(field_scene<float>(lattice, square), 1.0);
  int compared = 0;
  for_each_index(lattice, 10, [&](const glm::ivec3& p) {
    ASSERT_NEAR(sample_at(laplacian, p), 2 * (3 - 1 + 0.5), 0.02);
    ++compared;
  });
  EXPECT_GT(compared, 1000);
  const Lattice line = axis_aligned_lattice({40, 16, 16}, {1, 1, 1}, {-20, -8, -8});
  const Scene step =
      field_scene<std::int16_t>(line, [](const glm::dvec3& p) { return p.x > 0.5 ? 800.0 : -200.0; });
  const Scene difference = difference_of_gaussians(step, 1.2, 1.6), marr = marr_hildreth(step, 1.6);
  double largest = 0.0, apart = 0.0;
  for (int x = 6; x < 34; ++x) {
    largest = std::max(largest, sample_at(marr, {x, 8, 8}));
    apart = std::max(apart, std::abs(sample_at(difference, {x, 8, 8}) - sample_at(marr, {x, 8, 8})));
  }
  EXPECT_LT(apart, 0.12 * largest);
  const double here = sample_at(difference, {20, 8, 8}), next = sample_at(difference, {21, 8, 8});
  EXPECT_GT(here, 0.0) << "positive on the dark side";
  EXPECT_NEAR(line.lps_mm({20 + here / (here - next), 8, 8}).x, 0.5, 0.02);
}

TEST(EdgeOperators, RefuseLabelsAndShearStopAndAreTheSameOnAnyThreads) {
  Scene scene = tests::linear_scene(tests::oblique_lattice());
  const auto on = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return std::vector{std::get<FloatSamples>(zucker_hummel(scene).samples),
                       std::get<FloatSamples>(marr_hildreth(scene, 1.2).samples),
                       std::get<FloatSamples>(roberts(scene).samples),
                       std::get<FloatSamples>(prewitt(scene).samples),
                       std::get<FloatSamples>(difference_of_gaussians(scene, 1.2).samples)};
  };
  EXPECT_EQ(on(1), on(2));
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(zucker_hummel(scene, {stop.get_token(), {}}), Stopped);
  EXPECT_THROW(marr_hildreth(scene, 1.0, {stop.get_token(), {}}), Stopped);
  EXPECT_THROW(roberts(scene, {stop.get_token(), {}}), Stopped);
  EXPECT_THROW(prewitt(scene, {stop.get_token(), {}}), Stopped);
  EXPECT_THROW(difference_of_gaussians(scene, 1.0, 1.6, {stop.get_token(), {}}), Stopped);
  EXPECT_THROW(difference_of_gaussians(scene, 1.0, 1.0), std::invalid_argument);
  EXPECT_THROW(difference_of_gaussians(scene, 0.0), std::invalid_argument);
  Scene sheared = scene;
  sheared.lattice.lps_from_voxel[2] += 0.3 * sheared.lattice.lps_from_voxel[1];
  EXPECT_THROW(marr_hildreth(sheared, 1.0), std::invalid_argument);
  EXPECT_NO_THROW(zucker_hummel(sheared));
  scene.meaning = Meaning::Label;
  EXPECT_THROW(zucker_hummel(scene), std::invalid_argument);
  EXPECT_THROW(roberts(scene), std::invalid_argument);
  EXPECT_THROW(prewitt(scene), std::invalid_argument);
  EXPECT_THROW(difference_of_gaussians(scene, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
