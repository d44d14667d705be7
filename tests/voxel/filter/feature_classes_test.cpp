// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/feature_classes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/voxel/field_scene.h"
#include "tests/voxel/linear_scene.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

using tests::field_scene;
using tests::for_each_index;
using tests::sample_at;

double blurred_ball(double distance_mm, double radius_mm, double low, double high) {
  return low + (high - low) / (1.0 + std::exp((distance_mm - radius_mm) / 0.8));
}

/// A bright ball of 1000 and a ball of 500, both in 0 and with blurred edges: the bright one's edge has samples of
/// 500, too.
double two_balls(const glm::dvec3& p) {
  return std::max(blurred_ball(glm::distance(p, {-12, 0, 0}), 9.0, 0.0, 1000.0),
                  blurred_ball(glm::distance(p, {12, 0, 0}), 9.0, 0.0, 500.0));
}

Scene scan() {
  return field_scene<std::int16_t>(axis_aligned_lattice({56, 32, 32}, {1, 1, 1}, {-27.5, -15.5, -15.5}),
                                   two_balls);
}

TEST(FeatureClasses, PartATissueFromTheEdgeOfAnotherThatHasItsDensity) {
  const Scene scene = scan();
  const FeatureClasses classes = feature_classes(scene, 5);
  ASSERT_EQ(classes.centres.size(), 5u);
  const std::size_t tissue = classes.nearest(500.0, 0.0);
  EXPECT_NE(tissue, classes.nearest(500.0, 250.0));
  EXPECT_NE(tissue, classes.nearest(0.0, 0.0));
  EXPECT_NE(tissue, classes.nearest(1000.0, 0.0));
  const Scene map = class_map(scene, classes);
  int in_tissue = 0, by_window = 0, by_class = 0;
  for_each_index(scene.lattice, 0, [&](const glm::ivec3& at) {
    const glm::dvec3 p = scene.lattice.lps_mm(at);
    const bool is_class = sample_at(map, at) == static_cast<double>(tissue + 1);
    if (glm::distance(p, {12, 0, 0}) < 6.0) {
      ++in_tissue;
      EXPECT_TRUE(is_class);
    }
    // At the bright ball's edge a window about 500 is wrong where the class is right.
    if (p.x > -1.0) return;
    by_window += std::abs(sample_at(scene, at) - 500.0) < 150.0;
    by_class += is_class;
  });
  EXPECT_GT(in_tissue, 800);
  EXPECT_GT(by_window, 300);
  EXPECT_EQ(by_class, 0);
}

TEST(FeatureClasses, HaveSharesThatSumToOneAndRiseInDensity) {
  const FeatureClasses classes = feature_classes(scan(), 3);
  double sum = 0.0;
  for (std::size_t i = 0; i < classes.centres.size(); ++i) {
    sum += classes.centres[i].share;
    if (i > 0) {
      EXPECT_LE(classes.centres[i - 1].density, classes.centres[i].density);
    }
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
}

TEST(FeatureClasses, TheGradientOfALinearFieldIsExactOnAnyLattice) {
  const double truth = glm::length(glm::dvec3(17, -5, 3));
  const Lattice lattice = tests::oblique_lattice(true);
  const Scene lengths = gradient_length(field_scene<float>(lattice, tests::linear_field));
  for_each_index(lattice, 1, [&](const glm::ivec3& p) { ASSERT_NEAR(sample_at(lengths, p), truth, 1e-2); });
}

TEST(FeatureClasses, LeavePaddingOutAndAreTheSameOnAnyThreads) {
  Scene scene = scan();
  std::get<Int16Samples>(scene.samples)[7] = -2000;
  scene.padding = -2000.0;
  const FeatureClasses classes = feature_classes(scene, 3);
  EXPECT_EQ(sample_at(class_map(scene, classes), {7, 0, 0}), 0.0);
  const auto on = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return std::get<Int16Samples>(class_map(scene, feature_classes(scene, 4)).samples);
  };
  EXPECT_EQ(on(1), on(2));
}

TEST(FeatureClasses, RefuseNumbersAndScansThatHaveNone) {
  Scene scene = scan();
  EXPECT_THROW(feature_classes(scene, 1), std::invalid_argument);
  EXPECT_THROW(feature_classes(scene, 9), std::invalid_argument);
  const Lattice lattice = axis_aligned_lattice({8, 8, 8}, {1, 1, 1}, {0, 0, 0});
  EXPECT_THROW(feature_classes(field_scene<float>(lattice, [](const glm::dvec3&) { return 3.0; }), 2), Error);
  scene.meaning = Meaning::Label;
  EXPECT_THROW(feature_classes(scene, 3), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
