// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/region_file.h"

#include <algorithm>
#include <fstream>
#include <gtest/gtest.h>

#include "planner/operation/file/contour_findings.h"
#include "tests/voxel/scan/structure_set.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

using tests::DrawnStructure;
using tests::rectangle;
using tests::ScratchFolder;

using Outlines = std::vector<std::vector<glm::dvec3>>;

std::filesystem::path set_file(const ScratchFolder& folder, const std::vector<DrawnStructure>& structures) {
  std::ofstream(folder / "rs.dcm", std::ios::binary) << tests::structure_set(structures);
  return folder / "rs.dcm";
}

/// Squares of 20 mm on five planes, 2 mm apart.
Outlines square_block() {
  Outlines contours;
  for (const double z : {0.0, 2.0, 4.0, 6.0, 8.0}) contours.push_back(rectangle({-10, -10}, {10, 10}, z));
  return contours;
}

/// The counts of contours in the planes at 0, 2, ... 8 mm.
std::vector<std::size_t> contour_counts(const voxel::SliceMask& mask) {
  std::vector<std::size_t> counts;
  for (const auto& slice : mask.slices)
    if (slice.position_mm > -1.0 && slice.position_mm < 9.0) counts.push_back(slice.polygons_mm.size());
  return counts;
}

std::string slices_refusal(const std::filesystem::path& path, const std::string& structure) {
  try {
    read_slices(path, structure);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

#define EXPECT_HOLDS(text, part) EXPECT_NE(std::string(text).find(part), std::string::npos) << text

TEST(RegionFile, AContourWithFewerPointsThanItStatesIsTold) {
  const ScratchFolder folder;
  std::string bytes = tests::structure_set({{1, "Bone", square_block()}});
  std::ofstream(folder / "rs.dcm", std::ios::binary) << bytes;
  EXPECT_TRUE(read_slices(folder / "rs.dcm", SlicesOptions{"Bone"}).findings.empty());
  const std::string four = tests::DicomBytes::element(0x30060046, "IS", "4");
  const std::size_t at = bytes.find(four);
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at, four.size(), tests::DicomBytes::element(0x30060046, "IS", "9"));
  std::ofstream(folder / "rs.dcm", std::ios::binary) << bytes;
  const DrawnSlices drawn = read_slices(folder / "rs.dcm", SlicesOptions{"Bone"});
  ASSERT_EQ(drawn.findings.size(), 1U);
  EXPECT_HOLDS(drawn.findings[0], "1 contour holds a number of points other than");
  EXPECT_HOLDS(drawn.findings[0], "first 4 for 9");
}

TEST(RegionFile, ContoursThatLeaveOutSlicesOfTheScanAreTold) {
  voxel::SliceMask mask;
  mask.view = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
  const auto square = [](double z) {
    return voxel::SliceMask::Slice{z, {{{-5, -5}, {5, -5}, {5, 5}, {-5, 5}}}};
  };
  mask.slices = {square(0.0), square(8.0)};
  voxel::Lattice scan;
  scan.dims = glm::ivec3(20);
  scan.lps_from_voxel[2] = {0, 0, 2, 0};
  const auto found = slices_without_contours(mask, scan, "set");
  ASSERT_TRUE(found);
  EXPECT_HOLDS(*found, "set: 1 gap where slices of the scan have no contour, the widest 8.00 mm");
  // Planes between that hold nothing state that the structure ends.
  mask.slices = {square(0.0), {2.0, {}}, {6.0, {}}, square(8.0)};
  EXPECT_FALSE(slices_without_contours(mask, scan, "set"));
  mask.slices = {square(0.0), square(4.0)};
  EXPECT_FALSE(slices_without_contours(mask, scan, "set")) << "every other slice";
}

TEST(RegionFile, AContourDrawnAgainInItsPlaneIsTakenOnceAndTold) {
  const ScratchFolder folder;
  Outlines contours = square_block();
  contours.push_back(contours[2]);
  contours.push_back(contours[3]);
  std::rotate(contours.back().begin(), contours.back().begin() + 1, contours.back().end());
  contours.push_back(contours[3]);
  std::reverse(contours.back().begin(), contours.back().end());
  for (glm::dvec3& p : contours.back()) p.z += 0.0005;
  std::vector<std::string> findings;
  const auto path = set_file(folder, {{1, "A", contours}});
  EXPECT_EQ(contour_counts(read_slices(path, "A", findings)), (std::vector<std::size_t>{1, 1, 1, 1, 1}));
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_HOLDS(findings[0], "rs.dcm: 'A': 3 contours repeat another contour of the same plane");
  EXPECT_HOLDS(findings[0], "planes at 4, 6 mm, first near (-10, -10, 4) mm");
  EXPECT_EQ(contour_counts(read_slices(path, "A")), (std::vector<std::size_t>{1, 1, 1, 1, 1}))
      << "the same where nobody asks for findings";
}

TEST(RegionFile, AStructureOfWhichEveryContourIsDrawnAgainIsWhole) {
  const ScratchFolder folder;
  Outlines contours = square_block();
  const Outlines again = contours;
  contours.insert(contours.end(), again.begin(), again.end());
  std::vector<std::string> findings;
  const voxel::SliceMask mask = read_slices(set_file(folder, {{1, "A", contours}}), "A", findings);
  EXPECT_EQ(contour_counts(mask), (std::vector<std::size_t>{1, 1, 1, 1, 1}));
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_HOLDS(findings[0], "5 contours");
}

TEST(RegionFile, ABowTieWhoseHalvesAreAlikeEnclosesBoth) {
  const ScratchFolder folder;
  Outlines contours;
  for (const double z : {0.0, 2.0, 4.0})
    contours.push_back({{-10, -10, z}, {10, 10, z}, {10, -10, z}, {-10, 10, z}});
  std::vector<std::string> findings;
  const voxel::SliceMask mask = read_slices(set_file(folder, {{1, "B", contours}}), "B", findings);
  EXPECT_EQ(contour_counts(mask), (std::vector<std::size_t>{1, 1, 1, 0})) << "ends behind its last plane";
  EXPECT_HOLDS(testing::PrintToString(findings), "cross");
}

TEST(RegionFile, ContoursThatCrossAreToldAndHolesAreNot) {
  const ScratchFolder folder;
  Outlines contours = square_block();
  for (const double z : {0.0, 2.0}) contours.push_back(rectangle({-4, -4}, {4, 4}, z));
  std::vector<std::string> findings;
  read_slices(set_file(folder, {{1, "A", contours}}), "A", findings);
  EXPECT_TRUE(findings.empty()) << findings[0];
  contours.push_back(rectangle({-9.7, -10}, {10.3, 10}, 4));
  const voxel::SliceMask mask = read_slices(set_file(folder, {{1, "A", contours}}), "A", findings);
  EXPECT_EQ(contour_counts(mask), (std::vector<std::size_t>{2, 2, 2, 1, 1})) << "told, and left as drawn";
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_HOLDS(findings[0], "2 contours cross another");
  EXPECT_HOLDS(findings[0], "2 at 4 mm, first near (");
}

TEST(RegionFile, ContoursOfJsonThatRepeatOrCrossAreToldToo) {
  const ScratchFolder folder;
  std::ofstream(folder / "slices.json") << R"({"view": "inferior", "slices": [
      {"position_mm": 0, "polygons_mm": [[[0, 0], [9, 0], [9, 9], [0, 9]], [[9, 0], [9, 9], [0, 9], [0, 0]]]},
      {"position_mm": 2, "polygons_mm": [[[0, 0], [9, 0], [9, 9], [0, 9]], [[5, 5], [5, 15], [15, 15], [15, 5]]]}]})";
  std::vector<std::string> findings;
  const voxel::SliceMask mask = read_slices(folder / "slices.json", "", findings);
  EXPECT_EQ(mask.slices[0].polygons_mm.size(), 1U);
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_HOLDS(findings[0], "slices.json: 1 contour repeats another");
  EXPECT_HOLDS(findings[1], "2 at 2 mm");
}

