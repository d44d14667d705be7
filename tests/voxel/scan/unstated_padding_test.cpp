// SPDX-License-Identifier: AGPL-3.0-or-later
#include <fstream>
#include <functional>
#include <gtest/gtest.h>

#include "tests/voxel/linear_scene.h"
#include "tests/voxel/scan/dicom_bytes.h"
#include "tests/voxel/scan/spoiled_series.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/scan/air_level.h"
#include "voxel/scan/read_scene.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::voxel {
namespace {

using tests::DicomBytes;
using tests::ScratchFolder;

constexpr int width = 24;

/// A head of 40 and 900 HU in noisy air, in a round field of view; `outside` makes the samples around it.
Scene round_scene(const std::function<int(int index)>& outside) {
  Scene scene;
  scene.lattice.dims = glm::ivec3(width);
  scene.meaning = Meaning::Hounsfield;
  Int16Samples samples;
  for (int z = 0; z < width; ++z)
    for (int y = 0; y < width; ++y)
      for (int x = 0; x < width; ++x) {
        const int r2 = (2 * x - 23) * (2 * x - 23) + (2 * y - 23) * (2 * y - 23), i = samples.size() % 97;
        samples.push_back(static_cast<std::int16_t>(r2 > 500   ? outside(static_cast<int>(samples.size()))
                                                    : r2 > 200 ? -1000 + i % 51 - 25
                                                    : r2 > 150 ? 900 + i
                                                               : 40 + i));
      }
  scene.samples = std::move(samples);
  return scene;
}

TEST(UnstatedPadding, IsTheIsolatedLeastSampleBelowAir) {
  for (const int fill : {-1200, -2000, -2048, -3024, -32768}) {
    Scene scene = round_scene([&](int) { return fill; });
    take_unstated_padding(scene);
    ASSERT_TRUE(scene.padding) << fill;
    EXPECT_EQ(*scene.padding, fill);
    EXPECT_EQ(tests::verdict(scene, "padding"), Verdict::Warn);
    EXPECT_NEAR(range(scene).low, -1025.0, 1.0);
  }
}

TEST(UnstatedPadding, JoinsThePaddingThatTheFileStates) {
  Scene scene = round_scene([](int i) { return i % 3 == 0 ? -32768 : -3024; });
  scene.padding = -32768;
  take_unstated_padding(scene);
  EXPECT_EQ(scene.padding, -32768.0);
  EXPECT_EQ(tests::verdict(scene, "padding"), Verdict::Warn);
  EXPECT_NEAR(range(scene).low, -1025.0, 1.0);
}

TEST(UnstatedPadding, IsNotAssumedOfWhatAScannerMeasures) {
  const std::map<std::string, std::function<int(int)>> measured = {
      {"air", [](int) { return -1024; }},
      {"noise around air that is cut off", [](int i) { return -1000 - i * 37 % 160; }},
      {"values that continue above", [](int i) { return i % 4 ? -2000 : -1950; }},
      {"a lone spoiled sample", [](int i) { return i == 5 ? -3024 : -1000; }}};
  for (const auto& [kind, outside] : measured) {
    Scene scene = round_scene(outside);
    take_unstated_padding(scene);
    EXPECT_FALSE(scene.padding) << kind;
    EXPECT_TRUE(scene.audit.empty()) << kind;
  }
}

TEST(UnstatedPadding, IsFoundInFilesOfEveryFormat) {
  const ScratchFolder folder;
  const Scene scene = round_scene([](int) { return -3024; });
  for (const char* name : {"ct.nii.gz", "ct.nrrd", "ct.mha"}) {
    write_scene(scene, folder / name);
    const Scene read = read_scene(folder / name);
    EXPECT_EQ(read.padding, -3024.0) << name;
    EXPECT_EQ(tests::verdict(read, "padding"), Verdict::Warn) << name;
  }
}

/// Slices of a disc of 40 HU in air; the corners hold -2000, which the header does not name, or names
/// wrongly.
TEST(UnstatedPadding, IsFoundInSlicesWhoseHeaderNamesNoneOrAnother) {
  for (const int named : {0, -32000}) {
    const ScratchFolder folder;
    for (tests::SpoiledImage& image : tests::sound_series()) {
      std::string pixels;
      for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 24; ++x) {
          const int r2 = (x - 12) * (x - 12) + (y - 10) * (y - 10);
          pixels += DicomBytes::number(static_cast<std::uint32_t>(r2 < 30 ? 40 : r2 < 90 ? -1000 : -2000), 2);
        }
      image.text(0x7fe00010, "OW", pixels);
      image.number(0x00280103, 1);
      image.text(0x00281052, "DS", "0");
      if (named != 0) image.text(0x00280120, "SS", DicomBytes::number(static_cast<std::uint16_t>(named), 2));
      std::ofstream(folder / image.name, std::ios::binary) << image.bytes();
    }
    const Scene read = read_scene(folder.path());
    EXPECT_EQ(read.padding, -2000.0) << named;
    EXPECT_EQ(range(read).low, -1000.0) << named;
    EXPECT_EQ(tests::verdict(read, "padding"), Verdict::Warn) << named;
  }
}

/// The round scene in single precision, where numbers below 0 may have 65536 added.
Scene wrapped_scene(bool is_wrapped) {
  Scene scene = round_scene([](int) { return -2000; });
  FloatSamples samples;
  for (const std::int16_t sample : std::get<Int16Samples>(scene.samples))
    samples.push_back(static_cast<float>(is_wrapped && sample < 0 ? sample + 65536 : sample));
  scene.samples = std::move(samples);
  return scene;
}

TEST(LostSign, NumbersBelowZeroThatWereReadWithoutASignAreTold) {
  const auto found = lost_sign_finding(wrapped_scene(true), true);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->verdict, Verdict::Fail);
  EXPECT_NE(found->detail.find("they would be -2000 to -975"), std::string::npos) << found->detail;
  EXPECT_EQ(lost_sign_finding(wrapped_scene(true), false)->verdict, Verdict::Warn);
  EXPECT_FALSE(lost_sign_finding(wrapped_scene(false), true));
}

TEST(LostSign, BrightSamplesThatContinueUpwardsAreMeasured) {
  Scene scene = wrapped_scene(false);
  auto& samples = std::get<FloatSamples>(scene.samples);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = static_cast<float>(5 * i % 60000);
  EXPECT_FALSE(lost_sign_finding(scene, false));
}

/// Slices without a sign whose corners hold 63536, which is -2000 with one.
TEST(LostSign, IsFoundInSlicesAndInVolumes) {
  const ScratchFolder folder;
  for (tests::SpoiledImage& image : tests::sound_series()) {
    std::string pixels;
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 24; ++x) {
        const int r2 = (x - 12) * (x - 12) + (y - 10) * (y - 10);
        pixels += DicomBytes::number(static_cast<std::uint32_t>(r2 < 30 ? 1064 : r2 < 90 ? 24 : 63536), 2);
      }
    image.text(0x7fe00010, "OW", pixels);
    image.number(0x00280103, 0);
    image.text(0x00281052, "DS", "-1024");
    std::ofstream(folder / image.name, std::ios::binary) << image.bytes();
  }
  EXPECT_EQ(tests::verdict(read_scene(folder.path()), "sign"), Verdict::Fail);
  Scene volume = wrapped_scene(true);
  volume.meaning = Meaning::Raw;
  write_scene(volume, folder / "ct.nrrd");
  EXPECT_EQ(tests::verdict(read_scene(folder / "ct.nrrd"), "sign"), Verdict::Warn);
}

}  // namespace
}  // namespace octotomy::voxel
