// SPDX-License-Identifier: AGPL-3.0-or-later
#include <fstream>
#include <gtest/gtest.h>

#include "planner/operation/file/region_file.h"
#include "planner/operation/table/number_format.h"
#include "tests/brep/told.h"
#include "tests/planner/operation/ball_operation.h"
#include "tests/voxel/scan/structure_set.h"

namespace octotomy::planner {
namespace {

using namespace tests;

TEST(MaskStep, RegionsOnSlicesCutBothKernelsAlike) {
  const ScratchFolder folder;
  std::ofstream(folder / "slices.json") << R"({"view": "inferior", "slices": [
      {"position_mm": -30, "polygons_mm": [[[0, -30], [30, -30], [30, 30], [0, 30]]]},
      {"position_mm": 30, "polygons_mm": [[[0, -30], [30, -30], [30, 30], [0, 30]]]}]})";
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "side", "do": "mask", "slices": "slices.json"},
      {"id": "half", "do": "combine", "expression": "ball & side"})"));
  const Object& half = evaluation.object("half");
  EXPECT_NEAR(half.voxel.measures.volume_mm3 / ball_mm3(ball_radius_mm), 0.5, 0.02);
  expect_certified(half, 0.5 * ball_mm3(ball_radius_mm), 0.02);
  EXPECT_EQ(evaluation.object("side").mesh.lineage, "tiled slices");
  EXPECT_TRUE(evaluation.object("side").findings.empty());
}

TEST(MaskStep, AMaskOfNothingIsRefused) {
  const ScratchFolder folder;
  EXPECT_NE(ball_refusal(folder, R"({"id": "m", "do": "mask"})").find("'regions' is missing"),
            std::string::npos);
}

TEST(MaskStep, OptionsOfAStructureSetWithoutOneAreRefused) {
  const ScratchFolder folder;
  const std::string region =
      R"("regions": [{"view": "anterior", "polygons_mm": [[[0, 0], [9, 0], [9, 9]]]}])";
  for (const char* option : {R"("structure": "A")", R"("bridge_mm": 2)", R"("other_identity": true)"})
    EXPECT_NE(ball_refusal(folder, R"({"id": "m", "do": "mask", )" + region + ", " + option + "}")
                  .find("add the set as 'slices'"),
              std::string::npos)
        << option;
}

TEST(MaskStep, AStructureThatReachesBeyondTheScanIsReported) {
  const ScratchFolder folder;
  const auto findings = [&](double x_mm) {
    std::vector<std::vector<glm::dvec3>> contours;
    for (const double z : {0.0, 2.0, 4.0}) contours.push_back(rectangle({-8, -8}, {8, 8}, z));
    contours[1][1].x = x_mm;
    std::ofstream(folder / "rs.dcm", std::ios::binary) << structure_set({{1, "A", contours}});
    std::string all;
    const Evaluation evaluation =
        evaluate(ball_plan(folder, R"({"id": "a", "do": "mask", "slices": "rs.dcm"})"));
    for (const std::string& finding : evaluation.object("a").findings) all += finding + "\n";
    return all;
  };
  EXPECT_NE(findings(200).find("rs.dcm: reaches beyond the scan in 1 of 3 planes"), std::string::npos)
      << findings(200);
  EXPECT_EQ(findings(9).find("beyond the scan"), std::string::npos) << findings(9);
}

TEST(MaskStep, AnOffsetOfContoursIsAppliedAndSaid) {
  const ScratchFolder folder;
  const std::vector<std::vector<glm::dvec3>> contours{
      rectangle({-8, -8}, {8, 8}, 0), rectangle({-8, -8}, {8, 8}, 2), rectangle({-8, -8}, {8, 8}, 4)};
  const auto made = [&](const std::string& offset) {
    std::ofstream(folder / "rs.dcm", std::ios::binary)
        << structure_set({{1, "A", contours, "CLOSED_PLANAR", 0.0, offset}});
    const Evaluation evaluation =
        evaluate(ball_plan(folder, R"({"id": "a", "do": "mask", "slices": "rs.dcm"})"));
    std::string all;
    for (const std::string& finding : evaluation.object("a").findings) all += finding + "\n";
    return std::pair{evaluation.object("a").voxel.measures.centroid_mm.value().z, all};
  };
  const auto still = made(""), offset = made("0\\0\\6");
  EXPECT_NEAR(offset.first - still.first, 6.0, 1e-6);
  EXPECT_EQ(still.second.find("ContourOffsetVector"), std::string::npos) << still.second;
  EXPECT_NE(offset.second.find("3 contours are moved by the file's ContourOffsetVector, by up to "
                               "(0, 0, 6) mm"),
            std::string::npos)
      << offset.second;
}

