// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certificate/certify_alone.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <vector>

#include "verify/witness/slice_witness.h"
#include "verify/witness/witness.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/slice_mask.h"

namespace octotomy::verify {
namespace {

/// A mask of three slices in 64^3 voxels of a millimetre, with no contour through a voxel's centre.
class AMaskOfSlices : public testing::Test {
 protected:
  static voxel::Universe universe() {
    return {6,
            voxel::axis_aligned_lattice(glm::ivec3(64), glm::dvec3(1.0), glm::dvec3(-31.5)).lps_from_voxel};
  }

  static voxel::SliceMask mask(const glm::dvec2& shift_mm = glm::dvec2(0.0), double wider_mm = 0.0) {
    const auto square = [&](double half_mm) {
      const double h = half_mm + wider_mm;
      std::vector<glm::dvec2> corners{{-h, -h}, {h, -h}, {h, h}, {-h, h}};
      for (glm::dvec2& corner : corners) corner += shift_mm;
      return corners;
    };
    voxel::SliceMask made;
    made.view = {{0.0, 0.0, 1.0}, {0.0, 1.0, 0.0}, {-1.0, 0.0, 0.0}};
    made.slices = {{-10.1, {square(8.21)}}, {0.2, {square(14.13)}}, {10.3, {square(11.37), square(3.19)}}};
    return made;
  }

  static Witness witness() {
    const voxel::SliceMask asked = mask();
    DrawnStack stack{asked.view.look, asked.view.up, asked.view.right, {}, true};
    for (const voxel::SliceMask::Slice& slice : asked.slices)
      stack.slices.push_back({slice.position_mm, slice.polygons_mm});
    return both(witness_of_slices(stack), witness_of_box(voxel::bounds(universe().lattice())));
  }

  static voxel::Octree voxels(const voxel::SliceMask& of) {
    return voxel::combine(universe(), voxel::Expression(of));
  }
  static Certificate certified(const voxel::Octree& octree, const Witness& by = witness()) {
    return certify_alone(octree, {"mask", "slices", {"the voxel kernel"}, by});
  }
  static std::string told(const Certificate& certificate) {
    return verdict_text(certificate) + testing::PrintToString(certificate.reasons);
  }
};

TEST_F(AMaskOfSlices, WarnsOnlyThatOneKernelMadeIt) {
  const Certificate certificate = certified(voxels(mask()));
  EXPECT_EQ(certificate.verdict, Verdict::Warn) << told(certificate);
  EXPECT_TRUE(certificate.resolved()) << told(certificate);
  EXPECT_FALSE(certificate.independent());
  EXPECT_NE(told(certificate).find("Not independent"), std::string::npos);
  EXPECT_EQ(certificate.voxel.volume_mm3, certificate.mesh.volume_mm3);
}

TEST_F(AMaskOfSlices, FailsWhereItIsShiftedWiderOrNarrower) {
  for (const voxel::SliceMask& spoiled :
       {mask({1.0, 0.0}), mask({0.0, -1.0}), mask(glm::dvec2(0.0), 1.0), mask(glm::dvec2(0.0), -1.0)}) {
    const Certificate certificate = certified(voxels(spoiled));
    EXPECT_EQ(certificate.verdict, Verdict::Fail) << told(certificate);
    EXPECT_TRUE(certificate.worst);
  }
}

TEST_F(AMaskOfSlices, FailsWhereASliceOrAHoleIsLost) {
  voxel::SliceMask without_hole = mask(), without_slice = mask(), nearest = mask();
  without_hole.slices[2].polygons_mm.pop_back();
  without_slice.slices[0].polygons_mm.clear();
  nearest.between = voxel::SliceMask::Between::Nearest;
  for (const voxel::SliceMask& spoiled : {without_hole, without_slice, nearest})
    EXPECT_EQ(certified(voxels(spoiled)).verdict, Verdict::Fail);
  EXPECT_EQ(certified(voxel::Octree::empty(universe())).verdict, Verdict::Fail);
}

TEST_F(AMaskOfSlices, OneVoxelMoreOrLessFailsAndIsNamed) {
  const voxel::Octree right = voxels(mask());
  const glm::dvec3 at_mm(5.5, 0.5, -0.5), off_mm(25.5, 0.5, -0.5);
  const auto around = [](const glm::dvec3& p_mm) {
    return voxel::Expression(voxel::Box{p_mm - 0.4, p_mm + 0.4});
  };
  const Certificate less = certified(voxel::combine(universe(), voxel::Expression(right) - around(at_mm)));
  ASSERT_EQ(less.verdict, Verdict::Fail);
  EXPECT_LT(glm::distance(less.worst->at_mm, at_mm), 1e-9);
  EXPECT_EQ(less.symmetric_difference_mm3, 1.0);
  const Certificate more = certified(voxel::combine(universe(), voxel::Expression(right) | around(off_mm)));
  ASSERT_EQ(more.verdict, Verdict::Fail);
  EXPECT_LT(glm::distance(more.worst->at_mm, off_mm), 1e-9);
}

TEST_F(AMaskOfSlices, DoesNotPassWhereItsWitnessDoesNotKnowTheSide) {
  const Witness parts = witness_of_parts(witness());
  const Certificate certificate = certified(voxels(mask()), parts);
  EXPECT_EQ(certificate.verdict, Verdict::Warn) << told(certificate);
  EXPECT_FALSE(certificate.resolved()) << told(certificate);
}

TEST_F(AMaskOfSlices, ReportsItsProgressLayerByLayerAndCanBeStopped) {
  std::vector<double> fractions;
  const AloneInputs inputs{"mask", "slices", {"the voxel kernel"}, witness()};
  const voxel::Octree octree = voxels(mask());
  tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  certify_alone(octree, inputs, {{}, [&](double fraction) { fractions.push_back(fraction); }});
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end())) << testing::PrintToString(fractions);
  EXPECT_GE(std::count_if(fractions.begin(), fractions.end(), [](double f) { return f < 0.9; }), 60);
  EXPECT_EQ(fractions.back(), 1.0);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(certify_alone(octree, inputs, {stop.get_token(), {}}), voxel::Stopped);
}

TEST_F(AMaskOfSlices, TwoEmptyAnswersAreNoPass) {
  const Witness nothing = [](const glm::dvec3&, double) { return Reading{certainly_out, certainly_out, 0}; };
  EXPECT_EQ(certified(voxel::Octree::empty(universe()), nothing).verdict, Verdict::Warn);
}

}  // namespace
}  // namespace octotomy::verify
