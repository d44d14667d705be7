// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The head phantom as scanners write it: tilted, uneven, with slices missing, repeated and misnamed. Read
// back, every fault is named, volumes are the closed form's and landmarks are where they were.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <gtest/gtest.h>

#include "tests/verify/le_fort_cut.h"
#include "tests/voxel/linear_scene.h"
#include "tests/voxel/scratch_folder.h"
#include "verify/phantom/head_phantom.h"
#include "verify/phantom/sample_volume.h"
#include "voxel/measure/measure.h"
#include "voxel/scan/read_scene.h"
#include "voxel/scan/write_scene.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/partial_volume.h"

namespace octotomy::verify {
namespace {

namespace fs = std::filesystem;
using tests::le_fort_cut;
using tests::verdict;
using voxel::Verdict;

constexpr double voxel_mm = 1.0;
constexpr double bone_hu = 300.0;

double truth_mm3(const voxel::Box& box, double step_mm) {
  return sample_volume(box, step_mm, [](const glm::dvec3& p) { return head_contains(HeadPart::Bone, p); })
      .volume_mm3;
}

fs::path slice(const fs::path& folder, std::size_t k) {
  char name[32];
  std::snprintf(name, sizeof name, "slice_%04zu.dcm", k + 1);
  return folder / name;
}

// The head written with a tilt and slice spacing, once each.
const tests::ScratchFolder& scratch() {
  static const tests::ScratchFolder folder;
  return folder;
}
fs::path scanned(double tilt_deg, double slice_mm) {
  const fs::path folder =
      scratch() / (std::to_string(static_cast<int>(tilt_deg)) + "_" + std::to_string(slice_mm));
  if (fs::exists(folder)) return folder;
  HeadOptions options;
  options.voxel_mm = voxel_mm;
  options.slice_mm = slice_mm;
  options.gantry_tilt_deg = tilt_deg;
  voxel::write_dicom_series(head_phantom(options), folder);
  return folder;
}

// The wanted slices of a series, under names that do not show their order.
fs::path shuffled(const fs::path& series, const std::string& name,
                  const std::function<int(std::size_t)>& copies) {
  const fs::path folder = scratch() / name;
  fs::create_directories(folder);
  for (std::size_t k = 0; fs::exists(slice(series, k)); ++k)
    for (int i = 0; i < copies(k); ++i)
      fs::copy_file(slice(series, k),
                    folder / ("I" + std::to_string((k * 7919 + 13) % 10007) + "_" + std::to_string(i)));
  return folder;
}

struct Found {
  double whole_mm3, fragment_mm3;
  glm::dvec3 fragment_centroid_mm;
};

Found found(const voxel::Scene& scene) {
  const voxel::Universe universe = voxel::universe_around(voxel::bounds(scene.lattice), voxel_mm);
  const double whole_mm3 = voxel::partial_volume_mm3({voxel::grey_octree_of(universe, scene), bone_hu});
  // About the cut, with its planes on faces of voxels, or each would err by up to half a voxel.
  const voxel::Universe fine =
      voxel::universe_around({le_fort_cut.low_mm - 4.0, le_fort_cut.high_mm + 4.0}, 0.5);
  const voxel::Window bone{voxel::grey_octree_of(fine, scene), bone_hu};
  const voxel::Measures fragment =
      voxel::measure(voxel::combine(fine, voxel::Expression(bone) & le_fort_cut));
  return {whole_mm3, fragment.volume_mm3, fragment.centroid_mm.value()};
}

void expect_the_head(const voxel::Scene& scene) {
  static const Found straight = found(voxel::read_scene(scanned(0, voxel_mm)));
  static const double whole_mm3 = truth_mm3(head_bounds(), 1.5), fragment_mm3 = truth_mm3(le_fort_cut, 0.5);
  const Found now = found(scene);
  EXPECT_NEAR(now.whole_mm3 / whole_mm3, 1.0, 0.01);
  EXPECT_NEAR(now.fragment_mm3 / fragment_mm3, 1.0, 0.01);
  // The fragment's centroid stands for its landmarks: a mirrored, shifted or sheared head moves it.
  EXPECT_LT(glm::distance(now.fragment_centroid_mm, straight.fragment_centroid_mm), 0.5 * voxel_mm);
}

TEST(ScannedHead, IsTheSameTiltedForwardsAndBackwards) {
  for (const double tilt_deg : {15.0, -15.0}) {
    SCOPED_TRACE(std::to_string(tilt_deg));
    const voxel::Scene scene = voxel::read_scene(scanned(tilt_deg, voxel_mm));
    EXPECT_EQ(verdict(scene, "gantry_tilt"), Verdict::Warn);
    EXPECT_NE(tests::finding(scene, "gantry_tilt")->detail.find("15.00 degrees"), std::string::npos)
        << tests::finding(scene, "gantry_tilt")->detail;
    expect_the_head(scene);
  }
}

TEST(ScannedHead, IsTheSameUnderNamesThatSayNothing) {
  const voxel::Scene scene =
      voxel::read_scene(shuffled(scanned(0, voxel_mm), "shuffled", [](std::size_t) { return 1; }));
  EXPECT_EQ(verdict(scene, "slice_spacing"), Verdict::Pass);
  EXPECT_EQ(verdict(scene, "missing_slices"), Verdict::Pass);
  expect_the_head(scene);
}

TEST(ScannedHead, IsTheSameWithASliceMissingAndOneStoredTwice) {
  const voxel::Scene scene = voxel::read_scene(shuffled(scanned(0, voxel_mm), "faulty", [](std::size_t k) {
    return k == 90 ? 0 : k == 120 ? 2 : 1;
  }));
  EXPECT_EQ(verdict(scene, "missing_slices"), Verdict::Warn);
  EXPECT_NE(tests::finding(scene, "missing_slices")->detail.find("1 of "), std::string::npos);
  EXPECT_EQ(verdict(scene, "duplicates"), Verdict::Warn);
  expect_the_head(scene);
}

TEST(ScannedHead, IsTheSameWithSlicesUnevenlyApart) {
  // From slices half a millimetre apart, every second or third is kept: gaps of 1 and 1.5 mm.
  const voxel::Scene scene = voxel::read_scene(
      shuffled(scanned(0, 0.5), "uneven", [](std::size_t k) { return k % 5 == 0 || k % 5 == 2 ? 1 : 0; }));
  EXPECT_EQ(verdict(scene, "slice_spacing"), Verdict::Warn);
  EXPECT_NE(tests::finding(scene, "slice_spacing")->detail.find("from 1 to 1.5 mm"), std::string::npos)
      << tests::finding(scene, "slice_spacing")->detail;
  expect_the_head(scene);
}

}  // namespace
}  // namespace octotomy::verify
