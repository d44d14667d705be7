// SPDX-License-Identifier: AGPL-3.0-or-later
#include <fstream>
#include <gtest/gtest.h>

#include "tests/voxel/scratch_folder.h"
#include "voxel/scan/label_names.h"
#include "voxel/scan/read_scene.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

using tests::ScratchFolder;

/// 3D Slicer's segmentation of 4 x 2 x 1 places in two layers, whose samples alternate. Both layers have the
/// value 1.
std::filesystem::path layered(const ScratchFolder& folder, const std::string& sizes = "2 4 2 1") {
  std::ofstream out(folder / "s.seg.nrrd", std::ios::binary);
  out << "NRRD0005\ntype: unsigned char\ndimension: 4\nspace: left-posterior-superior\nsizes: " << sizes
      << "\nspace directions: none (0.5,0,0) (0,0.5,0) (0,0,2)\nkinds: list domain domain domain\n"
         "encoding: raw\nspace origin: (1,2,3)\n"
         "Segment0_ID:=S1\nSegment0_LabelValue:=1\nSegment0_Layer:=0\nSegment0_Name:=Mandible\n"
         "Segment1_ID:=S2\nSegment1_LabelValue:=1\nSegment1_Layer:=1\nSegment1_Name:=Teeth\n"
         "Segment2_ID:=S3\nSegment2_LabelValue:=2\nSegment2_Layer:=0\nSegment2_Name:=Skull\n\n";
  const char samples[8][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {2, 1}, {2, 0}, {0, 0}, {7, 0}};
  for (const auto& place : samples) out.write(place, 2);
  return folder / "s.seg.nrrd";
}

std::string doubts_of(const Scene& scene) {
  std::string all;
  for (const Finding& finding : scene.audit)
    if (finding.verdict == Verdict::Warn) all += finding.detail + "\n";
  return all;
}

TEST(SlicerLayers, SegmentsThatOverlapKeepTheirSamplesUnderNumbersOfTheirOwn) {
  const ScratchFolder folder;
  const auto path = layered(folder);
  const std::map<int, std::string> names = label_names(path);
  EXPECT_EQ(names, (std::map<int, std::string>{{1, "Mandible"}, {2, "Skull"}, {3, "Teeth"}}))
      << "the value 1 of the second layer is another segment's: it gets the next free number";
  const Scene scene = read_scene(path);
  EXPECT_EQ(scene.meaning, Meaning::Label);
  EXPECT_EQ(scene.lattice.dims, glm::ivec3(4, 2, 1));
  EXPECT_EQ(scene.lattice.spacing_mm(), glm::dvec3(0.5, 0.5, 2));
  EXPECT_EQ(scene.lattice.lps_mm({0, 0, 0}), glm::dvec3(1, 2, 3));
  // 4 is the value 7, which no segment has; 5 and 6 stand for several labels.
  EXPECT_EQ(std::get<Int16Samples>(scene.samples), (Int16Samples{0, 1, 5, 3, 6, 2, 0, 4}));
  EXPECT_EQ(scene.overlaps, (std::map<int, std::vector<int>>{{5, {1, 3}}, {6, {2, 3}}}));
  const std::string warnings = doubts_of(scene);
  EXPECT_NE(warnings.find("1 sample lies in 1 'Mandible' and 3 'Teeth'"), std::string::npos) << warnings;
  EXPECT_NE(warnings.find("7 in layer 0 (as number 4)"), std::string::npos) << warnings;
}

