// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/phantom/head_phantom.h"

#include <array>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <random>
#include <tbb/global_control.h>

#include "tests/verify/le_fort_cut.h"
#include "verify/phantom/head_solids.h"
#include "verify/phantom/sample_volume.h"

namespace octotomy::verify {
namespace {

using tests::le_fort_cut;

using Samples = voxel::Int16Samples;
using Inside = std::function<bool(const glm::dvec3&)>;

const Samples& samples_of(const voxel::Scene& scene) {
  return std::get<Samples>(scene.samples);
}

std::size_t index_of(const voxel::Scene& scene, const glm::ivec3& voxel) {
  const auto row = static_cast<std::size_t>(voxel.z) * static_cast<std::size_t>(scene.lattice.dims.y) +
                   static_cast<std::size_t>(voxel.y);
  return row * static_cast<std::size_t>(scene.lattice.dims.x) + static_cast<std::size_t>(voxel.x);
}

template <class Visit>
void for_all(const voxel::Scene& scene, const Visit& visit) {
  const glm::ivec3 dims = scene.lattice.dims;
  for (int z = 0; z < dims.z; ++z)
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x) visit(glm::ivec3(x, y, z));
}

// Volume of the voxels from 300 HU whose centre is inside.
double window_volume_mm3(const voxel::Scene& scene, const Inside& inside) {
  std::size_t count = 0;
  for_all(scene, [&](const glm::ivec3& voxel) {
    count += samples_of(scene)[index_of(scene, voxel)] >= 300 && inside(scene.lattice.lps_mm(voxel));
  });
  return static_cast<double>(count) * scene.lattice.voxel_mm3();
}

const voxel::Scene& plain_scan() {
  static const voxel::Scene scene = head_phantom();
  return scene;
}

voxel::Scene coarse_scan(const std::function<void(HeadOptions&)>& change = [](HeadOptions&) {}) {
  HeadOptions options;
  options.voxel_mm = 5.0;
  change(options);
  return head_phantom(options);
}

bool anywhere(const glm::dvec3&) {
  return true;
}
bool in_cut(const glm::dvec3& p) {
  return glm::all(glm::greaterThanEqual(p, le_fort_cut.low_mm)) &&
         glm::all(glm::lessThanEqual(p, le_fort_cut.high_mm));
}
bool in_bone(const glm::dvec3& p) {
  return head_contains(HeadPart::Bone, p);
}

// A step that shares nothing with the scans' voxels.
const SampledVolume& bone_truth() {
  static const SampledVolume truth = sample_volume(head_bounds(), 1.37, in_bone);
  return truth;
}
const SampledVolume& maxilla_truth() {
  static const SampledVolume truth = sample_volume(le_fort_cut, 0.61, in_bone);
  return truth;
}

TEST(HeadPhantom, AWindowFrom300HUHoldsTheBoneOfTheClosedFormWithinOnePerCent) {
  const SampledVolume& truth = bone_truth();
  EXPECT_LT(truth.standard_error_mm3, 0.001 * truth.volume_mm3);
  RecordProperty("scanned_by_truth",
                 std::to_string(window_volume_mm3(plain_scan(), anywhere) / truth.volume_mm3));
  EXPECT_NEAR(window_volume_mm3(plain_scan(), anywhere), truth.volume_mm3, 0.01 * truth.volume_mm3);
}

TEST(HeadPhantom, TheFragmentsOfALeFortICutHoldTheirBoneWithinOnePerCent) {
  const double maxilla_mm3 = maxilla_truth().volume_mm3;
  EXPECT_GT(maxilla_mm3, 20000.0);
  EXPECT_NEAR(window_volume_mm3(plain_scan(), in_cut), maxilla_mm3, 0.01 * maxilla_mm3);
  const double rest_mm3 = bone_truth().volume_mm3 - maxilla_mm3;
  const auto in_rest = [](const glm::dvec3& p) { return !in_cut(p); };
  EXPECT_NEAR(window_volume_mm3(plain_scan(), in_rest), rest_mm3, 0.01 * rest_mm3);
}

// The twin that must fail: another threshold is another solid.
TEST(HeadPhantom, AWindowFrom200HUIsMoreThanOnePerCentOff) {
  std::size_t count = 0;
  for (const std::int16_t sample : samples_of(plain_scan())) count += sample >= 200;
  const double volume_mm3 = static_cast<double>(count) * plain_scan().lattice.voxel_mm3();
  EXPECT_GT(volume_mm3, 1.01 * bone_truth().volume_mm3);
}

TEST(HeadPhantom, TiltedSlicesHoldTheSameBoneOnASkewLattice) {
  HeadOptions options;
  options.gantry_tilt_deg = 15.0;
  const voxel::Scene scene = head_phantom(options);
  const glm::dmat4& axes = scene.lattice.lps_from_voxel;
  EXPECT_NEAR(axes[1].z, std::sin(glm::radians(15.0)), 1e-12);
  EXPECT_EQ(axes[2], glm::dvec4(0, 0, 1, 0));
  EXPECT_NEAR(scene.lattice.voxel_mm3(), std::cos(glm::radians(15.0)), 1e-12);
  EXPECT_NEAR(window_volume_mm3(scene, anywhere), bone_truth().volume_mm3, 0.01 * bone_truth().volume_mm3);
  EXPECT_NEAR(window_volume_mm3(scene, in_cut), maxilla_truth().volume_mm3,
              0.01 * maxilla_truth().volume_mm3);
}

TEST(HeadPhantom, EveryVoxelIsTheMeanOf512SamplesAsIfNoneHadBeenSkipped) {
  const HeadSolids& head = head_solids();
  const HeadTissues tissues;
  const auto hounsfield = [&](const glm::dvec3& p) {
    if (head.skin(p) >= 0.0) return head.headrest(p) < 0.0 ? tissues.headrest : tissues.air;
    if (head.air(p) < 0.0) return tissues.air;
    if (head.tooth_core(p) < 0.0) return tissues.tooth_core;
    return head.bone(p) < 0.0 ? tissues.bone : tissues.soft;
  };
  for (const double tilt_deg : {0.0, -20.0}) {
    const voxel::Scene scene = coarse_scan([&](HeadOptions& options) {
      options.slice_mm = 3.0;
      options.gantry_tilt_deg = tilt_deg;
    });
    int mixed = 0;
    for_all(scene, [&](const glm::ivec3& voxel) {
      const std::size_t index = index_of(scene, voxel);
      if (index % 499 != 0) return;
      double sum = 0.0;
      for (int i = 0; i < 512; ++i) {
        const glm::dvec3 part(i & 7, (i >> 3) & 7, i >> 6);
        sum += hounsfield(scene.lattice.lps_mm(glm::dvec3(voxel) + (part - 3.5) / 8.0));
      }
      // A sample on a surface may fall either way by rounding of its place: a few of 512.
      ASSERT_NEAR(samples_of(scene)[index], sum / 512, 10.0) << "voxel " << index << ", tilt " << tilt_deg;
      mixed += sum / 512 != hounsfield(scene.lattice.lps_mm(voxel));
    });
    EXPECT_GT(mixed, 15);
  }
}

TEST(HeadPhantom, AnExostosisMarksThePatientsLeftAndNothingElseDiffers) {
  const glm::dvec3 bump(57.5, -17, -70);
  EXPECT_TRUE(head_contains(HeadPart::Mandible, bump));
  EXPECT_FALSE(head_contains(HeadPart::Mandible, bump * glm::dvec3(-1, 1, 1)));
  std::size_t left = 0, right = 0, elsewhere = 0;
  const voxel::Scene& scene = plain_scan();
  const Samples& samples = samples_of(scene);
  for_all(scene, [&](const glm::ivec3& voxel) {
    const glm::dvec3 p = scene.lattice.lps_mm(voxel);
    const glm::ivec3 mirror(scene.lattice.dims.x - 1 - voxel.x, voxel.y, voxel.z);
    const int difference = samples[index_of(scene, voxel)] - samples[index_of(scene, mirror)];
    if (difference < 100) return;
    if (glm::length(p - glm::dvec3(53.5, -17, -70)) < 9.0)
      ++left;
    else if (p.x < 0.0)
      ++right;
    else
      ++elsewhere;
  });
  EXPECT_GT(left, 100u);
  EXPECT_EQ(right, 0u);
  EXPECT_EQ(elsewhere, 0u);
}

TEST(HeadPhantom, TheFaceLooksToTheFrontAndTheCrownIsUp) {
  EXPECT_TRUE(head_contains(HeadPart::Skin, {0, -108, -20}));  // nose
  EXPECT_FALSE(head_contains(HeadPart::Skin, {0, 108, -20}));
  EXPECT_TRUE(head_contains(HeadPart::Bone, {0, 20, 104}));       // crown
  EXPECT_TRUE(head_contains(HeadPart::Mandible, {0, -84, -94}));  // chin
  EXPECT_TRUE(head_contains(HeadPart::Teeth, {4, -82, -52}));
  EXPECT_FALSE(head_contains(HeadPart::Mandible, {4, -82, -52}));  // an upper tooth
  EXPECT_FALSE(head_contains(HeadPart::Bone, {33, -75, 10}));      // orbit
  EXPECT_FALSE(head_contains(HeadPart::Bone, {0, 33, -25}));       // foramen magnum
}

// Reads points in rows as sampling does, points at random, and both in turn.
TEST(HeadPhantom, APartHoldsAPointWhereItsClosedFormIsNegativeInAnyOrderOfAsking) {
  const HeadSolids& head = head_solids();
  const std::array<std::pair<HeadPart, const ImplicitSolid*>, 4> parts{{{HeadPart::Bone, &head.bone},
                                                                        {HeadPart::Mandible, &head.mandible},
                                                                        {HeadPart::Teeth, &head.teeth},
                                                                        {HeadPart::Skin, &head.skin}}};
  std::mt19937_64 random(1);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution(low, high)(random);
  };
  int inside = 0, outside = 0;
  for (int row = 0; row < 60; ++row) {
    glm::dvec3 p(between(-60, 20), between(-95, -20), between(-90, 20));
    const double step_mm = between(0.1, 2.5);
    for (int i = 0; i < 25; ++i, p.x += step_mm) {
      const glm::dvec3 elsewhere(between(-90, 90), between(-110, 110), between(-120, 110));
      for (const auto& [part, form] : parts)
        for (const glm::dvec3& asked : {p, elsewhere}) {
          if (asked == elsewhere && row % 3 > 0) continue;
          const bool is_inside = (*form)(asked) < 0.0;
          ASSERT_EQ(head_contains(part, asked), is_inside)
              << "row " << row << ", point " << i << ": " << asked.x << " " << asked.y << " " << asked.z;
          ++(is_inside ? inside : outside);
        }
    }
  }
  EXPECT_GT(inside, 500);
  EXPECT_GT(outside, 500);
}

