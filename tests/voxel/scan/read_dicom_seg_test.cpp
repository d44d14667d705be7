// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/read_dicom_seg.h"

#include <fstream>
#include <gtest/gtest.h>

#include "tests/file_bytes.h"
#include "tests/voxel/scan/dicom_bytes.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/codes/run_length.h"
#include "voxel/filter/label_map.h"
#include "voxel/scan/read_scene.h"
#include "voxel/scan/write_dicom_seg.h"

namespace octotomy::voxel {
namespace {

using tests::DicomBytes;
using tests::ScratchFolder;

TEST(ReadDicomSeg, HoldsTheVoxelsThatWereWrittenWhereTheyAre) {
  const ScratchFolder folder;
  Universe universe;
  universe.depth = 4;
  universe.lps_from_voxel = glm::dmat4(glm::dvec4(0.5, 0, 0, 0), glm::dvec4(0, 0.75, 0, 0),
                                       glm::dvec4(0, 0, 2, 0), glm::dvec4(-7, 11, 30, 1));
  const auto index = [](std::uint64_t x, std::uint64_t y, std::uint64_t z) { return x + 16 * (y + 16 * z); };
  const Octree object = octree_of(RunLength{universe,
                                            {{index(2, 1, 1), index(9, 1, 1)},
                                             {index(4, 2, 1), index(4, 2, 1)},
                                             {index(2, 5, 6), index(4, 5, 6)}}});
  DicomSegOptions options;
  options.label = "Skull";
  write_dicom_seg(object, folder / "x.dcm", options);
  ASSERT_TRUE(is_dicom_seg(folder / "x.dcm"));
  const Scene scene = read_scene(folder / "x.dcm");
  EXPECT_EQ(scene.meaning, Meaning::Label);
  EXPECT_EQ(scene.audit.front().detail, "1 'Skull'");
  EXPECT_EQ(scene.lattice.spacing_mm(), glm::dvec3(0.5, 0.75, 2));
  EXPECT_EQ(scene.lattice.dims, glm::ivec3(8, 5, 6)) << "planes without a frame are empty";
  EXPECT_TRUE(octree_of_label(universe, scene, 1) == object);
  ASSERT_EQ(labels(scene).size(), 1U);
  // Any byte of its header spoiled: read or refused.
  const std::string whole = tests::bytes_of(folder / "x.dcm");
  int refused = 0;
  for (std::size_t at = 132; at < whole.size(); at += 3) {
    std::string mutant = whole;
    mutant[at] = static_cast<char>(mutant[at] ^ 0x7f);
    std::ofstream(folder / "mutant.dcm", std::ios::binary) << mutant;
    try {
      read_dicom_seg(folder / "mutant.dcm");
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Input) << error.what();
      ++refused;
    }
  }
  EXPECT_GT(refused, 50);
}

/// Two segments on three planes of 4 x 2 pixels; they overlap in one pixel of the middle plane.
std::string two_segments(bool fractional) {
  const auto seq = [](std::uint32_t at, const std::string& inner) {
    return DicomBytes::sequence(at, DicomBytes::item(inner));
  };
  const auto segment = [](std::uint16_t number, const char* label) {
    return DicomBytes::item(DicomBytes::us(0x00620004, number) +
                            DicomBytes::element(0x00620005, "LO", label));
  };
  const auto frame = [&](std::uint16_t number, int z) {
    return DicomBytes::item(
        seq(0x00209113, DicomBytes::element(0x00200032, "DS", "1\\2\\" + std::to_string(z))) +
        seq(0x0062000a, DicomBytes::us(0x0062000b, number)));
  };
  const std::string shared = seq(0x00209116, DicomBytes::element(0x00200037, "DS", "1\\0\\0\\0\\1\\0")) +
                             seq(0x00289110, DicomBytes::element(0x00280030, "DS", "0.5\\0.25"));
  // Frames: segment 2 at z 6 and 4, segment 1 at z 4 and 2.
  const unsigned char bits[] = {0x0f, 0x81, 0x80, 0x10};
  std::string pixels;
  for (const unsigned char byte : bits)
    if (!fractional)
      pixels += static_cast<char>(byte);
    else
      for (int i = 0; i < 8; ++i) pixels += static_cast<char>((byte >> i) & 1 ? 120 : 40);
  return DicomBytes::file(
      "1.2.840.10008.1.2.1",
      DicomBytes::element(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.66.4") + DicomBytes::us(0x00280010, 2) +
          DicomBytes::us(0x00280011, 4) + DicomBytes::us(0x00280100, fractional ? 8 : 1) +
          DicomBytes::sequence(0x00620002, segment(1, "Mandible") + segment(2, "Skull")) +
          (fractional ? DicomBytes::us(0x0062000e, 200) : "") +
          DicomBytes::sequence(0x52009229, DicomBytes::item(shared)) +
          DicomBytes::sequence(0x52009230, frame(2, 6) + frame(2, 4) + frame(1, 4) + frame(1, 2)) +
          DicomBytes::element(0x7fe00010, "OB", pixels));
}

TEST(ReadDicomSeg, OverlappingSegmentsKeepTheirSamplesAndAreNamed) {
  const ScratchFolder folder;
  for (const bool fractional : {false, true}) {
    std::ofstream(folder / "two.dcm", std::ios::binary) << two_segments(fractional);
    const Scene scene = read_dicom_seg(folder / "two.dcm");
    EXPECT_EQ(scene.lattice.dims, glm::ivec3(4, 2, 3));
    EXPECT_EQ(scene.lattice.spacing_mm(), glm::dvec3(0.25, 0.5, 2));
    EXPECT_EQ(scene.lattice.lps_mm({0, 0, 0}), glm::dvec3(1, 2, 2));
    // 3 stands for both.
    const Int16Samples expected{0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 3, 2, 2, 2, 2, 0, 0, 0, 0};
    EXPECT_EQ(std::get<Int16Samples>(scene.samples), expected);
    EXPECT_EQ(scene.audit[0].detail, "1 'Mandible', 2 'Skull'");
    ASSERT_EQ(scene.audit.size(), 2U);
    EXPECT_EQ(scene.audit[1].check, "overlaps");
    EXPECT_EQ(scene.audit[1].verdict, Verdict::Warn);
    EXPECT_NE(scene.audit[1].detail.find("1 sample lies in 1 'Mandible' and 2 'Skull', as number 3"),
              std::string::npos)
        << scene.audit[1].detail;
    EXPECT_EQ(scene.overlaps, (std::map<int, std::vector<int>>{{3, {1, 2}}}));
    const std::vector<Label> found = labels(scene);
    ASSERT_EQ(found.size(), 2U);
    EXPECT_EQ(found[0].samples, 2U);
    EXPECT_EQ(found[1].samples, 6U);
    const Universe universe = universe_on(scene.lattice);
    EXPECT_EQ(octree_of_label(universe, scene, 1).voxel_count(), 2U);
    EXPECT_EQ(octree_of_label(universe, scene, 2).voxel_count(), 6U);
  }
}

TEST(ReadDicomSeg, APixelOfALabelMapIsTheNumberOfItsSegment) {
  const ScratchFolder folder;
  const auto seq = [](std::uint32_t at, const std::string& inner) {
    return DicomBytes::sequence(at, DicomBytes::item(inner));
  };
  const auto segment = [](std::uint16_t number, const char* label) {
    return DicomBytes::item(DicomBytes::us(0x00620004, number) +
                            DicomBytes::element(0x00620005, "LO", label));
  };
  const auto frame = [&](int z) {
    return DicomBytes::item(
        seq(0x00209113, DicomBytes::element(0x00200032, "DS", "0\\0\\" + std::to_string(z))));
  };
  const std::string shared = seq(0x00209116, DicomBytes::element(0x00200037, "DS", "1\\0\\0\\0\\1\\0")) +
                             seq(0x00289110, DicomBytes::element(0x00280030, "DS", "1\\1"));
  std::string pixels;
  for (const int number : {0, 300, 2, 2, 0, 0, 40000, 2}) {
    pixels += static_cast<char>(number & 255);
    pixels += static_cast<char>(number >> 8);
  }
  std::ofstream(folder / "map.dcm", std::ios::binary) << DicomBytes::file(
      "1.2.840.10008.1.2.1",
      DicomBytes::element(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.66.7") + DicomBytes::us(0x00280010, 2) +
          DicomBytes::us(0x00280011, 2) + DicomBytes::us(0x00280100, 16) +
          DicomBytes::element(0x00620001, "CS", "LABELMAP") +
          DicomBytes::sequence(0x00620002, segment(0, "Background") + segment(2, "A") + segment(300, "B") +
                                               segment(40000, "C")) +
          DicomBytes::sequence(0x52009229, DicomBytes::item(shared)) +
          DicomBytes::sequence(0x52009230, frame(0) + frame(1)) +
          DicomBytes::element(0x7fe00010, "OW", pixels));
  ASSERT_TRUE(is_dicom_seg(folder / "map.dcm"));
  const std::vector<Label> found = labels(read_dicom_seg(folder / "map.dcm"));
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].number, 2);
  EXPECT_EQ(found[0].samples, 3U);
  EXPECT_EQ(found[1].number, 300);
  EXPECT_EQ(found[2].number, 40000);
}

}  // namespace
}  // namespace octotomy::voxel
