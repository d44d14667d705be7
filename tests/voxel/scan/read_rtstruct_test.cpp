// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/read_rtstruct.h"

#include <fstream>
#include <gtest/gtest.h>

#include "tests/voxel/scan/deflated.h"
#include "tests/voxel/scan/structure_set.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

using tests::rectangle;
using tests::ScratchFolder;
using tests::structure_set;

std::filesystem::path written(const ScratchFolder& folder, const std::string& bytes) {
  std::ofstream(folder / "rs.dcm", std::ios::binary) << bytes;
  return folder / "rs.dcm";
}

TEST(ReadRtstruct, NamesNumbersAndPointsAreTheFilesAndLinesAreCountedApart) {
  const ScratchFolder folder;
  const auto path = written(
      folder,
      structure_set({{7, "Mandible", {rectangle({-1.5, 2.25}, {3, 4}, -10), rectangle({0, 0}, {1, 1}, -8)}},
                     {3, "Isocentre", {{{1, 2, 3}}}, "POINT"},
                     {9, "Empty", {}}}));
  ASSERT_TRUE(is_rtstruct(path));
  const std::vector<Structure> all = read_rtstruct(path).structures;
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].name, "Mandible");
  EXPECT_EQ(all[0].number, 7);
  ASSERT_EQ(all[0].contours_mm.size(), 2u);
  EXPECT_EQ(all[0].contours_mm[0], rectangle({-1.5, 2.25}, {3, 4}, -10));
  EXPECT_EQ(all[1].others, 1u);
  EXPECT_TRUE(all[1].contours_mm.empty());
  EXPECT_TRUE(all[2].contours_mm.empty());
}

TEST(ReadRtstruct, ADeflatedSetIsTheInflatedOne) {
  const ScratchFolder folder;
  const std::string plain = structure_set({{7, "Mandible", {rectangle({-1.5, 2.25}, {3, 4}, -10)}}});
  const std::string rest = plain.substr(plain.find(std::string("\x08\0\x16\0UI", 6)));
  const auto set = read_rtstruct(
      written(folder, tests::DicomBytes::file("1.2.840.10008.1.2.1.99", tests::deflated(rest, -MAX_WBITS))));
  ASSERT_EQ(set.structures.size(), 1U);
  EXPECT_EQ(set.structures[0].name, "Mandible");
  EXPECT_EQ(set.structures[0].contours_mm, read_rtstruct(written(folder, plain)).structures[0].contours_mm);
}

TEST(ReadRtstruct, ANameInsideASequenceIsReadInTheFilesCharacterSet) {
  const ScratchFolder folder;
  const auto name_in = [&](const std::string& set, const std::string& stored) {
    std::string bytes = structure_set({{1, stored, {rectangle({0, 0}, {1, 1}, 5)}}});
    const std::string next("\x08\0\x16\0UI", 6);
    bytes.insert(bytes.find(next), tests::DicomBytes::element(0x00080005, "CS", set));
    return read_rtstruct(written(folder, bytes)).structures[0].name;
  };
  EXPECT_EQ(name_in("ISO_IR 192", "Sch\u00e4del"), "Sch\u00e4del");
  EXPECT_EQ(name_in("ISO_IR 100",
                    "Sch\xe4"
                    "del"),
            "Sch\u00e4del");
  EXPECT_EQ(name_in("ISO_IR 192",
                    "Sch\xe4"
                    "del"),
            "Sch?del")
      << "no UTF-8";
}

TEST(ReadRtstruct, AContourOverSixtyFourKilobytesIsReadWhole) {
  const ScratchFolder folder;
  std::vector<glm::dvec3> circle;
  for (int i = 0; i < 5000; ++i) circle.emplace_back(50 * std::cos(i * 2e-4 * M_PI * 2), i % 7, 5);
  const auto all = read_rtstruct(written(folder, structure_set({{1, "Body", {circle}}}))).structures;
  EXPECT_EQ(all[0].contours_mm[0].size(), 5000u);
}