TEST(MaskStep, WhatIsCutAtTheCubeIsAFailWithItsVolume) {
  const ScratchFolder folder;
  const auto findings = [&](double x_mm) {
    std::vector<std::vector<glm::dvec3>> contours;
    for (const double z : {0.0, 2.0, 4.0}) {
      contours.push_back(rectangle({-8, -8}, {x_mm, 8}, z));
      // A hole, a quarter of the height, as long as the rectangle but for 2 mm at either end.
      contours.push_back(rectangle({-6, -2}, {x_mm - 2, 2}, z));
    }
    std::ofstream(folder / "rs.dcm", std::ios::binary) << structure_set({{1, "A", contours}});
    const Evaluation evaluation =
        evaluate(ball_plan(folder, R"({"id": "a", "do": "mask", "slices": "rs.dcm"})"));
    std::string all;
    for (const std::string& finding : evaluation.object("a").findings) all += finding + "\n";
    const voxel::Universe& universe = evaluation.object("a").voxel.octree.universe();
    return std::pair{all,
                     universe.lps_from_voxel[3].x + (universe.side() - 0.5) * universe.lps_from_voxel[0].x};
  };
  EXPECT_EQ(findings(9).first.find("cube"), std::string::npos) << findings(9).first;
  const auto [said, border_mm] = findings(1000.0);
  EXPECT_NE(said.find("FAIL: rs.dcm: is cut at the border of the octree's cube"), std::string::npos) << said;
  // Three planes of 2 mm each: the rectangle's part beyond less the hole's.
  const double beyond_mm3 = 6.0 * (16.0 * (1000.0 - border_mm) - 4.0 * (998.0 - border_mm)),
               drawn_mm3 = 6.0 * (16.0 * 1008.0 - 4.0 * 1004.0);
  EXPECT_NE(said.find("about " + three_figures(100.0 * beyond_mm3 / drawn_mm3) + " % of its volume, " +
                      three_figures(beyond_mm3) + " mm3"),
            std::string::npos)
      << said << "; " << border_mm;
}

/// A ring on four planes, a second block behind a gap of two planes, and a structure of one plane.
std::string ring_and_block() {
  std::vector<std::vector<glm::dvec3>> ring;
  for (const double z : {0.0, 2.0, 4.0, 6.0, 12.0, 14.0}) ring.push_back(rectangle({-10, -10}, {10, 10}, z));
  for (const double z : {0.0, 2.0, 4.0, 6.0}) ring.push_back(rectangle({-4, -4}, {4, 4}, z));
  return structure_set({{1, "Ring", ring},
                        {2, "Plate", {rectangle({-8, -8}, {8, 8}, 4)}},
                        {3, "Point", {{{0, 0, 0}}}, "POINT"}});
}

