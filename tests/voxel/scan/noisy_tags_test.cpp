// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Decimals that are noisy or rounded lose no slice and move no sample.
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <random>

#include "tests/voxel/linear_scene.h"
#include "tests/voxel/scan/spoiled_series.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/scan/read_scene.h"

namespace octotomy::voxel {
namespace {

using tests::ScratchFolder;
using tests::SpoiledImage;
using tests::verdict;

std::string decimals(std::initializer_list<double> values) {
  std::string text;
  for (const double value : values) {
    char number[24];
    std::snprintf(number, sizeof number, "%.7f", value);
    text += (text.empty() ? "" : "\\") + std::string(number);
  }
  return text;
}

Scene read(const ScratchFolder& folder, const std::vector<SpoiledImage>& images) {
  const std::filesystem::path path = folder / std::to_string(std::rand());
  std::filesystem::create_directory(path);
  for (const SpoiledImage& image : images)
    std::ofstream(path / image.name, std::ios::binary) << image.bytes();
  return read_scene(path);
}

void expect_same_samples(const Scene& scene, const Scene& sound) {
  EXPECT_EQ(scene.lattice.dims, sound.lattice.dims);
  EXPECT_EQ(scene.samples, sound.samples);
}

TEST(NoisyTags, OfOrientationsKeepEverySliceAndTheirMean) {
  const ScratchFolder folder;
  const Scene sound = read(folder, tests::sound_series());
  for (int seed = 0; seed < 20; ++seed) {
    std::mt19937 engine(static_cast<unsigned>(seed));
    const double noise = std::pow(10.0, -6 + seed % 3);
    std::normal_distribution<double> by(0.0, noise);
    std::vector<SpoiledImage> images = tests::sound_series();
    for (SpoiledImage& image : images)
      image.text(0x00200037, "DS",
                 decimals({1 + by(engine), by(engine), by(engine), by(engine), 1 + by(engine), by(engine)}));
    const Scene scene = read(folder, images);
    expect_same_samples(scene, sound);
    EXPECT_EQ(verdict(scene, "orientation"), Verdict::Pass) << seed;
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_LT(glm::length(scene.lattice.lps_from_voxel[axis] - sound.lattice.lps_from_voxel[axis]),
                10.0 * noise)
          << "seed " << seed;
  }
}

TEST(NoisyTags, AnOrientationThatWasMeantIsLeftOutAsAFailure) {
  const ScratchFolder folder;
  std::vector<SpoiledImage> images = tests::sound_series();
  images[3].text(0x00200037, "DS", decimals({1, 0, 0, 0, std::cos(0.01), std::sin(0.01)}));
  const Scene scene = read(folder, images);
  EXPECT_EQ(verdict(scene, "orientation"), Verdict::Fail);
  EXPECT_EQ(tests::finding(scene, "orientation")->files, std::vector<std::string>{"a03"});
}

TEST(NoisyTags, OfRoundedPositionsCopyEverySlice) {
  struct Rounded {
    double to_mm, apart_mm;
    Verdict verdict;
  };
  const ScratchFolder folder;
  const Scene sound = read(folder, tests::sound_series());
  for (const Rounded& rounded : {Rounded{0.1, 0.625, Verdict::Pass}, Rounded{0.1, 1.25, Verdict::Pass},
                                 Rounded{0.5, 0.8, Verdict::Warn}, Rounded{1.0, 1.25, Verdict::Warn},
                                 Rounded{1.0, 2.5, Verdict::Warn}}) {
    std::vector<SpoiledImage> images = tests::sound_series();
    for (std::size_t i = 0; i < images.size(); ++i)
      images[i].place(
          -6, -5,
          rounded.to_mm * std::round((30 + rounded.apart_mm * static_cast<double>(i)) / rounded.to_mm));
    const Scene scene = read(folder, images);
    SCOPED_TRACE(std::to_string(rounded.apart_mm) + " mm to " + std::to_string(rounded.to_mm));
    expect_same_samples(scene, sound);
    EXPECT_EQ(verdict(scene, "slice_spacing"), rounded.verdict)
        << tests::finding(scene, "slice_spacing")->detail;
    EXPECT_EQ(verdict(scene, "missing_slices"), Verdict::Pass);
    EXPECT_NEAR(scene.lattice.spacing_mm().z, rounded.apart_mm, 0.1 * rounded.to_mm);
  }
}

TEST(NoisyTags, AMissingSliceStaysMissingAmongRoundedPositions) {
  for (const double to_mm : {0.1, 1.0}) {
    const ScratchFolder folder;
    std::vector<SpoiledImage> images = tests::sound_series(24);
    for (std::size_t i = 0; i < images.size(); ++i)
      images[i].place(-6, -5, to_mm * std::round((30 + 1.0 * static_cast<double>(i)) / to_mm));
    images.erase(images.begin() + 11);
    for (std::size_t i = 0; i < images.size(); ++i) images[i].text(0x00200013, "IS", std::to_string(i + 1));
    const Scene scene = read(folder, images);
    EXPECT_EQ(scene.lattice.dims.z, 24) << to_mm;
    EXPECT_EQ(verdict(scene, "missing_slices"), Verdict::Warn);
    ASSERT_EQ(scene.holes.size(), 1U);
    EXPECT_NEAR(scene.holes[0].length_mm(), 2.0, to_mm);
  }
}

TEST(NoisyTags, ScatteredPositionsAreNoTilt) {
  const ScratchFolder folder;
  const Scene sound = read(folder, tests::sound_series());
  for (int seed = 0; seed < 20; ++seed) {
    std::mt19937 engine(static_cast<unsigned>(seed));
    std::uniform_real_distribution<double> by(-0.05, 0.05);
    std::vector<SpoiledImage> images = tests::sound_series();
    for (std::size_t i = 0; i < images.size(); ++i)
      images[i].text(
          0x00200032, "DS",
          decimals({-6 + by(engine), -5 + by(engine), 30 + 2.0 * static_cast<double>(i) + by(engine)}));
    const Scene scene = read(folder, images);
    SCOPED_TRACE("seed " + std::to_string(seed));
    expect_same_samples(scene, sound);
    EXPECT_EQ(verdict(scene, "gantry_tilt"), Verdict::Pass) << tests::finding(scene, "gantry_tilt")->detail;
    EXPECT_LT(glm::distance(scene.lattice.lps_mm({0, 0, 11}), sound.lattice.lps_mm({0, 0, 11})), 0.15);
  }
}

TEST(NoisyTags, AJoinedSeriesHoldsEveryImageAndFails) {
  const ScratchFolder folder;
  for (const std::uint32_t tag : {0x0020000eU, 0x0020000dU, 0x00200052U}) {
    const std::filesystem::path path = folder / std::to_string(tag);
    std::filesystem::create_directory(path);
    std::vector<SpoiledImage> images = tests::sound_series();
    for (std::size_t i = 0; i < images.size(); ++i) {
      images[i].text(tag, "UI", "1.2.99." + std::to_string(i));
      std::ofstream(path / images[i].name, std::ios::binary) << images[i].bytes();
    }
    EXPECT_EQ(read_scene(path).lattice.dims.z, 1);
    ReadOptions options;
    options.join = true;
    const Scene joined = read_scene(path, options);
    EXPECT_EQ(joined.lattice.dims.z, 12);
    EXPECT_EQ(verdict(joined, "join"), Verdict::Fail);
    EXPECT_NE(tests::finding(joined, "join")->detail.find("12 slices"), std::string::npos)
        << tests::finding(joined, "join")->detail;
  }
}

TEST(NoisyTags, AnotherPatientIsNeverJoined) {
  const ScratchFolder folder;
  std::vector<SpoiledImage> images = tests::sound_series();
  images[5].text(0x00100020, "LO", "B");
  images[5].text(0x0020000e, "UI", "1.2.99");
  for (const SpoiledImage& image : images)
    std::ofstream(folder / image.name, std::ios::binary) << image.bytes();
  ReadOptions options;
  options.join = true;
  const Scene joined = read_scene(folder.path(), options);
  EXPECT_EQ(verdict(joined, "patient"), Verdict::Fail);
  EXPECT_EQ(tests::finding(joined, "patient")->files, std::vector<std::string>{"a05"});
}

}  // namespace
}  // namespace octotomy::voxel