TEST(RegionFile, OfTwoStructuresOfOneNameTheNumberSaysWhich) {
  const ScratchFolder folder;
  Outlines small;
  for (const double z : {0.0, 2.0}) small.push_back(rectangle({-1, -1}, {1, 1}, z));
  const auto path = set_file(
      folder, {{4, "A", square_block()}, {7, "A", small}, {9, "B", square_block()}, {2, "9", small}});
  EXPECT_HOLDS(slices_refusal(path, "A"), "2 structures 'A' with the ROI numbers 4 and 7");
  EXPECT_HOLDS(slices_refusal(path, ""), "'A' (4), 'A' (7), 'B', '9'");
  EXPECT_EQ(read_slices(path, "7").slices.size(), 4U);
  EXPECT_EQ(read_slices(path, "4").slices.size(), 7U);
  EXPECT_EQ(read_slices(path, "9").slices.size(), 4U) << "a name comes before a number";
  EXPECT_HOLDS(slices_refusal(path, "8"), "has no structure '8'");
}

TEST(RegionFile, PlanesNearerThanTheirRoundingAreRefusedForThat) {
  const ScratchFolder folder;
  for (const double apart_mm : {0.01, 0.0125}) {
    Outlines contours;
    for (int i = 0; i < 40; ++i) contours.push_back(rectangle({-10, -10}, {10, 10}, i * apart_mm));
    const std::string alone = slices_refusal(set_file(folder, {{1, "A", contours}}), "A");
    EXPECT_HOLDS(alone, apart_mm == 0.01 ? " 0.01 mm apart" : " 0.0125 mm apart");
    EXPECT_EQ(alone.find("one plane,"), std::string::npos) << alone;
    const std::string beside =
        slices_refusal(set_file(folder, {{1, "A", contours}, {2, "B", square_block()}}), "A");
    EXPECT_HOLDS(beside, apart_mm == 0.01 ? " 0.01 mm apart" : " 0.0125 mm apart");
  }
  EXPECT_HOLDS(slices_refusal(set_file(folder, {{1, "A", {rectangle({0, 0}, {9, 9}, 0)}}}), "A"),
               "lies in one plane");
}

