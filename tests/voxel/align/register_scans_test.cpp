// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/align/register_scans.h"

#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/reference_data.h"
#include "voxel/align/scan_pair.h"
#include "voxel/scan/read_scene.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

constexpr const char* head_name = "ct_unc_cthead.nrrd";

const Scene& real_head() {
  static const Scene head = read_scene(tests::reference_data(head_name));
  return head;
}

/// Every second sample along x and y, from the given slice on, through a function of the sample.
Scene altered(const Scene& scene, int first_slice, const std::function<double(double)>& value) {
  const auto& samples = std::get<Int16Samples>(scene.samples);
  const glm::ivec3 dims = scene.lattice.dims, fewer(dims.x / 2, dims.y / 2, dims.z - first_slice);
  Scene made = scene;
  made.lattice.dims = fewer;
  made.lattice.lps_from_voxel[3] += scene.lattice.lps_from_voxel[2] * static_cast<double>(first_slice);
  made.lattice.lps_from_voxel[0] *= 2.0;
  made.lattice.lps_from_voxel[1] *= 2.0;
  Int16Samples kept;
  kept.reserve(static_cast<std::size_t>(fewer.x * fewer.y * fewer.z));
  for (int z = 0; z < fewer.z; ++z)
    for (int y = 0; y < fewer.y; ++y)
      for (int x = 0; x < fewer.x; ++x)
        kept.push_back(static_cast<std::int16_t>(std::lround(value(
            samples[static_cast<std::size_t>(2 * x + dims.x * (2 * y + dims.y * (z + first_slice)))]))));
  made.samples = std::move(kept);
  return made;
}

glm::dmat4 motion(const glm::dvec3& shift_mm, double degrees, const glm::dvec3& axis) {
  return glm::rotate(glm::translate(glm::dmat4(1.0), shift_mm), glm::radians(degrees), glm::normalize(axis));
}

/// The largest distance of a corner of the scan from its true place.
double corner_error_mm(const Scene& scene, const glm::dmat4& found, const glm::dmat4& truth) {
  double error = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec4 p(scene.lattice.lps_mm(glm::dvec3(corner & 1, (corner >> 1) & 1, corner >> 2) *
                                            glm::dvec3(scene.lattice.dims - 1)),
                       1.0);
    error = std::max(error, glm::length(glm::dvec3(found * p - truth * p)));
  }
  return error;
}

/// The error of the fit for a scan that was moved by a known motion.
double error_of(Scene moved, const glm::dmat4& moved_from_still, const ScanFitOptions& options,
                ScanFit& fit) {
  const glm::dmat4 still = moved.lattice.lps_from_voxel;
  moved.lattice.lps_from_voxel = moved_from_still * still;
  fit = register_scans(moved, real_head(), options);
  return corner_error_mm(moved, fit.fixed_from_moving, glm::inverse(moved_from_still));
}

TEST(RegisterScans, ARealHeadIsLaidBackByCorrelationFromKnownMotions) {
  OCTOTOMY_NEEDS_DATA(head_name);
  ScanFitOptions options;
  options.by = ScanLikeness::Correlation;
  const Scene fewer = altered(real_head(), 0, [](double v) { return v; });
  for (const glm::dmat4& moved :
       {motion({12, -7, 9}, 8, {1, 2, -1}), motion({-40, 25, 60}, 25, {0.2, -0.3, 1})}) {
    ScanFit fit;
    EXPECT_LT(error_of(fewer, moved, options, fit), 0.5);
    EXPECT_EQ(fit.verdict, Verdict::Pass) << testing::PrintToString(fit.findings);
    EXPECT_GT(fit.likeness, 0.95);
    EXPECT_GT(fit.least_drop, 0.0);
  }
}

TEST(RegisterScans, AnotherContrastAndAPartOfTheHeadAreLaidBackByMutualInformation) {
  OCTOTOMY_NEEDS_DATA(head_name);
  // Soft tissue brightest, bone dark, air between: no function of HU that rises or falls. The neck is missing.
  const Scene other = altered(real_head(), 30, [](double v) {
    return v < -300 ? 400.0 : v > 250 ? 100.0 : 1000.0 - 0.5 * v;
  });
  const glm::dmat4 moved = motion({-15, 20, 10}, 12, {1, -1, 0.5});
  ScanFitOptions options;
  ScanFit fit;
  EXPECT_LT(error_of(other, moved, options, fit), 1.0);
  EXPECT_EQ(fit.verdict, Verdict::Pass) << testing::PrintToString(fit.findings);
  EXPECT_GT(fit.overlap, 0.9);
  // The correlation must either find the motion or report that it found nothing.
  options.by = ScanLikeness::Correlation;
  ScanFit failed;
  const double error = error_of(other, moved, options, failed);
  EXPECT_TRUE(error < 2.0 || failed.verdict != Verdict::Pass) << error << " " << failed.likeness;
}

