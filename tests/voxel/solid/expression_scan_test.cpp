// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/expression_scan.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "voxel/solid/grey_owner.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

constexpr int samples_a_side = 24;

/// Samples between 0 and 0.75, in steps of a grey octree far below 1.
std::shared_ptr<const Scene> map_of_shares() {
  Scene scene;
  scene.lattice = axis_aligned_lattice(glm::ivec3(samples_a_side), glm::dvec3(1.0), glm::dvec3(0.0));
  FloatSamples samples(scene.lattice.sample_count());
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = 0.75f * static_cast<float>(i % 17) / 16.0f;
  scene.samples = std::move(samples);
  return std::make_shared<const Scene>(std::move(scene));
}

float share_at(const Scene& scene, const glm::ivec3& at) {
  return std::get<FloatSamples>(
      scene.samples)[static_cast<std::size_t>(at.x + samples_a_side * (at.y + samples_a_side * at.z))];
}

class AnExpressionScan : public testing::Test {
 protected:
  std::shared_ptr<const Scene> scene_ = map_of_shares();
  GreyOctree grey_ = grey_octree_of(Universe{5, glm::dmat4(1.0)}, *scene_, -1).with_scan(scene_);
  Expression head_ = window_of(grey_, -0.5);
};

TEST_F(AnExpressionScan, KeepsSamplesAtRestToTheBitAndMarksHoles) {
  const ExpressionScan made = expression_scan(*scene_, grey_, head_ - Sphere{{12, 12, 12}, 4.0});
  std::uint64_t holes = 0;
  for (int z = 0; z < samples_a_side; ++z)
    for (int y = 0; y < samples_a_side; ++y)
      for (int x = 0; x < samples_a_side; ++x) {
        const bool is_hole = glm::distance(glm::dvec3(x, y, z), glm::dvec3(12)) <= 4.0;
        holes += is_hole ? 1 : 0;
        ASSERT_EQ(share_at(made.scene, {x, y, z}),
                  is_hole ? static_cast<float>(made.hole) : share_at(*scene_, {x, y, z}));
      }
  EXPECT_EQ(made.hole_samples, holes);
  EXPECT_EQ(made.changed_samples, holes);
  EXPECT_EQ(made.scene.padding, made.hole);
  EXPECT_LT(made.hole, 0.0);
}

/// A plan whose voxels are as large as the samples and whose universe begins before the scan.
TEST(ExpressionScan, IsTheSameInAUniverseThatLiesOnTheSamples) {
  const auto scene = map_of_shares();
  glm::dmat4 lps_from_voxel(1.0);
  lps_from_voxel[3] = {-3.0, -5.0, -1.0, 1.0};
  const GreyOctree own = grey_octree_of(Universe{5, glm::dmat4(1.0)}, *scene, -1).with_scan(scene);
  const GreyOctree shifted = grey_octree_of(Universe{5, lps_from_voxel}, *scene, -1).with_scan(scene);
  const auto scan = [&](const GreyOctree& grey) {
    const Expression head = window_of(grey, -0.5);
    const Expression piece = head & Sphere{{12, 12, 12}, 4.0};
    const glm::dmat4 up{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 2.5, 1}};
    return expression_scan(*scene, grey, moved(piece, up) | (head - Sphere{{12, 12, 12}, 4.0}));
  };
  const ExpressionScan expected = scan(own), made = scan(shifted);
  EXPECT_GT(made.changed_samples, 100u);
  EXPECT_EQ(made.changed_samples, expected.changed_samples);
  EXPECT_EQ(made.hole_samples, expected.hole_samples);
  EXPECT_EQ(std::get<FloatSamples>(made.scene.samples), std::get<FloatSamples>(expected.scene.samples));
}

