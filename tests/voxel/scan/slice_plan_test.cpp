// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/slice_plan.h"

#include <gtest/gtest.h>

namespace octotomy::voxel {
namespace {

/// Axial slices at given heights, numbered from 1 on, 0 of all: not numbered.
DicomStack stack_at(const std::vector<double>& heights_mm, bool numbered = true) {
  DicomStack stack;
  for (const double height : heights_mm) {
    DicomSlice slice;
    slice.size_px = {10, 10};
    slice.spacing_mm = {1, 1};
    slice.first_mm = {0, 0, height};
    slice.name = "z" + std::to_string(static_cast<int>(height));
    if (numbered) slice.instance_number = static_cast<int>(stack.slices.size()) + 1;
    stack.slices.push_back(slice);
  }
  return stack;
}

Finding line_of(const std::vector<Finding>& audit, const std::string& check) {
  for (const Finding& line : audit)
    if (line.check == check) return line;
  return {"", Verdict::Fail, "no line " + check};
}

TEST(SlicePlan, ListsEveryHoleAndFailsAboveTheStatedLength) {
  std::vector<double> heights;
  for (int k = 0; k < 40; ++k)
    if ((k < 10 || k > 24) && k != 30) heights.push_back(100 + 2.0 * k);
  std::vector<Finding> audit;
  const SlicePlan plan = slice_plan(stack_at(heights), "folder", audit);
  EXPECT_EQ(plan.sources.size(), 40U);
  EXPECT_DOUBLE_EQ(plan.step_mm, 2.0);
  ASSERT_EQ(plan.holes.size(), 2U);
  EXPECT_DOUBLE_EQ(plan.holes[0].low_mm, 118.0);
  EXPECT_DOUBLE_EQ(plan.holes[0].length_mm(), 32.0);
  EXPECT_DOUBLE_EQ(plan.holes[1].length_mm(), 4.0);
  const Finding missing = line_of(audit, "missing_slices");
  EXPECT_EQ(missing.verdict, Verdict::Fail);
  EXPECT_NE(missing.detail.find("16 of 40"), std::string::npos) << missing.detail;
  EXPECT_NE(missing.detail.find("gap of 32 mm after slice 10"), std::string::npos) << missing.detail;
  EXPECT_NE(missing.detail.find("gap of 4 mm after slice 15"), std::string::npos) << missing.detail;
  EXPECT_EQ(missing.files, (std::vector<std::string>{"z118", "z150", "z158", "z162"}));
  EXPECT_EQ(line_of(audit, "slice_spacing").verdict, Verdict::Warn);
  // The slices of the lattice inside the holes.
  const Lattice lattice = axis_aligned_lattice({10, 10, 40}, {1, 1, 2}, {0, 0, 100});
  ASSERT_TRUE(slices_inside(lattice, plan.holes[0]));
  EXPECT_EQ(slices_inside(lattice, plan.holes[0])->first, 10);
  EXPECT_EQ(slices_inside(lattice, plan.holes[0])->last, 24);
  EXPECT_EQ(slices_inside(lattice, plan.holes[1])->first, 30);
  EXPECT_EQ(slices_inside(lattice, plan.holes[1])->last, 30);
  EXPECT_FALSE(slices_inside(axis_aligned_lattice({10, 10, 5}, {1, 1, 2}, {0, 0, 100}), plan.holes[0]));
  Lattice turned = lattice;
  std::swap(turned.lps_from_voxel[0], turned.lps_from_voxel[2]);
  EXPECT_FALSE(slices_inside(turned, plan.holes[0]));
}

TEST(SlicePlan, TellsASecondDistanceFromMissingSlicesByTheNumbers) {
  const std::vector<double> heights{0, 2, 4, 6, 8, 10, 14, 18, 22, 26};
  std::vector<Finding> audit;
  const SlicePlan protocol = slice_plan(stack_at(heights), "folder", audit);
  EXPECT_TRUE(protocol.holes.empty());
  EXPECT_EQ(protocol.sources.size(), 14U);
  EXPECT_EQ(line_of(audit, "slice_spacing").verdict, Verdict::Warn);
  EXPECT_NE(line_of(audit, "slice_spacing").detail.find("5 of 2 mm, 4 of 4 mm"), std::string::npos)
      << line_of(audit, "slice_spacing").detail;
  EXPECT_EQ(line_of(audit, "missing_slices").verdict, Verdict::Pass);
  DicomStack skipping = stack_at(heights);
  for (DicomSlice& slice : skipping.slices) slice.instance_number = static_cast<int>(slice.first_mm.z / 2);
  audit.clear();
  EXPECT_EQ(slice_plan(skipping, "folder", audit).holes.size(), 4U);
  EXPECT_NE(line_of(audit, "missing_slices").detail.find("4 of 14"), std::string::npos);
}

TEST(SlicePlan, NamesASliceBesideTheOthersOfATiltedStack) {
  DicomStack stack = stack_at({0, 2, 4, 6, 8, 10, 12});
  for (DicomSlice& slice : stack.slices) slice.first_mm.y = 0.25 * slice.first_mm.z;
  stack.slices[3].first_mm.x = 0.5;
  std::vector<Finding> audit;
  const SlicePlan plan = slice_plan(stack, "folder", audit);
  EXPECT_TRUE(plan.leans);
  EXPECT_EQ(line_of(audit, "sideways").files, std::vector<std::string>{"z6"});
  EXPECT_NE(line_of(audit, "gantry_tilt").detail.find("14.04 degrees"), std::string::npos)
      << line_of(audit, "gantry_tilt").detail;
}

TEST(SlicePlan, IsNoCopyOfAStackWithASliceOffTheLattice) {
  std::vector<Finding> audit;
  EXPECT_TRUE(slice_plan(stack_at({0, 2, 4, 6, 8, 10, 12}), "folder", audit).is_copy());
  const SlicePlan plan = slice_plan(stack_at({0, 2, 4, 5, 6, 8, 10, 12, 14, 16, 18, 20}), "folder", audit);
  EXPECT_EQ(plan.sources.size(), 11U);
  EXPECT_FALSE(plan.is_copy());
}

}  // namespace
}  // namespace octotomy::voxel