/// Squares of 20 mm on every second plane of another structure's, which lie 2 mm apart.
std::vector<DrawnStructure> interleaved(const std::string& kind, double slab_mm = 0.0) {
  Outlines every, second;
  for (int i = 0; i < 9; ++i) {
    every.push_back(rectangle({-30, -30}, {30, 30}, 2.0 * i));
    if (i % 2 == 0) second.push_back(rectangle({-10, -10}, {10, 10}, 2.0 * i));
  }
  return {{1, "Body", every}, {2, "Bone", second, kind, slab_mm}};
}

TEST(RegionFile, AStructureOnEverySecondPlaneIsToldAndBridgedWhereAskedOrStated) {
  const ScratchFolder folder;
  const auto empty_between = [](const DrawnSlices& drawn) {
    std::size_t count = 0;
    for (std::size_t i = 1; i + 1 < drawn.mask.slices.size(); ++i)
      count += drawn.mask.slices[i].polygons_mm.empty() ? 1 : 0;
    return count;
  };
  const auto path = set_file(folder, interleaved("CLOSED_PLANAR"));
  const DrawnSlices apart = read_slices(path, SlicesOptions{"Bone"});
  EXPECT_EQ(empty_between(apart), 4U);
  ASSERT_EQ(apart.findings.size(), 1U);
  EXPECT_HOLDS(apart.findings[0], "'Bone': is drawn every 4 mm, while the set's planes are 2 mm apart");
  EXPECT_HOLDS(apart.findings[0], "--bridge 4");
  const DrawnSlices bridged = read_slices(path, SlicesOptions{"Bone", 4.0});
  EXPECT_EQ(empty_between(bridged), 0U);
  EXPECT_TRUE(bridged.findings.empty());
  EXPECT_EQ(bridged.mask.slices.front().position_mm, -4.0) << "ends speak for half of its own distance";
  for (const auto& stated : {interleaved("INTERPOLATED_PLANAR"), interleaved("CLOSED_PLANAR", 4.0)}) {
    const DrawnSlices drawn = read_slices(set_file(folder, stated), SlicesOptions{"Bone"});
    EXPECT_EQ(empty_between(drawn), 0U);
    EXPECT_TRUE(drawn.findings.empty());
  }
  EXPECT_EQ(
      empty_between(read_slices(set_file(folder, interleaved("CLOSED_PLANAR", 2.0)), SlicesOptions{"Bone"})),
      4U)
      << "slabs that do not meet";
}

TEST(RegionFile, OneMissingPlaneAndAWideGapAreTold) {
  const ScratchFolder folder;
  Outlines contours = square_block(), parts = square_block();
  contours.erase(contours.begin() + 2);
  for (const double z : {40.0, 42.0}) parts.push_back(rectangle({-10, -10}, {10, 10}, z));
  const auto path = set_file(folder, {{1, "A", contours}, {2, "B", parts}});
  const DrawnSlices missing = read_slices(path, SlicesOptions{"A"});
  ASSERT_EQ(missing.findings.size(), 1U);
  EXPECT_HOLDS(missing.findings[0], "1 gap");
  EXPECT_HOLDS(missing.findings[0], "between 2 and 6 mm");
  const DrawnSlices wide = read_slices(path, SlicesOptions{"B"});
  ASSERT_EQ(wide.findings.size(), 1U);
  EXPECT_HOLDS(wide.findings[0], "between 8 and 40 mm");
}