TEST(ExpressionScan, RefusesAScanThatReachesOutOfTheUniverse) {
  const auto scene = map_of_shares();
  glm::dmat4 lps_from_voxel(1.0);
  lps_from_voxel[3] = {1.0, 0.0, 0.0, 1.0};
  const GreyOctree grey = grey_octree_of(Universe{5, lps_from_voxel}, *scene, -1).with_scan(scene);
  EXPECT_THROW(expression_scan(*scene, grey, window_of(grey, -0.5)), Error);
}

TEST(ExpressionScan, HolesLieBelowFloatsThatAreFurtherApartThanOne) {
  Scene scene = *map_of_shares();
  for (float& sample : std::get<FloatSamples>(scene.samples)) sample -= 16777216.0f;
  const auto shared = std::make_shared<const Scene>(scene);
  const GreyOctree grey = grey_octree_of(Universe{5, glm::dmat4(1.0)}, *shared, -1).with_scan(shared);
  const Expression head = window_of(grey, -16777300.0);
  const ExpressionScan made = expression_scan(*shared, grey, head - Sphere{{12, 12, 12}, 4.0});
  EXPECT_EQ(made.hole, -16777218.0);
  EXPECT_EQ(share_at(made.scene, {12, 12, 12}), -16777218.0f);
}

TEST_F(AnExpressionScan, FillsObjectsWithoutSamplesByAValueThatIsNoWholeNumber) {
  const Expression with_plate = Sphere{{12, 12, 12}, 4.0} | (head_ - Sphere{{12, 12, 12}, 4.0});
  const ExpressionScan made = expression_scan(*scene_, grey_, with_plate);
  EXPECT_EQ(made.filled, 0.75) << "the largest sample";
  std::uint64_t in_plate = 0;
  for (int z = 8; z <= 16; ++z)
    for (int y = 8; y <= 16; ++y)
      for (int x = 8; x <= 16; ++x)
        in_plate += glm::distance(glm::dvec3(x, y, z), glm::dvec3(12)) <= 4.0 ? 1 : 0;
  EXPECT_EQ(made.filled_samples, in_plate);
  EXPECT_NEAR(share_at(made.scene, {12, 12, 12}), 0.75, 0.5 * grey_.step());
  EXPECT_EQ(made.hole_samples, 0u);
  ExpressionScanOptions options;
  options.filled = 0.3;
  EXPECT_NEAR(share_at(expression_scan(*scene_, grey_, with_plate, options).scene, {12, 12, 12}), 0.3,
              0.5 * grey_.step());
}

TEST_F(AnExpressionScan, FillsNothingWhereAnObjectIsCompletedByItsScan) {
  const Expression part = with_samples(Sphere{{12, 12, 12}, 4.0}, all_samples(grey_));
  const ExpressionScan made = expression_scan(*scene_, grey_, part);
  EXPECT_EQ(made.filled_samples, 0u);
  EXPECT_EQ(share_at(made.scene, {13, 11, 12}), share_at(*scene_, {13, 11, 12}));
}

TEST_F(AnExpressionScan, ReportsProgressThatOnlyRises) {
  double last = -1.0;
  ExpressionScanOptions options;
  options.progress.report = [&](double share) {
    EXPECT_GE(share, last);
    last = share;
  };
  expression_scan(*scene_, grey_, head_ - Sphere{{12, 12, 12}, 4.0}, options);
  EXPECT_GT(last, 0.3);
  EXPECT_LE(last, 1.0);
}

TEST_F(AnExpressionScan, RefusesValuesThatTheSamplesCannotHave) {
  ExpressionScanOptions options;
  options.filled = 40000.0;
  EXPECT_THROW(expression_scan(*scene_, grey_, head_, options), Error);
  options.filled = {};
  options.hole = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(expression_scan(*scene_, grey_, head_, options), Error);
  options.hole = 1e6;
  EXPECT_NO_THROW(expression_scan(*scene_, grey_, head_, options)) << "as single precision holds it";
}

}  // namespace
}  // namespace octotomy::voxel
