// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Padding is no measurement: in the range, in windows, between samples, and in straightened stacks.
#include <fstream>
#include <gtest/gtest.h>

#include "tests/voxel/linear_scene.h"
#include "tests/voxel/scan/dicom_bytes.h"
#include "tests/voxel/scan/spoiled_series.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/scan/read_scene.h"
#include "voxel/tree/build.h"
#include "voxel/tree/grey_octree.h"

namespace octotomy::voxel {
namespace {

using tests::DicomBytes;
using tests::ScratchFolder;
using tests::SpoiledImage;

constexpr int columns = 24, rows = 20;

struct Padded {
  std::int16_t value, limit;  ///< of the header
  std::int16_t fill;          ///< of the pixels
  double mark;                ///< expected of the scene
};

/// Twelve slices of 100 or 300 HU in a disc, padded around it; each is shifted by `lean_mm` from the last.
Scene read_padded(const ScratchFolder& folder, const Padded& padded, double lean_mm) {
  std::vector<SpoiledImage> images = tests::sound_series();
  for (std::size_t k = 0; k < images.size(); ++k) {
    std::string pixels;
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x) {
        const bool is_measured = (x - 12) * (x - 12) + (y - 10) * (y - 10) < 64;
        const int value = is_measured ? (x < 12 ? 100 : 300) : padded.fill;
        pixels += DicomBytes::number(static_cast<std::uint32_t>(value), 2);
      }
    images[k].text(0x7fe00010, "OW", pixels);
    images[k].number(0x00280103, 1);
    images[k].text(0x00281052, "DS", "0");
    images[k].text(0x00280120, "SS", DicomBytes::number(static_cast<std::uint16_t>(padded.value), 2));
    if (padded.limit != padded.value)
      images[k].text(0x00280121, "SS", DicomBytes::number(static_cast<std::uint16_t>(padded.limit), 2));
    images[k].place(-6, -5 + lean_mm * static_cast<double>(k), 30 + 2.0 * static_cast<double>(k));
    std::ofstream(folder / images[k].name, std::ios::binary) << images[k].bytes();
  }
  return read_scene(folder.path());
}

const std::vector<Padded>& kinds() {
  static const std::vector<Padded> all{{-2000, -2000, -2000, -2000}, {3000, 3000, 3000, -32768},
                                       {200, 200, 200, -32768},      {-3000, -2000, -2500, -3000},
                                       {-2000, -3000, -2500, -3000}, {400, 900, 555, -32768}};
  return all;
}

TEST(DicomPadding, IsOutsideOfTheRangeAndOfEveryWindow) {
  for (const Padded& padded : kinds()) {
    SCOPED_TRACE(padded.fill);
    const ScratchFolder folder;
    const Scene scene = read_padded(folder, padded, 0.0);
    ASSERT_TRUE(scene.padding);
    EXPECT_EQ(*scene.padding, padded.mark);
    EXPECT_EQ(range(scene).low, 100.0);
    EXPECT_EQ(range(scene).high, 300.0);
    const auto& samples = std::get<Int16Samples>(scene.samples);
    std::uint64_t measured = 0;
    for (const std::int16_t sample : samples) measured += sample == 100 || sample == 300;
    EXPECT_EQ(measured + static_cast<std::uint64_t>(std::count(samples.begin(), samples.end(),
                                                               static_cast<std::int16_t>(*scene.padding))),
              samples.size());
    const Universe universe = Universe{5, scene.lattice.lps_from_voxel};
    EXPECT_EQ(octree_of_window(universe, scene, -40000.0, 40000.0).voxel_count(), measured);
    EXPECT_EQ(grey_octree_of(universe, scene).scan().voxel_count(), measured);
    EXPECT_NE(tests::finding(scene, "padding")->detail.find(std::to_string(samples.size() - measured)),
              std::string::npos)
        << tests::finding(scene, "padding")->detail;
  }
}

/// Twelve slices of 100 or 300 HU in a disc with -2000 around it and one such sample in its middle. Slice k
/// states padding[k], if it is there, and has `fill[k]` around the disc.
Scene read_stated(const ScratchFolder& folder, const std::vector<std::optional<std::int16_t>>& padding,
                  const std::vector<std::int16_t>& fill) {
  std::vector<SpoiledImage> images = tests::sound_series();
  for (std::size_t k = 0; k < images.size(); ++k) {
    std::string pixels;
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x) {
        const bool is_measured = (x - 12) * (x - 12) + (y - 10) * (y - 10) < 64;
        const bool is_middle = x == 12 && y == 10;
        const int value = is_middle ? -2000 : is_measured ? (x < 12 ? 100 : 300) : fill[k];
        pixels += DicomBytes::number(static_cast<std::uint32_t>(value), 2);
      }
    images[k].text(0x7fe00010, "OW", pixels);
    images[k].number(0x00280103, 1);
    images[k].text(0x00281052, "DS", "0");
    if (padding[k])
      images[k].text(0x00280120, "SS", DicomBytes::number(static_cast<std::uint16_t>(*padding[k]), 2));
    std::ofstream(folder / images[k].name, std::ios::binary) << images[k].bytes();
  }
  return read_scene(folder.path());
}

/// Of one image, how many samples lie around the disc.
std::size_t around() {
  std::size_t count = 0;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) count += (x - 12) * (x - 12) + (y - 10) * (y - 10) >= 64;
  return count;
}

