// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/witness/class_witness.h"

#include <gtest/gtest.h>
#include <stdexcept>

namespace octotomy::verify {
namespace {

/// 0 up to x = 5, 100 from there on; samples 2 mm apart. At x = 5 and 6 the gradient is 25 / mm.
std::shared_ptr<voxel::Scene> step_scan() {
  auto scene = std::make_shared<voxel::Scene>();
  scene->lattice = voxel::axis_aligned_lattice(glm::ivec3(12), glm::dvec3(2.0), glm::dvec3(0.0));
  voxel::Int16Samples samples;
  for (std::size_t i = 0; i < scene->lattice.sample_count(); ++i) samples.push_back(i % 12 > 5 ? 100 : 0);
  scene->samples = std::move(samples);
  return scene;
}

AllowedSides side_at(const Witness& witness, const voxel::Scene& scene, double x) {
  return witness.allowed_sides(scene.lattice.lps_mm({x, 4, 4})).voxel;
}

const std::vector<glm::dvec2> dark_edge_bright{{0, 0}, {50, 25}, {100, 0}};

TEST(ClassWitness, AnEdgeIsAClassByItsGradient) {
  const auto scene = step_scan();
  const Witness bright = witness_of_class(scene, {dark_edge_bright, {50, 10}, 2});
  const Witness edge = witness_of_class(scene, {dark_edge_bright, {50, 10}, 1});
  EXPECT_EQ(side_at(bright, *scene, 9), certainly_in);
  EXPECT_EQ(side_at(bright, *scene, 2), certainly_out);
  EXPECT_EQ(side_at(bright, *scene, 6), certainly_out) << "its gradient is the edge's";
  EXPECT_EQ(side_at(edge, *scene, 5), certainly_in);
  EXPECT_EQ(side_at(edge, *scene, 6), certainly_in);
  EXPECT_EQ(side_at(edge, *scene, 7), certainly_out);
  EXPECT_EQ(side_at(edge, *scene, 6.5), either_side);
  EXPECT_EQ(side_at(edge, *scene, 5.5), certainly_in);
  EXPECT_EQ(side_at(edge, *scene, -0.8), certainly_out) << "beyond the scan";
}

TEST(ClassWitness, SamplesBesidePaddingAndBetweenTwoCentresAreUnsure) {
  auto scene = step_scan();
  const Witness tie = witness_of_class(scene, {{{-50, 0}, {50, 0}}, {1, 1}, 1});
  EXPECT_EQ(side_at(tie, *scene, 2), either_side);
  std::get<voxel::Int16Samples>(scene->samples)[9 + 12 * (4 + 12 * 4)] = -999;
  scene->padding = -999.0;
  const Witness bright = witness_of_class(scene, {dark_edge_bright, {50, 10}, 2});
  EXPECT_EQ(side_at(bright, *scene, 9), certainly_out);
  EXPECT_EQ(side_at(bright, *scene, 10), either_side);
  EXPECT_EQ(side_at(bright, *scene, 11), certainly_in);
}

TEST(ClassWitness, AClassThatIsNoneIsRefused) {
  EXPECT_THROW(witness_of_class(step_scan(), {{{0, 0}}, {1, 1}, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::verify