TEST(ReadRtstruct, ASpoiledFileIsRefusedByNameOrReadAndNeverMore) {
  const ScratchFolder folder;
  const std::string whole = structure_set({{1, "A", {rectangle({0, 0}, {9, 9}, 0)}}});
  std::size_t refused = 0;
  for (std::size_t at = 132; at < whole.size(); ++at)
    for (const bool cut : {true, false}) {
      std::string mutant = cut ? whole.substr(0, at) : whole;
      if (!cut) mutant[at] = static_cast<char>(mutant[at] ^ 0x7f);
      try {
        read_rtstruct(written(folder, mutant));
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::Input) << error.what();
        EXPECT_NE(std::string(error.what()).find("rs.dcm: "), std::string::npos) << error.what();
        ++refused;
      }
    }
  EXPECT_GT(refused, whole.size() / 2);
  EXPECT_THROW(read_rtstruct(written(folder, structure_set({}))), Error);
}

TEST(ReadRtstruct, AContourOfTwoPointsIsCountedAndSpoilsNoOtherRegion) {
  const ScratchFolder folder;
  const auto path =
      written(folder, structure_set({{1, "A", {{{0, 0, 0}, {1, 1, 1}}, rectangle({0, 0}, {9, 9}, 0)}},
                                     {2, "B", {rectangle({0, 0}, {9, 9}, 0)}, "INTERPOLATED_PLANAR"},
                                     {3, "C", {rectangle({0, 0}, {9, 9}, 0)}, "CLOSED_PLANAR", 2.5}}));
  const std::vector<Structure> all = read_rtstruct(path).structures;
  EXPECT_EQ(all[0].degenerate, 1u);
  EXPECT_EQ(all[0].contours_mm.size(), 1u);
  EXPECT_EQ(all[1].contours_mm.size(), 1u);
  EXPECT_FALSE(all[0].is_interpolated);
  EXPECT_TRUE(all[1].is_interpolated);
  EXPECT_EQ(all[0].slab_mm, 0.0);
  EXPECT_EQ(all[2].slab_mm, 2.5);
}

TEST(ReadRtstruct, AContourStandsAtItsOffset) {
  const ScratchFolder folder;
  const std::vector<std::vector<glm::dvec3>> drawn{rectangle({0, 0}, {9, 9}, 0),
                                                   rectangle({0, 0}, {9, 9}, 2)};
  const std::vector<Structure> all =
      read_rtstruct(written(folder, structure_set({{1, "A", drawn},
                                                   {2, "B", drawn, "CLOSED_PLANAR", 0.0, "1\\-2\\5"},
                                                   {3, "C", drawn, "CLOSED_PLANAR", 0.0, "0\\0\\0"},
                                                   {4, "D", drawn, "CLOSED_PLANAR", 0.0, "0\\5"}})))
          .structures;
  EXPECT_EQ(all[0].contours_mm, drawn);
  EXPECT_EQ(all[0].moved, 0U);
  ASSERT_EQ(all[1].contours_mm.size(), 2U);
  EXPECT_EQ(all[1].contours_mm[0][0], glm::dvec3(1, -2, 5));
  EXPECT_EQ(all[1].contours_mm[1][2], glm::dvec3(10, 7, 7));
  EXPECT_EQ(all[1].moved, 2U);
  EXPECT_EQ(all[1].farthest_offset_mm, glm::dvec3(1, -2, 5));
  EXPECT_EQ(all[2].contours_mm, drawn);
  EXPECT_EQ(all[2].moved, 0U) << "an offset of nothing moves nothing";
  EXPECT_NE(all[3].flaw.find("ContourOffsetVector"), std::string::npos) << "two numbers are no vector";
}

TEST(ReadRtstruct, StatesWhoseItIsAndWhichFrameItRefersTo) {
  const ScratchFolder folder;
  const Identity identity =
      read_rtstruct(written(folder, structure_set({{1, "A", {rectangle({0, 0}, {9, 9}, 0)}}},
                                                  {"P-17 ", "1.2.3", "1.2.4"})))
          .identity;
  EXPECT_EQ(identity.patient_id, "P-17");
  EXPECT_EQ(identity.study_uids, std::vector<std::string>{"1.2.3"});
  EXPECT_EQ(identity.frame_uids, std::vector<std::string>{"1.2.4"});
  EXPECT_TRUE(identity.referred_series_uids.empty());
  const Identity drawn =
      read_rtstruct(written(folder, structure_set({{1, "A", {rectangle({0, 0}, {9, 9}, 0)}}},
                                                  {"P-17", "1.2.3", "1.2.4", "1.2.5"})))
          .identity;
  EXPECT_EQ(drawn.study_uids, std::vector<std::string>{"1.2.3"});
  EXPECT_EQ(drawn.referred_series_uids, std::vector<std::string>{"1.2.5"});
}

}  // namespace
}  // namespace octotomy::voxel