TEST(SlicerLayers, ALayerForEachSegmentThatStatesNoValueIsRead) {
  const ScratchFolder folder;
  std::ofstream(folder / "old.seg.nrrd", std::ios::binary)
      << "NRRD0004\ntype: uint8\ndimension: 4\nspace: left-posterior-superior\nsizes: 2 2 2 1\n"
         "space directions: none (1,0,0) (0,1,0) (0,0,1)\nkinds: list domain domain domain\n"
         "encoding: ascii\nSegment0_ID:=S1\nSegment0_Name:=Mandible\nSegment1_ID:=S2\n"
         "Segment1_Name:=Skull\n\n1 0 0 1 1 1 0 0";
  const Scene scene = read_scene(folder / "old.seg.nrrd");
  EXPECT_EQ(label_names(folder / "old.seg.nrrd"),
            (std::map<int, std::string>{{1, "Mandible"}, {2, "Skull"}}));
  EXPECT_EQ(std::get<Int16Samples>(scene.samples), (Int16Samples{1, 2, 3, 0}));
  EXPECT_EQ(scene.overlaps, (std::map<int, std::vector<int>>{{3, {1, 2}}}));
}

TEST(SlicerLayers, AValueThatSinglePrecisionMergesIsRefused) {
  const ScratchFolder folder;
  const auto path = folder / "s.seg.nrrd";
  const auto put = [&](const char* first) {
    std::ofstream(path) << "NRRD0005\ntype: uint32\ndimension: 4\nspace: left-posterior-superior\n"
                           "sizes: 2 2 1 1\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\n"
                           "kinds: list domain domain domain\nencoding: ascii\nspace origin: (0,0,0)\n"
                           "Segment0_Name:=A\nSegment0_LabelValue:=1\nSegment0_Layer:=0\n\n"
                        << first << " 0 1 0\n";
  };
  put("16777215");
  EXPECT_NO_THROW(read_scene(path));
  put("16777217");
  EXPECT_THROW(read_scene(path), Error);
}

TEST(SlicerLayers, MoreLayersThanTheFileHoldsAreRefused) {
  const ScratchFolder folder;
  for (const char* sizes : {"3 4 2 1", "5000 4 2 1", "2 2000000000 2 1", "2.5 4 2 1"})
    EXPECT_THROW(read_scene(layered(folder, sizes)), Error) << sizes;
}

/// 3D Slicer's segmentation of one layer: `segments` are the values of Mandible, Skull, ...
std::filesystem::path flat(const ScratchFolder& folder, const std::vector<int>& segments,
                           const std::vector<std::int32_t>& samples) {
  std::ofstream out(folder / "f.seg.nrrd", std::ios::binary);
  out << "NRRD0005\ntype: int32\ndimension: 3\nspace: left-posterior-superior\nsizes: " << samples.size()
      << " 1 1\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nencoding: raw\nendian: little\n"
         "space origin: (0,0,0)\n";
  for (std::size_t i = 0; i < segments.size(); ++i)
    out << "Segment" << i << "_Name:=" << (i == 0 ? "Mandible" : "Skull") << "\nSegment" << i
        << "_LabelValue:=" << segments[i] << "\nSegment" << i << "_Layer:=" << i << "\n";
  out << "\n";
  out.write(reinterpret_cast<const char*>(samples.data()), static_cast<std::streamsize>(4 * samples.size()));
  return folder / "f.seg.nrrd";
}

TEST(SlicerLayers, SegmentsThatShareAValueAndSamplesOfNoSegmentAreReported) {
  const ScratchFolder folder;
  auto path = flat(folder, {1, 1}, {0, 1, 1});
  EXPECT_EQ(label_names(path), (std::map<int, std::string>{{1, "Mandible + Skull"}}));
  EXPECT_NE(doubts_of(read_scene(path)).find("'Mandible' and 'Skull' both have the value 1"),
            std::string::npos)
      << doubts_of(read_scene(path));
  path = flat(folder, {1, 2}, {0, 1, 2, 5, 5, 300});
  EXPECT_NE(doubts_of(read_scene(path)).find("5 (2 samples), 300 (1 sample)"), std::string::npos)
      << doubts_of(read_scene(path));
  EXPECT_EQ(doubts_of(read_scene(flat(folder, {1, 2}, {0, 1, 2}))).find("segment"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::voxel