TEST(HeadPhantom, PlanesAtWholeMillimetresLieBetweenVoxels) {
  const glm::dvec3 corner = plain_scan().lattice.lps_mm(glm::dvec3(-0.5));
  EXPECT_EQ(corner, glm::round(corner));
  EXPECT_EQ(voxel::bounds(plain_scan().lattice).high_mm, head_bounds().high_mm);
}

TEST(HeadPhantom, BoneNeverBordersAir) {
  const voxel::Scene& scene = plain_scan();
  const Samples& samples = samples_of(scene);
  const std::array<std::size_t, 3> strides{1, index_of(scene, {0, 1, 0}), index_of(scene, {0, 0, 1})};
  int borders = 0;
  for (const std::size_t stride : strides)
    for (std::size_t i = 0; i + stride < samples.size(); ++i) {
      const auto [low, high] = std::minmax(samples[i], samples[i + stride]);
      borders += high >= 300 && low < -100;
    }
  EXPECT_EQ(borders, 0);
}

TEST(HeadPhantom, NoiseBelongsToItsSeedAndHasItsSigma) {
  const auto noisy = [](std::uint64_t seed) {
    return coarse_scan([&](HeadOptions& options) {
      options.noise_sigma_hu = 20.0;
      options.seed = seed;
    });
  };
  const voxel::Scene clean = coarse_scan(), first = noisy(1), again = noisy(1), other = noisy(2);
  EXPECT_EQ(samples_of(first), samples_of(again));
  EXPECT_NE(samples_of(first), samples_of(other));
  double sum = 0.0, squares = 0.0, products = 0.0;
  const auto count = static_cast<double>(samples_of(clean).size());
  for (std::size_t i = 0; i < samples_of(clean).size(); ++i) {
    const double a = samples_of(first)[i] - samples_of(clean)[i];
    const double b = samples_of(other)[i] - samples_of(clean)[i];
    sum += a;
    squares += a * a;
    products += a * b;
  }
  // Five standard errors of mean, variance and covariance.
  EXPECT_NEAR(sum / count, 0.0, 5.0 * 20.0 / std::sqrt(count));
  EXPECT_NEAR(squares / count, 400.0, 5.0 * 400.0 * std::sqrt(2.0 / count));
  EXPECT_NEAR(products / count, 0.0, 5.0 * 400.0 / std::sqrt(count));
}

