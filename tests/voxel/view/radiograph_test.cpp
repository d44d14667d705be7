// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/radiograph.h"

#include <cmath>
#include <gtest/gtest.h>

#include "voxel/space/scene.h"

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

TEST(Radiograph, StoppedItThrowsInsteadOfGivingHalfAPicture) {
  const GreyOctree grey = block_of_water();
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(radiograph(grey, plane_of(grey, "left"), {source.get_token(), {}}), Stopped);
}

}  // namespace
}  // namespace octotomy::voxel