std::size_t padded_in(const Scene& scene, std::size_t slice) {
  const auto& samples = std::get<Int16Samples>(scene.samples);
  const auto first = samples.begin() + static_cast<std::ptrdiff_t>(slice * columns * rows);
  return static_cast<std::size_t>(
      std::count(first, first + columns * rows, static_cast<std::int16_t>(*scene.padding)));
}

TEST(DicomPadding, OfSomeSlicesIsAssumedAtTheRimsOfTheOthersAndSaid) {
  const ScratchFolder folder;
  std::vector<std::optional<std::int16_t>> padding(12);
  for (const std::size_t k : {0U, 1U, 2U, 3U}) padding[k] = -2000;
  const Scene scene = read_stated(folder, padding, std::vector<std::int16_t>(12, -2000));
  ASSERT_TRUE(scene.padding);
  for (std::size_t k = 0; k < 12; ++k)
    EXPECT_EQ(padded_in(scene, k), around() + (k < 4 ? 1 : 0))
        << k << ": the sample in the middle is padding only where the slice states it";
  EXPECT_EQ(tests::verdict(scene, "unstated_padding"), Verdict::Warn);
  const std::string detail = tests::finding(scene, "unstated_padding")->detail;
  EXPECT_NE(detail.find("8 slices state no PixelPaddingValue, as 4 of the series do (stored -2000)"),
            std::string::npos)
      << detail;
  EXPECT_NE(detail.find(std::to_string(8 * around()) + " samples"), std::string::npos) << detail;
  EXPECT_EQ(tests::finding(scene, "unstated_padding")->files.size(), 8U);
}

TEST(DicomPadding, OfSomeSlicesLeavesTheOthersAloneWhereTheyHoldNone) {
  const ScratchFolder folder;
  std::vector<std::optional<std::int16_t>> padding(12);
  std::vector<std::int16_t> fill(12, -1000);
  padding[0] = -2000;
  fill[0] = -2000;
  const Scene scene = read_stated(folder, padding, fill);
  ASSERT_TRUE(scene.padding);
  EXPECT_EQ(padded_in(scene, 0), around() + 1);
  for (std::size_t k = 1; k < 12; ++k) EXPECT_EQ(padded_in(scene, k), 0U) << k;
  EXPECT_FALSE(tests::finding(scene, "unstated_padding"));
}

TEST(DicomPadding, IsEachSlicesOwn) {
  const ScratchFolder folder;
  std::vector<std::optional<std::int16_t>> padding(12);
  std::vector<std::int16_t> fill(12);
  for (std::size_t k = 0; k < 12; ++k) {
    fill[k] = k < 6 ? -2000 : -1500;
    padding[k] = fill[k];
  }
  const Scene scene = read_stated(folder, padding, fill);
  ASSERT_TRUE(scene.padding);
  for (std::size_t k = 0; k < 12; ++k) EXPECT_EQ(padded_in(scene, k), around() + (k < 6 ? 1 : 0)) << k;
  EXPECT_FALSE(tests::finding(scene, "unstated_padding"));
  EXPECT_NE(tests::finding(scene, "padding")->detail.find("values -2000 to -1500, each slice's own"),
            std::string::npos)
      << tests::finding(scene, "padding")->detail;
}

TEST(DicomPadding, IsMixedIntoNoSampleOfATiltedStack) {
  for (const Padded& padded : kinds()) {
    SCOPED_TRACE(padded.fill);
    const ScratchFolder folder;
    const Scene scene = read_padded(folder, padded, 0.3);
    ASSERT_TRUE(scene.padding);
    EXPECT_GT(scene.lattice.dims.y, rows) << "it was straightened";
    std::size_t measured = 0;
    for (const std::int16_t sample : std::get<Int16Samples>(scene.samples)) {
      if (sample == *scene.padding) continue;
      // The shift is along y, across which the values do not change.
      EXPECT_TRUE(sample == 100 || sample == 300) << sample;
      ++measured;
    }
    EXPECT_GT(measured, 1000U);
  }
}

TEST(DicomPadding, IsMixedIntoNoInterpolatedSample) {
  const ScratchFolder folder;
  const Scene scene = read_padded(folder, kinds()[1], 0.0);
  for (double x = 0.0; x <= columns - 1; x += 0.25) {
    const double sample = interpolate(scene, {x, 10.5, 3.5});
    EXPECT_TRUE(sample == *scene.padding || (sample >= 100.0 && sample <= 300.0)) << x << ": " << sample;
  }
  // A finer universe, whose voxels lie between the scan's samples.
  Universe universe = Universe{5, scene.lattice.lps_from_voxel};
  universe.lps_from_voxel =
      universe.lps_from_voxel * glm::dmat4(glm::dvec4(0.5, 0, 0, 0), glm::dvec4(0, 0.5, 0, 0),
                                           glm::dvec4(0, 0, 0.5, 0), glm::dvec4(0, 0, 0, 1));
  ++universe.depth;
  const GreyOctree grey = grey_octree_of(universe, scene);
  std::size_t measured = 0;
  for (int z = 0; z < 24; ++z)
    for (int y = 0; y < 2 * rows; ++y)
      for (int x = 0; x < 2 * columns; ++x) {
        const std::int16_t sample = grey.sample({x, y, z});
        EXPECT_TRUE(sample == grey.background() || (sample >= 100 && sample <= 300)) << sample;
        measured += sample != grey.background();
      }
  EXPECT_EQ(grey.scan().voxel_count(), measured);
  EXPECT_GT(measured, 10000U);
}

}  // namespace
}  // namespace octotomy::voxel