TEST(RegionFile, PartsOnPlanesBetweenEachOthersBothCountAndAreTold) {
  const ScratchFolder folder;
  for (const double shift : {1.0, 0.4, 0.0}) {
    Outlines contours = square_block();
    for (const double z : {0.0, 2.0, 4.0, 6.0, 8.0})
      contours.push_back(rectangle({20, -10}, {30, 10}, z + shift));
    const DrawnSlices drawn = read_slices(set_file(folder, {{1, "A", contours}}), SlicesOptions{"A"});
    EXPECT_EQ(drawn.findings.size(), shift > 0.0 ? 1U : 0U);
    std::size_t within = 0;
    for (const auto& slice : drawn.mask.slices)
      if (slice.position_mm > 0.1 && slice.position_mm < 8.9) {
        EXPECT_EQ(slice.polygons_mm.size(), 2U) << "shifted by " << shift;
        ++within;
      }
    EXPECT_GE(within, 4U);
  }
}

TEST(RegionFile, PartsOnPlanesBetweenEachOthersEndWhereEachAloneEnds) {
  const ScratchFolder folder;
  const voxel::Universe universe = voxel::universe_around({{-16, -16, -16}, {16, 16, 16}}, 1.0);
  const auto count = [&](const Outlines& contours) {
    const DrawnSlices drawn = read_slices(set_file(folder, {{1, "A", contours}}), SlicesOptions{"A"});
    return voxel::combine(universe, drawn.mask).voxel_count();
  };
  for (const double from : {-5.0, -4.75, -4.5})
    for (const double shift : {0.25, 0.5, 0.75}) {
      Outlines left, right;
      for (int plane = 0; plane < 11; ++plane) {
        left.push_back(rectangle({-8, -4}, {-2, 4}, from + plane));
        right.push_back(rectangle({2, -4}, {8, 4}, from + shift + plane));
      }
      Outlines both = left;
      both.insert(both.end(), right.begin(), right.end());
      EXPECT_EQ(count(left), 6U * 8U * 11U);
      EXPECT_EQ(count(both), count(left) + count(right)) << from << " mm, shifted by " << shift;
    }
}

TEST(RegionFile, PointsALittleOffTheirPlaneAreTakenInItAndTold) {
  const ScratchFolder folder;
  Outlines contours = square_block(), other = square_block();
  for (auto& contour : contours) contour[1].z += 0.03;
  contours[2][3].z -= 0.03;
  other[0][0].z += 0.05;
  const auto path = set_file(folder, {{1, "A", contours}, {2, "B", square_block()}, {3, "C", other}});
  const DrawnSlices drawn = read_slices(path, SlicesOptions{"A"});
  EXPECT_EQ(contour_counts(drawn.mask), (std::vector<std::size_t>{1, 1, 1, 1, 1}));
  ASSERT_EQ(drawn.findings.size(), 1U);
  EXPECT_HOLDS(drawn.findings[0], "off their contour's plane");
  EXPECT_TRUE(read_slices(path, SlicesOptions{"B"}).findings.empty()) << "of another structure";
  for (auto& contour : contours) contour[1].z += 0.3;
  EXPECT_HOLDS(slices_refusal(set_file(folder, {{1, "A", contours}}), "A"), "not in parallel planes");
}

TEST(RegionFile, AContourOfTwoPointsIsLeftOutAndTold) {
  const ScratchFolder folder;
  Outlines contours = square_block();
  contours.push_back({{0, 0, 4}, {1, 1, 4}});
  const DrawnSlices drawn = read_slices(set_file(folder, {{1, "A", contours}}), SlicesOptions{"A"});
  EXPECT_EQ(contour_counts(drawn.mask), (std::vector<std::size_t>{1, 1, 1, 1, 1}));
  ASSERT_EQ(drawn.findings.size(), 1U);
  EXPECT_HOLDS(drawn.findings[0], "1 contours with fewer than three points");
}

#undef EXPECT_HOLDS

}  // namespace
}  // namespace octotomy::planner
