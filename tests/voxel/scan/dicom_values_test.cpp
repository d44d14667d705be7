// SPDX-License-Identifier: AGPL-3.0-or-later
//
// What DICOM states about its pixels' values besides RescaleSlope and RescaleIntercept.
#include <bit>
#include <fstream>
#include <gtest/gtest.h>
#include <map>

#include "tests/voxel/linear_scene.h"
#include "tests/voxel/scan/dicom_bytes.h"
#include "tests/voxel/scan/spoiled_series.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/scan/read_scene.h"

namespace octotomy::voxel {
namespace {

using tests::DicomBytes;
using tests::ScratchFolder;
using tests::SpoiledImage;

Scene read(const std::vector<SpoiledImage>& images) {
  const ScratchFolder folder;
  for (const SpoiledImage& image : images)
    std::ofstream(folder / image.name, std::ios::binary) << image.bytes();
  return read_scene(folder.path());
}

double sample(const Scene& scene, std::size_t i) {
  return std::visit([&](const auto& samples) { return static_cast<double>(samples[i]); }, scene.samples);
}

/// Pixels of one byte each, 7 x 5 or 6 x 5 of them, in words whose low byte is the first pixel.
TEST(DicomValues, BytesInWordsOfEitherOrderAreTheSamePixels) {
  for (const bool is_big_endian : {false, true})
    for (const char* vr : {"OW", "OB"})
      for (const int width : {6, 7}) {
        SCOPED_TRACE(std::string(vr) + (is_big_endian ? " big" : " little") + std::to_string(width));
        std::vector<SpoiledImage> images = tests::sound_series();
        for (SpoiledImage& image : images) {
          image.big_endian = is_big_endian;
          image.syntax = is_big_endian ? "1.2.840.10008.1.2.2" : "1.2.840.10008.1.2.1";
          std::string pixels;
          for (int i = 0; i < 5 * width; ++i) pixels += static_cast<char>(3 * i);
          if (pixels.size() % 2 != 0) pixels += '\0';
          image.text(0x7fe00010, vr, pixels);
          image.number(0x00280010, 5);
          image.number(0x00280011, static_cast<std::uint16_t>(width));
          image.number(0x00280100, 8);
          image.number(0x00280101, 8);
          image.number(0x00280102, 7);
          image.number(0x00280103, 0);
        }
        const Scene scene = read(images);
        ASSERT_EQ(scene.lattice.dims, glm::ivec3(width, 5, 12));
        const double first = sample(scene, 0);
        for (std::size_t i = 0; i < static_cast<std::size_t>(5 * width); ++i)
          ASSERT_EQ(sample(scene, i) - first, 3.0 * static_cast<double>(i)) << i;
      }
}

TEST(DicomValues, ACtOfAnotherUnitIsNotTakenAsHounsfield) {
  for (const auto& [unit, meaning] : std::map<std::string, Meaning>{{"HU", Meaning::Hounsfield},
                                                                    {"HU_MOD", Meaning::Hounsfield},
                                                                    {"Z_EFF", Meaning::Raw},
                                                                    {"MGML", Meaning::Raw}}) {
    std::vector<SpoiledImage> images = tests::sound_series();
    for (SpoiledImage& image : images) image.text(0x00281054, "LO", unit);
    EXPECT_EQ(read(images).meaning, meaning) << unit;
  }
}

TEST(DicomValues, ADoseIsScaledByItsOwnFactorAndNamesItsUnit) {
  std::vector<SpoiledImage> images = tests::sound_series();
  for (SpoiledImage& image : images) {
    image.text(0x00080060, "CS", "RTDOSE");
    image.elements.erase(0x00281052);
    image.elements.erase(0x00281053);
    image.elements.erase(0x00281054);
  }
  const Scene stored = read(images);
  for (SpoiledImage& image : images) {
    image.text(0x30040002, "CS", "GY");
    image.text(0x3004000e, "DS", "0.25");
  }
  const Scene dose = read(images);
  for (std::size_t i = 0; i < dose.lattice.sample_count(); i += 7)
    ASSERT_EQ(sample(dose, i), 0.25 * sample(stored, i));
  EXPECT_NE(tests::finding(dose, "rescale")->detail.find("GY"), std::string::npos);
}

std::string wide(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  return DicomBytes::number(static_cast<std::uint32_t>(bits), 4) +
         DicomBytes::number(static_cast<std::uint32_t>(bits >> 32), 4);
}

/// A Real World Value Mapping of stored values from 0 to `last`.
std::string mapping(double slope, double intercept, const std::string& unit, std::uint16_t last = 4000) {
  using D = DicomBytes;
  return D::item(D::sequence(0x004008ea, D::item(D::element(0x00080100, "SH", unit))) +
                 D::element(0x00409211, "US", D::number(last, 2)) +
                 D::element(0x00409216, "US", D::number(0, 2)) +
                 D::element(0x00409224, "FD", wide(intercept)) + D::element(0x00409225, "FD", wide(slope)));
}

/// The audit's line on the mappings of a series of slope 1 and intercept -1024, in Hounsfield units.
Finding on_mapping(const std::string& items) {
  std::vector<SpoiledImage> images = tests::sound_series();
  for (SpoiledImage& image : images) image.text(0x00409096, "SQ", items);
  const Scene scene = read(images);
  const Finding* line = tests::finding(scene, "real_world_values");
  return line == nullptr ? Finding{"none", Verdict::Fail, "none"} : *line;
}

TEST(DicomValues, AMappingThatMakesTheValuesOfTheRescaleIsNoDoubt) {
  EXPECT_EQ(on_mapping(mapping(1.0, -1024.0, "[hnsf'U]")).verdict, Verdict::Pass);
  EXPECT_EQ(on_mapping(mapping(2.0, 0.0, "g/ml") + mapping(1.0, -1024.0, "[hnsf'U]")).verdict, Verdict::Pass);
  EXPECT_EQ(on_mapping(mapping(1.0, -1024.0, "mg/cm3")).verdict, Verdict::Warn) << "another unit";
}

TEST(DicomValues, AMappingThatDiffersFromTheRescaleIsShownWithBothNumbers) {
  const Finding other = on_mapping(mapping(2.0, -1000.0, "mg/cm3"));
  EXPECT_EQ(other.verdict, Verdict::Warn);
  for (const char* part :
       {"values are those of the rescale, 1 * stored - 1024 HU.", "would produce 2 * stored - 1000 mg/cm3;",
        "a stored 1000 is -24 HU by the rescale and 1000 mg/cm3 by the mapping"})
    EXPECT_NE(other.detail.find(part), std::string::npos) << part << " is not in " << other.detail;
  // The example lies among the values that the mapping is stated for.
  const Finding narrow = on_mapping(mapping(2.0, -1000.0, "mg/cm3", 100));
  EXPECT_NE(narrow.detail.find("a stored 100 is -924 HU by the rescale and -800 mg/cm3"), std::string::npos)
      << narrow.detail;
}

}  // namespace
}  // namespace octotomy::voxel
