// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Where the scanner measured nothing, filters keep it so and mix nothing of it with what was measured.
#include "voxel/filter/measured.h"

#include <gtest/gtest.h>
#include <set>

#include "tests/voxel/field_scene.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/filter/crop.h"
#include "voxel/filter/edge_operator.h"
#include "voxel/filter/histogram.h"
#include "voxel/filter/resample_slices.h"
#include "voxel/filter/smooth.h"
#include "voxel/filter/streak_clamp.h"
#include "voxel/scan/read_scene.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::voxel {
namespace {

using tests::field_scene;
using tests::for_each_index;
using tests::sample_at;

const Lattice scan_lattice = axis_aligned_lattice({24, 20, 12}, {1, 1, 2}, {-12, -10, 0});

bool is_measured(const glm::dvec3& p) {
  return p.x * p.x + p.y * p.y < 64.0 && p.z < 20.0;
}

/// 100 on the left and 300 on the right of a disc; around it and in the last slices nothing was measured.
template <typename Sample>
Scene padded(double mark) {
  Scene scene = field_scene<Sample>(scan_lattice, [&](const glm::dvec3& p) {
    return !is_measured(p) ? mark : p.x < 0.0 ? 100.0 : 300.0;
  });
  scene.padding = mark;
  return scene;
}

std::size_t padded_samples(const Scene& scene) {
  std::size_t count = 0;
  for_each_index(scene.lattice, 0, [&](const glm::ivec3& p) {
    if (sample_at(scene, p) == scene.padding) ++count;
  });
  return count;
}

/// Padding stands where it stood, and what was measured stays between 100 and 300.
void expect_measured(const Scene& before, const Scene& after) {
  ASSERT_TRUE(after.padding);
  for_each_index(before.lattice, 0, [&](const glm::ivec3& p) {
    const double sample = sample_at(after, p);
    if (sample_at(before, p) == before.padding)
      ASSERT_EQ(sample, *after.padding);
    else
      ASSERT_TRUE(sample >= 100.0 && sample <= 300.0) << sample;
  });
}

TEST(Padding, StaysAndIsMixedWithNothingBySmoothing) {
  for (const Scene& scene :
       {padded<std::int16_t>(-32768.0), padded<std::int16_t>(-2000.0), padded<float>(-4.0e6)}) {
    expect_measured(scene, gaussian(scene, 2.0));
    expect_measured(scene, median(scene, {2, 2, 1}));
    expect_measured(scene, diffuse(scene, {}));
    // The twin: without the statement the padding leaks into its neighbours.
    Scene believed = scene;
    believed.padding.reset();
    double least = 300.0;
    const Scene mixed = gaussian(believed, 2.0);
    for_each_index(scan_lattice, 0, [&](const glm::ivec3& p) {
      if (is_measured(scan_lattice.lps_mm(p))) least = std::min(least, sample_at(mixed, p));
    });
    EXPECT_LT(least, 0.0);
  }
}

TEST(Padding, MakesNoEdge) {
  const Scene scene = padded<std::int16_t>(-32768.0);
  const Scene edges = zucker_hummel(scene);
  const Scene laplacian = marr_hildreth(scene, 1.0);
  EXPECT_EQ(padded_samples(edges), padded_samples(scene));
  EXPECT_EQ(padded_samples(laplacian), padded_samples(scene));
  for_each_index(scan_lattice, 0, [&](const glm::ivec3& p) {
    if (!is_measured(scan_lattice.lps_mm(p))) return;
    // The step from 100 to 300 lies between x = -1 and 0; its gradient is at most 100 a millimetre.
    EXPECT_LE(sample_at(edges, p), 100.0 + 1e-3);
    EXPECT_LT(std::abs(sample_at(laplacian, p)), 200.0);
  });
}

TEST(Padding, OfABlockOrBetweenSlicesIsPadding) {
  const Scene scene = padded<std::int16_t>(-2000.0);
  const Scene coarse = average_down(scene, {2, 2, 2});
  for (const Scene& made :
       {coarse, resample_slices(scene, 0.7, SliceKernel::Linear),
        resample_slices(scene, 0.7, SliceKernel::Cubic), resample_slices(scene, 0.7, SliceKernel::Lanczos)}) {
    ASSERT_EQ(made.padding, -2000.0);
    std::size_t measured = 0;
    for_each_index(made.lattice, 0, [&](const glm::ivec3& p) {
      const double sample = sample_at(made, p);
      if (sample == -2000.0) return;
      ++measured;
      EXPECT_TRUE(sample >= 100.0 && sample <= 300.0) << sample;
    });
    EXPECT_GT(measured, 100U);
  }
}

TEST(Padding, GoesWithACropAndOutOfTheHistogram) {
  const Scene scene = padded<std::int16_t>(-32768.0);
  const Scene part = crop(scene, {{0, 0, 0}, {23, 19, 5}});
  EXPECT_EQ(part.padding, scene.padding);
  const Histogram counts = histogram(scene);
  EXPECT_EQ(counts.low, 100.0);
  EXPECT_EQ(counts.high, 300.0);
  std::uint64_t all = 0;
  for (const std::uint64_t count : counts.counts) all += count;
  EXPECT_EQ(all, scan_lattice.sample_count() - padded_samples(scene));
}

TEST(Padding, IsNoDarkStreak) {
  Scene scene = padded<std::int16_t>(-32768.0);
  std::get<Int16Samples>(scene.samples)[24 * 10 + 12] = 5000;
  const StreakClamp clamped = clamp_streaks(scene, {});
  EXPECT_EQ(clamped.metal, 1U);
  EXPECT_EQ(clamped.raised, 0U);
  EXPECT_EQ(padded_samples(clamped.scene), padded_samples(scene));
}

TEST(Padding, IsShapedToNothingByAWindowThatHoldsItsValue) {
  const Scene scene = padded<std::int16_t>(-2000.0);
  ShapeOptions options;
  options.spacing_mm = 2.0;
  options.low = -3000.0;
  const Scene shape = interpolate_shape(scene, options);
  EXPECT_FALSE(shape.padding);
  for_each_index(scan_lattice, 0, [&](const glm::ivec3& p) {
    EXPECT_EQ(sample_at(shape, p), is_measured(scan_lattice.lps_mm(p)) ? 1.0 : 0.0);
  });
}

TEST(Padding, SurvivesEveryFileFormatThatWeWrite) {
  const tests::ScratchFolder folder;
  Scene scene = padded<std::int16_t>(-2000.0);
  scene.meaning = Meaning::Hounsfield;
  scene.modality = "CT";
  for (const char* name : {"a.nrrd", "a.nhdr", "a.nii", "a.nii.gz", "a.mha", "a.mhd", "series"}) {
    if (std::string(name) == "series")
      write_dicom_series(scene, folder / name);
    else
      write_scene(scene, folder / name);
    const Scene read = read_scene(folder / name);
    ASSERT_TRUE(read.padding) << name;
    EXPECT_EQ(range(read).low, 100.0) << name;
    EXPECT_EQ(padded_samples(read), padded_samples(scene)) << name;
  }
  // A stated padding that lies among the file's values is ignored, and the contradiction is reported.
  scene.padding = 100.0;
  write_scene(scene, folder / "b.nrrd");
  const Scene read = read_scene(folder / "b.nrrd");
  EXPECT_EQ(read.padding, -2000.0);
  EXPECT_TRUE(std::any_of(read.audit.begin(), read.audit.end(), [](const Finding& finding) {
    return finding.detail.find("below the padding that the file states") != std::string::npos;
  }));
  // A padding value that no sample has is no padding either, however large.
  scene.padding = -1e9;
  write_scene(scene, folder / "c.nrrd");
  const Scene whole = read_scene(folder / "c.nrrd");
  EXPECT_EQ(whole.padding, -2000.0);
  EXPECT_GT(histogram(whole).counts.size(), 1U);
}

TEST(Padding, OfValuesThatAreNoIntegersSurvivesADicomSeries) {
  const tests::ScratchFolder folder;
  Scene scene = padded<float>(-4.0e6);
  for (float& sample : std::get<FloatSamples>(scene.samples))
    if (sample > 0.0F) sample += 0.25F;
  write_dicom_series(scene, folder / "series");
  const Scene read = read_scene(folder / "series");
  ASSERT_TRUE(read.padding);
  EXPECT_EQ(padded_samples(read), padded_samples(scene));
  EXPECT_NEAR(range(read).low, 100.25, 0.01);
  EXPECT_NEAR(range(read).high, 300.25, 0.01);
}

}  // namespace
}  // namespace octotomy::voxel