TEST(RegisterScans, ScansWithoutAnythingInCommonFail) {
  OCTOTOMY_NEEDS_DATA(head_name);
  // Waves of 40 mm: as large as a head's parts, and alike nowhere.
  Scene waves = altered(real_head(), 0, [](double) { return 0.0; });
  auto& samples = std::get<Int16Samples>(waves.samples);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const glm::ivec3 dims = waves.lattice.dims;
    const auto n = static_cast<int>(i);
    const glm::dvec3 p = waves.lattice.lps_mm({n % dims.x, n / dims.x % dims.y, n / (dims.x * dims.y)});
    samples[i] =
        static_cast<std::int16_t>(500 * std::sin(p.x / 6.4) * std::sin(p.y / 6.4 + 1) * std::sin(p.z / 6.4));
  }
  for (const ScanLikeness by : {ScanLikeness::Correlation, ScanLikeness::MutualInformation}) {
    ScanFitOptions options;
    options.by = by;
    const ScanFit fit = register_scans(waves, real_head(), options);
    EXPECT_EQ(fit.verdict, Verdict::Fail) << fit.likeness;
    EXPECT_NE(testing::PrintToString(fit.findings).find("the scans match at no motion"), std::string::npos);
  }
}

TEST(RegisterScans, TheAnswerIsTheSameOnOneThreadAndOnManyAndEachStepIsWatched) {
  OCTOTOMY_NEEDS_DATA(head_name);
  Scene moved = altered(real_head(), 0, [](double v) { return v; });
  moved.lattice.lps_from_voxel = motion({6, 3, -4}, 5, {0, 0, 1}) * moved.lattice.lps_from_voxel;
  ScanFitOptions options;
  options.finest_mm = 4.0;
  std::vector<ScanFitStep> steps;
  options.watch = [&](const ScanFitStep& step) { steps.push_back(step); };
  const ScanFit many = register_scans(moved, real_head(), options);
  ASSERT_GT(steps.size(), 5u);
  EXPECT_LT(steps.front().likeness, 0.8 * steps.back().likeness);
  for (std::size_t i = 1; i < steps.size(); ++i) {
    if (steps[i].resolution_mm != steps[i - 1].resolution_mm) continue;
    EXPECT_GE(steps[i].likeness, steps[i - 1].likeness);
  }
  EXPECT_EQ(steps.back().fixed_from_moving, many.fixed_from_moving);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const ScanFit alone = register_scans(moved, real_head(), options);
  EXPECT_EQ(alone.fixed_from_moving, many.fixed_from_moving);
  EXPECT_EQ(alone.likeness, many.likeness);
}

TEST(RegisterScans, AScanOfOneValueAndOptionsOutOfRangeAreRefused) {
  Scene flat;
  flat.lattice = axis_aligned_lattice({20, 20, 20}, {8, 8, 8}, {0, 0, 0});
  flat.samples = Int16Samples(8000, 3);
  EXPECT_THROW(register_scans(flat, flat), InvalidInput);
  ScanFitOptions options;
  options.least_overlap = 0.0;
  EXPECT_THROW(register_scans(flat, flat, options), InvalidInput);
  options.least_overlap = 0.5;
  options.finest_mm = 9.0;
  EXPECT_THROW(register_scans(flat, flat, options), InvalidInput);
}

TEST(ScanPair, LikenessOfAScanWithItselfIsWholeAndOfPaddingNothing) {
  Scene ramp;
  ramp.lattice = axis_aligned_lattice({16, 16, 16}, {8, 8, 8}, {-60, -60, -60});
  Int16Samples samples;
  for (int i = 0; i < 4096; ++i) samples.push_back(static_cast<std::int16_t>(i % 16 * 100 + i / 256 * 7));
  ramp.samples = samples;
  const ScanPair alike(ramp, ramp, 8.0, 100000, ScanLikeness::Correlation);
  EXPECT_NEAR(alike.likeness(glm::dmat4(1.0)).value, 1.0, 1e-6);
  EXPECT_NEAR(alike.likeness(glm::dmat4(1.0)).overlap, 1.0, 1e-9);
  // Half of the points lie beyond the other scan.
  EXPECT_NEAR(alike.likeness(motion({64, 0, 0}, 0, {0, 0, 1})).overlap, 0.5, 0.02);
  Scene padded = ramp;
  padded.padding = -1000.0;
  auto& values = std::get<Int16Samples>(padded.samples);
  std::fill(values.begin(), values.begin() + 2048, static_cast<std::int16_t>(-1000));
  EXPECT_NEAR(coarse_scan(padded, 8.0).measured_mm3, 2048 * 512.0, 1e-6);
  EXPECT_GE(coarse_scan(padded, 8.0).low, 0.0f);
}

}  // namespace
}  // namespace octotomy::voxel
