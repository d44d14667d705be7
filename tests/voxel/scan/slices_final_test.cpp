// SPDX-License-Identifier: AGPL-3.0-or-later
// What ReadOptions::slices_final is told.
#include <algorithm>
#include <fstream>
#include <gtest/gtest.h>
#include <optional>
#include <stdexcept>
#include <vector>

#include "tests/file_bytes.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/scan/read_scene.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;
using tests::bytes_of;

/// More than is read at once.
Scene large_scene() {
  Scene scene;
  scene.lattice = axis_aligned_lattice({256, 200, 160}, {0.5, 0.6, 0.7}, {-3.0, 4.0, 5.0});
  Int16Samples samples(scene.lattice.sample_count());
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples[i] = static_cast<std::int16_t>((i * 2654435761U >> 20) % 900);
  scene.samples = std::move(samples);
  return scene;
}

struct Told {
  std::vector<int> counts;
  bool as_sound = true;  ///< slices that are final had the samples that were written
  std::string error;
};

Told read(const fs::path& path, const Scene& written) {
  Told told;
  ReadOptions options;
  options.slices_final = [&](const Scene& scene, int count) {
    told.counts.push_back(count);
    const auto& samples = std::get<Int16Samples>(scene.samples);
    const auto& sound = std::get<Int16Samples>(written.samples);
    const std::size_t held =
        sound.size() / static_cast<std::size_t>(written.lattice.dims.z) * static_cast<std::size_t>(count);
    told.as_sound =
        told.as_sound && scene.lattice.dims == written.lattice.dims &&
        std::equal(sound.begin(), sound.begin() + static_cast<std::ptrdiff_t>(held), samples.begin());
  };
  try {
    read_scene(path, options);
  } catch (const Error& error) {
    told.error = error.what();
  }
  return told;
}

std::string error_of_plain_read(const fs::path& path) {
  try {
    read_scene(path);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

class SlicesFinalTest : public testing::Test {
 protected:
  /// The file with bytes changed.
  void spoil(const fs::path& path, const std::function<void(std::string& bytes)>& change) const {
    std::string bytes = bytes_of(path);
    change(bytes);
    std::ofstream(path, std::ios::binary) << bytes;
  }
  void expect_refused(const Told& told, const fs::path& path) const {
    EXPECT_EQ(told.error, error_of_plain_read(path));
    EXPECT_NE(told.error, "");
    ASSERT_FALSE(told.counts.empty());
    EXPECT_EQ(told.counts.back(), 0);
    EXPECT_EQ(std::count(told.counts.begin(), told.counts.end(), 0), 1);
  }

  tests::ScratchFolder folder_;
  Scene scene_ = large_scene();
};

TEST_F(SlicesFinalTest, GrowUntilAllOfAVolumeFileAreRead) {
  for (const char* name : {"a.nrrd", "a.nhdr", "a.mha", "a.nii", "a.nii.gz"}) {
    const fs::path path = folder_ / name;
    write_scene(scene_, path);
    const Told told = read(path, scene_);
    EXPECT_EQ(told.error, "");
    EXPECT_GT(told.counts.size(), 2U) << name;
    EXPECT_GT(told.counts.front(), 0) << name;
    EXPECT_TRUE(std::is_sorted(told.counts.begin(), told.counts.end(), std::less_equal<>())) << name;
    EXPECT_EQ(told.counts.back(), 160) << name;
    EXPECT_TRUE(told.as_sound) << name;
  }
}

TEST_F(SlicesFinalTest, AreNoneWhereTheStreamIsCutShort) {
  const fs::path path = folder_ / "a.nrrd";
  write_scene(scene_, path);
  spoil(path, [](std::string& bytes) { bytes.resize(bytes.size() / 2); });
  const Told told = read(path, scene_);
  expect_refused(told, path);
  EXPECT_GT(told.counts.front(), 0);
  EXPECT_TRUE(told.as_sound);
}

TEST_F(SlicesFinalTest, AreNoneWhereTheChecksumIsWrong) {
  const fs::path path = folder_ / "a.nrrd";
  write_scene(scene_, path);
  spoil(path, [](std::string& bytes) { bytes[bytes.size() - 5] ^= 1; });
  const Told told = read(path, scene_);
  expect_refused(told, path);
  EXPECT_EQ(std::count(told.counts.begin(), told.counts.end(), 160), 0);
}

TEST_F(SlicesFinalTest, AreNoneWhereTheObserverThrows) {
  const fs::path path = folder_ / "a.nrrd";
  write_scene(scene_, path);
  std::vector<int> counts;
  ReadOptions options;
  options.slices_final = [&](const Scene&, int count) {
    counts.push_back(count);
    if (counts.size() == 2) throw Stopped("enough");
  };
  EXPECT_THROW(read_scene(path, options), Stopped);
  ASSERT_EQ(counts.size(), 3U);
  EXPECT_EQ(counts.back(), 0);
}

TEST_F(SlicesFinalTest, AreNotToldOfALatticeThatFailsTheCheck) {
  const fs::path path = folder_ / "a.nrrd";
  write_scene(scene_, path);
  spoil(path, [](std::string& bytes) {
    const std::size_t at = bytes.find("space directions:");
    ASSERT_NE(at, std::string::npos);
    const std::size_t end = bytes.find('\n', at);
    bytes.replace(at, end - at, "space directions: (0.5,0,0) (0.5,0,0) (0,0,0.7)");
  });
  const Told told = read(path, scene_);
  EXPECT_TRUE(told.counts.empty());
  EXPECT_EQ(told.error, error_of_plain_read(path));
  EXPECT_NE(told.error.find("geometry"), std::string::npos) << told.error;
}

TEST_F(SlicesFinalTest, AreNotToldOfSamplesThatAreConverted) {
  const auto& shorts = std::get<Int16Samples>(scene_.samples);
  Scene floats = scene_;
  floats.samples = FloatSamples(shorts.begin(), shorts.end());
  write_scene(floats, folder_ / "a.nrrd");
  const Told told = read(folder_ / "a.nrrd", scene_);
  EXPECT_TRUE(told.counts.empty());
  EXPECT_EQ(told.error, "");
}

}  // namespace
}  // namespace octotomy::voxel
