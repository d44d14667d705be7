// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/radiograph.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <tbb/global_control.h>

#include "voxel/space/scene.h"
#include "voxel/view/layer.h"

namespace octotomy::voxel {
namespace {

/// A universe of 64 voxels of 0.5 mm, air but for a block of water and one bright voxel.
GreyOctree block_of_water() {
  const Universe universe{
      6, axis_aligned_lattice(glm::ivec3(64), glm::dvec3(0.5), glm::dvec3(10.0, -4.0, 3.0)).lps_from_voxel};
  Scene scene;
  scene.lattice = universe.lattice();
  Int16Samples samples(scene.lattice.sample_count(), -1000);
  const auto at = [&](int x, int y, int z) -> std::int16_t& {
    return samples[static_cast<std::size_t>(x + 64 * (y + 64 * z))];
  };
  for (int z = 20; z < 44; ++z)
    for (int y = 10; y < 50; ++y)
      for (int x = 16; x < 48; ++x) at(x, y, z) = 0;
  at(5, 60, 7) = 2500;
  scene.samples = std::move(samples);
  return grey_octree_of(universe, scene);
}

ImagePlane plane_of(const GreyOctree& grey, const char* view_name) {
  const Box box = bounds(grey.universe().lattice());
  const View view = parse_view(view_name);
  // A pixel a voxel, through the voxels' centres.
  return image_plane(grey.universe(), view, glm::ivec2(64),
                     {view.project(0.5 * (box.low_mm + box.high_mm)), 32.0});
}

TEST(Radiograph, OfABlockOfWaterIsItsThicknessTimesItsAttenuationFromAllSides) {
  const GreyOctree grey = block_of_water();
  const std::pair<const char*, double> thickness_mm[] = {
      {"anterior", 20.0}, {"posterior", 20.0}, {"left", 16.0}, {"right", 16.0}, {"superior", 12.0}};
  for (const auto& [view, mm] : thickness_mm) {
    const RayImage image = radiograph(grey, plane_of(grey, view));
    EXPECT_NEAR(image.values[32 * 64 + 32], 0.0206 * mm, 1e-6) << view;
    EXPECT_EQ(image.values[0], 0.0f) << view;
  }
}

TEST(Radiograph, AlongADiagonalItIsTheDiagonalsLength) {
  const GreyOctree grey = block_of_water();
  const RayImage image = radiograph(grey, plane_of(grey, "45,0"));
  // Through the middle: the block is 16 mm wide along x, left through its sides. Steps of half a voxel blur
  // either end by as much.
  EXPECT_NEAR(image.values[32 * 64 + 32], 0.0206 * 16.0 * std::sqrt(2.0), 0.0206 * 0.5);
}

TEST(MaximumIntensity, FindsTheOneBrightVoxelBehindWhatIsDarkerAndTheWaterElsewhere) {
  const GreyOctree grey = block_of_water();
  const ImagePlane plane = plane_of(grey, "anterior");
  const RayImage image = maximum_intensity(grey, plane);
  int bright = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) bright += image.values[static_cast<std::size_t>(y * 64 + x)] > 2000.0f;
  EXPECT_EQ(bright, 1);
  // Row 0 is the top: voxel z = 7 is 56 rows below the highest, 63.
  EXPECT_EQ(image.values[56 * 64 + 5], 2500.0f);
  EXPECT_EQ(image.values[32 * 64 + 32], 0.0f);
  EXPECT_EQ(image.values[0], -1000.0f);
  const std::vector<std::uint8_t> tones = grey_tones(image, -1000.0, 2500.0);
  EXPECT_EQ(tones[3 * (56 * 64 + 5)], 255);
  EXPECT_EQ(tones[0], 0);
}

/// Air, tissue and bone in lumps of several voxels, so that leaves, blocks and their borders all differ.
GreyOctree lumps(std::uint64_t seed) {
  const Universe universe{
      6, axis_aligned_lattice(glm::ivec3(64), glm::dvec3(0.5), glm::dvec3(10.0, -4.0, 3.0)).lps_from_voxel};
  Scene scene;
  scene.lattice = universe.lattice();
  Int16Samples samples(scene.lattice.sample_count(), -1000);
  std::mt19937_64 random(seed);
  for (int lump = 0; lump < 40; ++lump) {
    const glm::ivec3 low(random() % 60, random() % 60, random() % 60);
    const glm::ivec3 size(1 + random() % 12, 1 + random() % 12, 1 + random() % 12);
    const auto value = static_cast<std::int16_t>(static_cast<int>(random() % 3500) - 1000);
    for (int z = low.z; z < std::min(64, low.z + size.z); ++z)
      for (int y = low.y; y < std::min(64, low.y + size.y); ++y)
        for (int x = low.x; x < std::min(64, low.x + size.x); ++x)
          samples[static_cast<std::size_t>(x + 64 * (y + 64 * z))] = value;
  }
  scene.samples = std::move(samples);
  return grey_octree_of(universe, scene);
}

double sample_at(const GreyOctree& grey, const glm::dvec3& p) {
  const glm::ivec3 cell(glm::floor(p));
  const glm::dvec3 t = p - glm::dvec3(cell);
  const auto along_x = [&](int y, int z) {
    const double at = grey.sample(cell + glm::ivec3(0, y, z));
    return at + (grey.sample(cell + glm::ivec3(1, y, z)) - at) * t.x;
  };
  const double below = along_x(0, 0) + (along_x(1, 0) - along_x(0, 0)) * t.y;
  const double above = along_x(0, 1) + (along_x(1, 1) - along_x(0, 1)) * t.y;
  return below + (above - below) * t.z;
}

/// Calls take(sample, mm) for equal steps of a ray, without skipping any; mm is what its trapezium covers.
template <typename Take>
bool step_along(const GreyOctree& grey, const ImagePlane& plane, int pixel, double steps_per_voxel,
                const Take& take) {
  const VoxelRays rays = voxel_rays(grey.universe(), plane);
  const glm::dvec3 start = rays.start({pixel % 64 + 0.5, pixel / 64 + 0.5});
  const auto span = span_among_centres(start, rays.per_mm, grey.universe().side());
  if (!span) return false;
  const double length_mm = span->far_mm - span->near_mm;
  const int count =
      std::max(1, static_cast<int>(std::ceil(length_mm * glm::length(rays.per_mm) * steps_per_voxel)));
  const double step_mm = length_mm / count;
  for (int i = 0; i <= count; ++i)
    take(sample_at(grey, start + (span->near_mm + i * step_mm) * rays.per_mm),
         (i == 0 || i == count ? 0.5 : 1.0) * step_mm);
  return true;
}

const char* const views[] = {"anterior", "posterior", "left",   "right", "superior",
                             "inferior", "35,15",     "-50,40", "80,-65"};

TEST(MaximumIntensity, IsThatOfAllStepsBitForBitThoughMostAreSkipped) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const GreyOctree grey = lumps(seed);
    for (const char* view : views) {
      const ImagePlane plane = plane_of(grey, view);
      const RayImage image = maximum_intensity(grey, plane);
      for (int pixel = 0; pixel < 64 * 64; pixel += 7) {
        double most = grey.background();
        step_along(grey, plane, pixel, 2.0, [&](double sample, double) { most = std::max(most, sample); });
        ASSERT_EQ(image.values[static_cast<std::size_t>(pixel)], static_cast<float>(most))
            << view << ", pixel " << pixel << ", seed " << seed;
      }
    }
  }
}