TEST(HeadPhantom, ThePointSpreadKeepsTheSumAndFlattensEdges) {
  const auto blur = [](double sigma_mm) {
    return coarse_scan([&](HeadOptions& options) {
      options.voxel_mm = 3.0;
      options.point_spread_sigma_mm = sigma_mm;
    });
  };
  const voxel::Scene sharp = blur(0.0), soft = blur(3.0);
  double before = 0.0, after = 0.0, rough_before = 0.0, rough_after = 0.0;
  for (std::size_t i = 1; i < samples_of(sharp).size(); ++i) {
    before += samples_of(sharp)[i] + 1000.0;
    after += samples_of(soft)[i] + 1000.0;
    rough_before += std::pow(samples_of(sharp)[i] - samples_of(sharp)[i - 1], 2);
    rough_after += std::pow(samples_of(soft)[i] - samples_of(soft)[i - 1], 2);
  }
  // The neck and the headrest's ends meet the border, where the border's sample is repeated.
  EXPECT_NEAR(after / before, 1.0, 0.002);
  EXPECT_LT(rough_after, 0.5 * rough_before);
}

TEST(HeadPhantom, OneThreadGivesTheSameBits) {
  const auto scan = [] {
    return coarse_scan([](HeadOptions& options) {
      options.point_spread_sigma_mm = 3.0;
      options.noise_sigma_hu = 10.0;
    });
  };
  const voxel::Scene many = scan();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(samples_of(many), samples_of(scan()));
}

TEST(HeadPhantom, RefusesWhatCannotBeScanned) {
  EXPECT_THROW(coarse_scan([](HeadOptions& o) { o.voxel_mm = 0.0; }), std::invalid_argument);
  EXPECT_THROW(coarse_scan([](HeadOptions& o) { o.voxel_mm = NAN; }), std::invalid_argument);
  EXPECT_THROW(coarse_scan([](HeadOptions& o) { o.slice_mm = -1.0; }), std::invalid_argument);
  EXPECT_THROW(coarse_scan([](HeadOptions& o) { o.gantry_tilt_deg = 60.0; }), std::invalid_argument);
  EXPECT_THROW(coarse_scan([](HeadOptions& o) { o.noise_sigma_hu = -1.0; }), std::invalid_argument);
  EXPECT_THROW(coarse_scan([](HeadOptions& o) { o.voxel_mm = 0.01; }), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::verify
