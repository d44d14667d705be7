// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/read_dicom_seg.h"

#include <array>
#include <fstream>
#include <gtest/gtest.h>

#include "tests/file_bytes.h"
#include "tests/voxel/scan/deflated.h"
#include "tests/voxel/scan/dicom_bytes.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/codes/run_length.h"
#include "voxel/filter/label_map.h"
#include "voxel/scan/label_names.h"
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

/// Two segments on planes of 4 x 2 pixels; they overlap in one pixel of the middle plane. Frames: segment 2
/// on the first two heights, segment 1 on the last two.
struct TwoSegments {
  std::string type = "BINARY";
  int bits = 1;
  int inside = 1, outside = 0;  ///< pixels of 8 bits
  std::array<const char*, 4> heights_mm = {"6", "4", "4", "2"};
  std::string spacing_mm = {}, thickness_mm = {};
  bool describes_second = true;
  bool is_deflated = false;
};

std::string two_segments(const TwoSegments& how) {
  const auto seq = [](std::uint32_t at, const std::string& inner) {
    return DicomBytes::sequence(at, DicomBytes::item(inner));
  };
  const auto segment = [](std::uint16_t number, const char* label) {
    return DicomBytes::item(DicomBytes::us(0x00620004, number) +
                            DicomBytes::element(0x00620005, "LO", label));
  };
  const auto frame = [&](std::uint16_t number, const char* z) {
    return DicomBytes::item(
        seq(0x00209113, DicomBytes::element(0x00200032, "DS", std::string("1\\2\\") + z)) +
        seq(0x0062000a, DicomBytes::us(0x0062000b, number)));
  };
  const std::string shared =
      seq(0x00209116, DicomBytes::element(0x00200037, "DS", "1\\0\\0\\0\\1\\0")) +
      seq(0x00289110,
          (how.spacing_mm.empty() ? "" : DicomBytes::element(0x00180088, "DS", how.spacing_mm)) +
              (how.thickness_mm.empty() ? "" : DicomBytes::element(0x00180050, "DS", how.thickness_mm)) +
              DicomBytes::element(0x00280030, "DS", "0.5\\0.25"));
  const unsigned char bits[] = {0x0f, 0x81, 0x80, 0x10};
  std::string pixels;
  for (const unsigned char byte : bits)
    if (how.bits == 1)
      pixels += static_cast<char>(byte);
    else
      for (int i = 0; i < 8; ++i) pixels += static_cast<char>((byte >> i) & 1 ? how.inside : how.outside);
  const auto& z = how.heights_mm;
  const std::string rest =
      DicomBytes::element(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.66.4") + DicomBytes::us(0x00280010, 2) +
      DicomBytes::us(0x00280011, 4) + DicomBytes::us(0x00280100, static_cast<std::uint16_t>(how.bits)) +
      DicomBytes::element(0x00620001, "CS", how.type) +
      DicomBytes::sequence(0x00620002,
                           segment(1, "Mandible") + (how.describes_second ? segment(2, "Skull") : "")) +
      (how.type == "FRACTIONAL" ? DicomBytes::us(0x0062000e, 200) : "") +
      DicomBytes::sequence(0x52009229, DicomBytes::item(shared)) +
      DicomBytes::sequence(0x52009230, frame(2, z[0]) + frame(2, z[1]) + frame(1, z[2]) + frame(1, z[3])) +
      DicomBytes::element(0x7fe00010, "OB", pixels);
  return how.is_deflated ? DicomBytes::file("1.2.840.10008.1.2.1.99", tests::deflated(rest, -MAX_WBITS))
                         : DicomBytes::file("1.2.840.10008.1.2.1", rest);
}

const TwoSegments fractional{.type = "FRACTIONAL", .bits = 8, .inside = 120, .outside = 40};

std::filesystem::path put(const ScratchFolder& folder, const TwoSegments& how) {
  std::ofstream(folder / "two.dcm", std::ios::binary) << two_segments(how);
  return folder / "two.dcm";
}

std::string warnings_of(const Scene& scene) {
  std::string all;
  for (const Finding& finding : scene.audit)
    if (finding.verdict == Verdict::Warn) all += finding.check + ": " + finding.detail + "\n";
  return all;
}

TEST(ReadDicomSeg, OverlappingSegmentsKeepTheirSamplesAndAreNamed) {
  const ScratchFolder folder;
  for (const TwoSegments& how : {TwoSegments{}, fractional}) {
    const Scene scene = read_dicom_seg(put(folder, how));
    EXPECT_EQ(scene.lattice.dims, glm::ivec3(4, 2, 3));
    EXPECT_EQ(scene.lattice.spacing_mm(), glm::dvec3(0.25, 0.5, 2));
    EXPECT_EQ(scene.lattice.lps_mm({0, 0, 0}), glm::dvec3(1, 2, 2));
    // The number 3 means both segments.
    const Int16Samples expected{0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 3, 2, 2, 2, 2, 0, 0, 0, 0};
    EXPECT_EQ(std::get<Int16Samples>(scene.samples), expected);
    EXPECT_EQ(scene.audit[0].detail, "1 'Mandible', 2 'Skull'");
    ASSERT_EQ(scene.audit.size(), how.type == "FRACTIONAL" ? 3U : 2U);
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

TEST(ReadDicomSeg, UnevenPlanesAreRefusedByTheirFrameAndJitterIsEvenWithAWarning) {
  const ScratchFolder folder;
  try {
    read_dicom_seg(put(folder, {.heights_mm = {"38", "37.1", "36.5", "35"}, .spacing_mm = "1"}));
    FAIL() << "uneven planes were read";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("not evenly apart: frame 3"), std::string::npos) << error.what();
  }
  for (const char* stated : {"1", ""}) {
    for (const double jitter_mm : {0.02, 0.1}) {
      const std::string high = std::to_string(38.0 + jitter_mm), low = std::to_string(36.0 - jitter_mm);
      const Scene scene = read_dicom_seg(
          put(folder, {.heights_mm = {high.c_str(), "37", low.c_str(), "35"}, .spacing_mm = stated}));
      EXPECT_EQ(scene.lattice.dims.z, 4);
      EXPECT_NEAR(scene.lattice.spacing_mm().z, 1.0, 0.3 * jitter_mm + (*stated == '1' ? 0.0 : jitter_mm));
      EXPECT_NE(warnings_of(scene).find("treated as evenly spaced"), std::string::npos) << warnings_of(scene);
    }
    EXPECT_EQ(warnings_of(read_dicom_seg(
                  put(folder, {.heights_mm = {"38", "37", "36", "35"}, .spacing_mm = stated}))),
              "");
  }
}

TEST(ReadDicomSeg, FramesOfTwoSegmentsThatJitterInOnePlaneShareIt) {
  const ScratchFolder folder;
  const Scene scene = read_dicom_seg(put(folder, {.heights_mm = {"37.05", "36", "36.04", "35"}}));
  EXPECT_EQ(scene.lattice.dims.z, 3);
  EXPECT_EQ(scene.overlaps.size(), 1U) << "they overlap in the middle plane";
}

TEST(ReadDicomSeg, ADistanceOfPlanesThatPositionsContradictIsReported) {
  const ScratchFolder folder;
  const auto read = [&](std::array<const char*, 4> heights_mm, const char* spacing_mm,
                        const char* thickness_mm) {
    return read_dicom_seg(
        put(folder, {.heights_mm = heights_mm, .spacing_mm = spacing_mm, .thickness_mm = thickness_mm}));
  };
  const auto expect = [](const Scene& scene, int planes, double step_mm, const std::string& warning) {
    EXPECT_EQ(scene.lattice.dims.z, planes) << warning;
    EXPECT_NEAR(scene.lattice.spacing_mm().z, step_mm, 1e-9) << warning;
    if (warning.empty())
      EXPECT_EQ(warnings_of(scene), "");
    else
      EXPECT_NE(warnings_of(scene).find(warning), std::string::npos) << warnings_of(scene);
  };
  expect(read({"38", "36.5", "35", "33.5"}, "1", ""), 4, 1.5, "positions are used");
  expect(read({"38", "35", "32", "29"}, "1", ""), 10, 1.0, "assumed to be empty");
  expect(read({"41", "40", "36", "35"}, "", ""), 7, 1.0, "");
  expect(read({"41", "40", "36", "35"}, "1", ""), 7, 1.0, "");
  expect(read({"42", "40", "38", "36"}, "", "3"), 4, 2.0, "");
  expect(read({"42", "40", "38", "36"}, "", "1"), 4, 2.0, "positions are used");
  expect(read({"43", "40", "37", "36"}, "", ""), 8, 1.0, "the least distance");
  // Thin planes far apart stand for what lies between them, whether the distance is stated or not.
  for (const char* stated : {"", "7"})
    expect(
        read({"49", "42", "35", "28"}, stated, "1"), 4, 7.0,
        "each plane represents 7 mm of its segments. Nothing was drawn in 6 mm of them; volumes are 7 times");
  expect(read({"42", "40", "38", "36"}, "", "1.4"), 4, 2.0, "Nothing was drawn in 0.6 mm");
  expect(read({"42", "40", "38", "36"}, "2", "2"), 4, 2.0, "");
  expect(read({"42", "40", "38", "36"}, "", "1.99"), 4, 2.0, "");
}

TEST(ReadDicomSeg, FractionsThatAreCutAndSegmentsWithoutADescriptionAreReported) {
  const ScratchFolder folder;
  const auto warnings = [&](const TwoSegments& how) { return warnings_of(read_dicom_seg(put(folder, how))); };
  EXPECT_NE(warnings(fractional).find("100 of 200: 24 samples of less are left out, and 8 of more are whole"),
            std::string::npos)
      << warnings(fractional);
  TwoSegments faint = fractional;
  faint.inside = 99;
  EXPECT_NE(warnings(faint).find("no sample reaches one half of segment 1 (at most 99), 2 (at most 99)"),
            std::string::npos)
      << warnings(faint);
  TwoSegments whole = fractional;
  whole.inside = 200;
  whole.outside = 0;
  EXPECT_EQ(warnings(whole).find("fractions"), std::string::npos) << "nothing is cut";
  EXPECT_NE(warnings({.describes_second = false}).find("2 (6 samples)"), std::string::npos);
  EXPECT_EQ(warnings({}).find("undescribed"), std::string::npos);
}

TEST(ReadDicomSeg, ABinarySegmentationOfBytesAndADeflatedOneAreRead) {
  const ScratchFolder folder;
  const Scene bits = read_dicom_seg(put(folder, {}));
  for (const TwoSegments& how : {TwoSegments{.bits = 8},
                                 {.bits = 8, .inside = 255},
                                 {.is_deflated = true},
                                 {.bits = 8, .is_deflated = true}}) {
    const Scene scene = read_dicom_seg(put(folder, how));
    EXPECT_EQ(std::get<Int16Samples>(scene.samples), std::get<Int16Samples>(bits.samples));
    EXPECT_EQ(label_names(folder / "two.dcm"), label_names(put(folder, {})));
  }
  std::string spoiled = two_segments({.is_deflated = true});
  spoiled.resize(spoiled.size() - 20);
  std::ofstream(folder / "two.dcm", std::ios::binary) << spoiled;
  EXPECT_THROW(read_dicom_seg(folder / "two.dcm"), Error);
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

/// A FRACTIONAL segmentation of two frames of 2 x 2 pixels, whose pixel data are `pixels`.
std::string fractional_file(const std::string& syntax, const std::string& pixels, std::uint16_t side = 2) {
  const auto frame = [](const std::string& z) {
    return DicomBytes::item(
        DicomBytes::sequence(0x00209113,
                             DicomBytes::item(DicomBytes::element(0x00200032, "DS", "0\\0\\" + z))) +
        DicomBytes::sequence(0x0062000a, DicomBytes::item(DicomBytes::us(0x0062000b, 1))));
  };
  return DicomBytes::file(
      syntax,
      DicomBytes::element(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.66.4") +
          DicomBytes::us(0x00280010, side) + DicomBytes::us(0x00280011, side) +
          DicomBytes::us(0x00280100, 8) + DicomBytes::element(0x00620001, "CS", "FRACTIONAL") +
          DicomBytes::sequence(0x00620002, DicomBytes::item(DicomBytes::us(0x00620004, 1) +
                                                            DicomBytes::element(0x00620005, "LO", "Bone"))) +
          DicomBytes::us(0x0062000e, 255) + DicomBytes::element(0x00620010, "CS", "OCCUPANCY") +
          DicomBytes::sequence(
              0x52009229,
              DicomBytes::item(
                  DicomBytes::sequence(0x00209116, DicomBytes::item(DicomBytes::element(
                                                       0x00200037, "DS", "1\\0\\0\\0\\1\\0"))) +
                  DicomBytes::sequence(0x00289110,
                                       DicomBytes::item(DicomBytes::element(0x00180088, "DS", "2") +
                                                        DicomBytes::element(0x00280030, "DS", "1\\1"))))) +
          DicomBytes::sequence(0x52009230, frame("0") + frame("2")) + pixels);
}

/// Four pixels as a fragment of run lengths (PS3.5, annex G): one segment, the pixels as they are.
std::string run_length_fragment(const std::string& pixels) {
  std::string header = DicomBytes::number(1, 4) + DicomBytes::number(64, 4) + std::string(56, '\0');
  return DicomBytes::item(header + static_cast<char>(pixels.size() - 1) + pixels + '\0');
}

std::string compressed_pixels(const std::string& fragments) {
  return DicomBytes::tag(0x7fe00010) + "OB" + DicomBytes::number(0, 2) + DicomBytes::number(0xffffffff, 4) +
         DicomBytes::item("") + fragments + DicomBytes::tag(0xfffee0dd) + DicomBytes::number(0, 4);
}

TEST(ReadDicomSeg, CompressedFramesAreThoseOfTheRawFile) {
  const ScratchFolder folder;
  const std::string pixels("\x00\x01\x80\xff\x7f\x10\x00\xfe", 8);
  std::ofstream(folder / "raw.dcm", std::ios::binary)
      << fractional_file("1.2.840.10008.1.2.1", DicomBytes::element(0x7fe00010, "OB", pixels));
  std::ofstream(folder / "rle.dcm", std::ios::binary) << fractional_file(
      "1.2.840.10008.1.2.5",
      compressed_pixels(run_length_fragment(pixels.substr(0, 4)) + run_length_fragment(pixels.substr(4))));
  const Scene raw = read_dicom_fractions(folder / "raw.dcm", "Bone");
  const Scene rle = read_dicom_fractions(folder / "rle.dcm", "Bone");
  EXPECT_EQ(std::get<FloatSamples>(raw.samples)[2], 128.0F / 255.0F);
  EXPECT_TRUE(raw.samples == rle.samples);
  EXPECT_TRUE(read_dicom_seg(folder / "raw.dcm").samples == read_dicom_seg(folder / "rle.dcm").samples);
}

TEST(ReadDicomSeg, CompressedFramesThatClaimMoreThanTheFileCanHoldAreRefused) {
  const ScratchFolder folder;
  const auto refusal = [&](const std::string& bytes) -> std::string {
    std::ofstream(folder / "x.dcm", std::ios::binary) << bytes;
    try {
      read_dicom_seg(folder / "x.dcm");
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Input);
      return error.what();
    }
    return "";
  };
  const std::string two = run_length_fragment("abcd") + run_length_fragment("efgh");
  EXPECT_NE(refusal(fractional_file("1.2.840.10008.1.2.5", compressed_pixels(two), 60000))
                .find("more than its bytes can hold"),
            std::string::npos);
  EXPECT_NE(refusal(fractional_file("1.2.840.10008.1.2.5", compressed_pixels(two), 3)).find("frame 1"),
            std::string::npos);
  EXPECT_NE(
      refusal(fractional_file("1.2.840.10008.1.2.5", compressed_pixels(two + run_length_fragment("ijkl"))))
          .find("cannot be assigned to frames"),
      std::string::npos);
}

}  // namespace
}  // namespace octotomy::voxel