TEST(Radiograph, IsTheIntegralOfFineStepsThoughAirIsSkipped) {
  for (std::uint64_t seed = 0; seed < 2; ++seed) {
    const GreyOctree grey = lumps(seed);
    for (const char* view : views) {
      const ImagePlane plane = plane_of(grey, view);
      const RayImage image = radiograph(grey, plane);
      double worst = 0.0, sum = 0.0, brightest = 0.0;
      for (int pixel = 0; pixel < 64 * 64; pixel += 7) {
        double water_mm = 0.0;
        step_along(grey, plane, pixel, 16.0,
                   [&](double sample, double mm) { water_mm += mm * std::max(0.0, 1.0 + sample / 1000.0); });
        const double away = image.values[static_cast<std::size_t>(pixel)] - 0.0206 * water_mm;
        worst = std::max(worst, std::abs(away));
        sum += away;
        brightest = std::max(brightest, 0.0206 * water_mm);
      }
      // Edges of lumps are jumps of up to 3.5 times water within a voxel of 0.5 mm; along an axis a sum of
      // trapezia is exact.
      const bool is_along_axis = view[0] >= 'a';
      EXPECT_LT(worst, is_along_axis ? 1e-4 * brightest : 0.0206 * 3.5 * 0.5 * 0.5)
          << view << ", seed " << seed;
      EXPECT_LT(std::abs(sum) / 585.0, 2e-4 * brightest) << view << ", seed " << seed;
    }
  }
}