TEST(MaskStep, AStructureSetsRegionHasItsHoleItsGapAndItsOwnSlicesVolume) {
  const ScratchFolder folder;
  std::ofstream(folder / "rs.dcm", std::ios::binary) << ring_and_block();
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "ring", "do": "mask", "slices": "rs.dcm", "structure": "Ring"},
      {"id": "plate", "do": "mask", "slices": "rs.dcm", "structure": "Plate"})"));
  // Each plane speaks for 2 mm: four of a ring, two of a block.
  const double ring_mm3 = 8.0 * (400.0 - 64.0) + 4.0 * 400.0;
  EXPECT_NEAR(evaluation.object("ring").voxel.measures.volume_mm3 / ring_mm3, 1.0, 0.05);
  EXPECT_NEAR(evaluation.object("plate").voxel.measures.volume_mm3 / 512.0, 1.0, 0.1);
  EXPECT_EQ(evaluation.object("ring").definition, "'Ring' of rs.dcm");
  const voxel::SliceMask mask = read_slices(folder / "rs.dcm", "Ring");
  const auto at = std::find_if(mask.slices.begin(), mask.slices.end(),
                               [](const auto& slice) { return slice.position_mm == 8.0; });
  ASSERT_NE(at, mask.slices.end()) << "the plane after the ring is empty";
  EXPECT_TRUE(at->polygons_mm.empty());
}

TEST(MaskStep, AStructureThatIsNotThereIsRefusedWithTheOnesThatAre) {
  const ScratchFolder folder;
  std::ofstream(folder / "rs.dcm", std::ios::binary) << ring_and_block();
  const auto refusal = [&](const std::string& structure) {
    try {
      read_slices(folder / "rs.dcm", structure);
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refusal("Rign").find("did you mean 'Ring'"), std::string::npos) << refusal("Rign");
  EXPECT_NE(refusal("").find("'Ring', 'Plate', 'Point'"), std::string::npos) << refusal("");
  EXPECT_NE(refusal("Point").find("has no closed contour, but 1 points"), std::string::npos);
  std::ofstream(folder / "rs.dcm", std::ios::binary) << structure_set(
      {{1,
        "A",
        {rectangle({0, 0}, {9, 9}, 0), rectangle({0, 0}, {9, 9}, 2), {{0, 0, 4}, {3, 0, 5}, {3, 3, 6}}}}});
  EXPECT_NE(refusal("A").find("not in parallel planes"), std::string::npos) << refusal("A");
  std::ofstream(folder / "rs.dcm", std::ios::binary)
      << structure_set({{1, "A", {rectangle({0, 0}, {9, 9}, 0)}}});
  EXPECT_NE(refusal("A").find("ContourSlabThickness"), std::string::npos) << refusal("A");
}

TEST(MaskStep, AStructureOfOnePlaneIsAsThickAsItStates) {
  const ScratchFolder folder;
  std::ofstream(folder / "rs.dcm", std::ios::binary) << structure_set(
      {{.number = 1, .name = "A", .contours_mm = {rectangle({-6, -6}, {6, 6}, 0)}, .slab_mm = 4.0}});
  const Evaluation evaluation =
      evaluate(ball_plan(folder, R"({"id": "a", "do": "mask", "slices": "rs.dcm", "structure": "A"})"));
  EXPECT_NEAR(evaluation.object("a").voxel.measures.volume_mm3, 4.0 * 144.0, 60.0);
  EXPECT_NE(told(evaluation.object("a").findings).find("has the thickness that the file states, 4 mm"),
            std::string::npos);
}

TEST(MaskStep, AStructureOnTiltedPlanesKeepsItsPlace) {
  const ScratchFolder folder;
  // Planes of a tilted gantry, 20 degrees about x.
  const double c = std::cos(0.35), s = std::sin(0.35);
  std::vector<std::vector<glm::dvec3>> contours;
  for (const double z : {-4.0, -2.0, 0.0, 2.0, 4.0}) {
    contours.push_back(rectangle({-8, -6}, {8, 6}, z));
    for (glm::dvec3& p : contours.back()) p = {p.x, c * p.y - s * p.z, s * p.y + c * p.z};
  }
  std::ofstream(folder / "rs.dcm", std::ios::binary) << structure_set({{1, "A", contours}});
  const Evaluation evaluation =
      evaluate(ball_plan(folder, R"({"id": "a", "do": "mask", "slices": "rs.dcm"})"));
  EXPECT_NEAR(evaluation.object("a").voxel.measures.volume_mm3 / (16.0 * 12.0 * 10.0), 1.0, 0.05);
  EXPECT_LT(glm::length(*evaluation.object("a").voxel.measures.centroid_mm), 0.3);
}

}  // namespace
}  // namespace octotomy::planner