TEST(Radiograph, WithRangesDissolvedAndHeightenedIsTheIntegralOfTheWeightedVoxels) {
  const std::vector<RangeWeight> weights{{-200.0, 300.0, 0.0}, {1000.0, 1500.0, 3.0}, {0.0, 5000.0, 0.5}};
  const auto weight = [&](double sample) {
    return sample >= -200.0 && sample <= 300.0    ? 0.0
           : sample >= 1000.0 && sample <= 1500.0 ? 3.0
           : sample >= 0.0                        ? 0.5
                                                  : 1.0;
  };
  const GreyOctree grey = lumps(5);
  for (const char* view : {"anterior", "left", "inferior"}) {
    const ImagePlane plane = plane_of(grey, view);
    const RayImage image = radiograph(grey, plane, {}, weights);
    double most = 0.0;
    for (int pixel = 0; pixel < 64 * 64; pixel += 3) {
      // Rays through voxels' centres: the trapezia of the voxels' own attenuations.
      const VoxelRays rays = voxel_rays(grey.universe(), plane);
      const glm::dvec3 start = rays.start({pixel % 64 + 0.5, pixel / 64 + 0.5});
      int axis = 0;
      while (rays.per_mm[axis] == 0.0) ++axis;
      double water_mm = 0.0;
      for (int i = 0; i < 64; ++i) {
        glm::ivec3 voxel(glm::round(start));
        voxel[axis] = i;
        const double sample = grey.sample(voxel);
        water_mm += (i == 0 || i == 63 ? 0.25 : 0.5) * std::max(0.0, 1.0 + sample / 1000.0) * weight(sample);
      }
      ASSERT_NEAR(image.values[static_cast<std::size_t>(pixel)], 0.0206 * water_mm, 1e-5) << view << pixel;
      most = std::max(most, 0.0206 * water_mm);
    }
    EXPECT_GT(most, 0.3) << view;
  }
  // Weights of one are no weights, and dissolving all leaves nothing, in an oblique view, too.
  const ImagePlane oblique = plane_of(grey, "35,15");
  const RayImage plain = radiograph(grey, oblique), ones = radiograph(grey, oblique, {}, {{-900, 9000, 1.0}});
  const RayImage none = radiograph(grey, oblique, {}, {{-5000.0, 5000.0, 0.0}});
  for (std::size_t i = 0; i < plain.values.size(); ++i) {
    ASSERT_NEAR(ones.values[i], plain.values[i], 1e-4);
    ASSERT_EQ(none.values[i], 0.0f);
  }
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(radiograph(grey, oblique, {}, {{-900, 9000, 1.0}}).values, ones.values);
}

TEST(Radiograph, RefusesRangesThatAreEmptyAndWeightsBeyondTheirLimits) {
  const GreyOctree grey = block_of_water();
  const ImagePlane plane = plane_of(grey, "left");
  for (const RangeWeight& bad : {RangeWeight{1.0, 0.0, 0.0}, RangeWeight{0.0, 1.0, -0.1},
                                 RangeWeight{0.0, 1.0, 101.0}, RangeWeight{NAN, 1.0, 0.0}})
    EXPECT_THROW(radiograph(grey, plane, {}, {bad}), std::invalid_argument) << bad.low << " " << bad.weight;
}

TEST(Radiograph, AndMaximumIntensityAreTheSameBitsOnAnyThreadCount) {
  const GreyOctree grey = lumps(7);
  const ImagePlane plane = plane_of(grey, "35,15");
  const RayImage many[] = {radiograph(grey, plane), maximum_intensity(grey, plane)};
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(radiograph(grey, plane).values, many[0].values);
  EXPECT_EQ(maximum_intensity(grey, plane).values, many[1].values);
}

TEST(Radiograph, StoppedItThrowsInsteadOfGivingHalfAPicture) {
  const GreyOctree grey = block_of_water();
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(radiograph(grey, plane_of(grey, "left"), {source.get_token(), {}}), Stopped);
}

}  // namespace
}  // namespace octotomy::voxel
