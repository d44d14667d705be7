// SPDX-License-Identifier: AGPL-3.0-or-later
// Section 5.3 of the thesis: how far each way of shading is from the shade of the true surface.
#include <cmath>
#include <gtest/gtest.h>

#include "tests/voxel/dense.h"
#include "voxel/tree/build.h"
#include "voxel/view/object_normals.h"
#include "voxel/view/render.h"

namespace octotomy::voxel {
namespace {

constexpr double radius_voxels = 64.0;

/// The thesis's grey sphere: samples of partial volume, 0 outside, 1000 inside, of radius 64 voxels in 256.
DrawnObject grey_sphere() {
  const Universe universe{
      8, axis_aligned_lattice(glm::ivec3(256), glm::dvec3(1.0), glm::dvec3(0.0)).lps_from_voxel};
  Scene scene;
  scene.lattice = universe.lattice();
  Int16Samples samples(scene.lattice.sample_count());
  std::size_t next = 0;
  for (int z = 0; z < 256; ++z)
    for (int y = 0; y < 256; ++y)
      for (int x = 0; x < 256; ++x) {
        // A boundary voxel's filled share, to first order in its curvature: along the normal, a ramp as wide
        // as the voxel is thick in that direction.
        const glm::dvec3 from_centre = glm::dvec3(x, y, z) - 127.5;
        const double distance = glm::length(from_centre);
        const glm::dvec3 normal = glm::abs(from_centre / distance);
        const double inside = (radius_voxels - distance) / (normal.x + normal.y + normal.z) + 0.5;
        samples[next++] = static_cast<std::int16_t>(std::lround(1000.0 * std::clamp(inside, 0.0, 1.0)));
      }
  scene.samples = std::move(samples);
  return {"sphere", octree_of_window(universe, scene, 500, 32767), glm::vec3(1.0f),
          grey_octree_of(universe, scene), 500.0};
}

RenderOptions obliquely_lit(Shading shading, Algorithm algorithm) {
  RenderOptions options;
  options.size_px = {256, 256};
  options.centre_mm = glm::dvec2(127.5);
  options.width_mm = 256.0;
  options.algorithm = algorithm;
  options.shading = shading;
  // 45 degrees from the view.
  options.lights = {Light{{-0.5f, 0.5f, -0.7071f}, 0.9f}};
  options.occlusion = false;
  options.antialias = false;
  return options;
}

/// Root mean square of the difference of shades, as a share of white, over the sphere inside 0.9 of its
/// radius, where head light is not yet grazing.
double rms_error(const DrawnObject& sphere, Shading shading, Algorithm algorithm) {
  const RenderOptions options = obliquely_lit(shading, algorithm);
  const Picture picture = render({sphere}, options);
  const glm::dvec3 light = glm::normalize(glm::dvec3(options.lights.front().towards));
  const auto linear = [](double srgb) {
    return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
  };
  const double range_mm = 256.0;
  float nearest = std::numeric_limits<float>::infinity();
  for (const float depth : picture.depth_mm) nearest = std::min(nearest, depth);
  double squares = 0.0;
  int count = 0;
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 256; ++x) {
      const glm::dvec2 p(x + 0.5 - 128.0, 128.0 - y - 0.5);
      const double r = glm::length(p) / radius_voxels;
      if (r > 0.9) continue;
      const glm::dvec3 normal(p / radius_voxels, -std::sqrt(1.0 - r * r));
      const glm::dvec3 halfway = glm::normalize(light + glm::dvec3(0, 0, -1));
      const double depth = radius_voxels * (1.0 + normal.z);
      const double cue = 1.0 - 0.35 * depth / range_mm;
      const double truth = cue * (0.06 + 0.9 * std::max(0.0, glm::dot(normal, light)) +
                                  0.06 * std::pow(std::max(0.0, glm::dot(normal, halfway)), 48.0));
      const double shade =
          linear(picture.rgb[3 * (static_cast<std::size_t>(y) * 256 + static_cast<std::size_t>(x))] / 255.0);
      squares += (shade - truth) * (shade - truth);
      ++count;
    }
  EXPECT_GT(count, 10000);
  return std::sqrt(squares / count);
}

TEST(Shading, PartialVolumeOfAnObliquelyLitSphereIsWithinOnePerCentOfTheTrueNormalsShade) {
  const DrawnObject sphere = grey_sphere();
  EXPECT_LT(rms_error(sphere, Shading::PartialVolume, Algorithm::NodeTrace), 0.01);
  EXPECT_LT(rms_error(sphere, Shading::PartialVolume, Algorithm::RayCast), 0.01);
}

TEST(Shading, WithoutSamplesGradientsAreCoarserAndContextsCoarserStill) {
  const DrawnObject sphere = grey_sphere();
  const double interpolated = rms_error(sphere, Shading::PartialVolume, Algorithm::NodeTrace);
  const double gradient = rms_error(sphere, Shading::Gradient, Algorithm::NodeTrace);
  const double context = rms_error(sphere, Shading::Context, Algorithm::NodeTrace);
  // Steps of a whole voxel in slopes over a few: figure 5.8's plateaus, a few per cent after smoothing; 25
  // normals a face are tens of degrees apart.
  EXPECT_GT(gradient, 1.5 * interpolated);
  EXPECT_LT(gradient, 0.10);
  EXPECT_GT(context, gradient);
  // Central differences reach over two voxels, samples of partial volume change within one: between the two.
  const double grey_gradient = rms_error(sphere, Shading::GreyGradient, Algorithm::NodeTrace);
  EXPECT_GT(grey_gradient, interpolated);
  EXPECT_LT(grey_gradient, context);
  RecordProperty("partial_volume", std::to_string(interpolated));
  RecordProperty("gradient", std::to_string(gradient));
  RecordProperty("context", std::to_string(context));
  RecordProperty("grey_gradient", std::to_string(grey_gradient));
}

TEST(ContextNormal, HasFiveSlopesFromTheCasesOfTable51AndTurnsOverInTheComplement) {
  const Universe universe{
      3, axis_aligned_lattice(glm::ivec3(8), glm::dvec3(1.0), glm::dvec3(0.0)).lps_from_voxel};
  const glm::ivec3 voxel(3, 3, 3);
  // Neighbours DE, D, UE, U of the East face and the slope that table 5.1's case stands for.
  struct Row {
    bool down_east, down, up_east, up;
    double slope;
  };
  const Row rows[] = {
      {false, false, true, false, 1.0}, {false, true, true, true, 0.5},    {false, false, false, true, 0.5},
      {true, true, true, true, 0.0},    {false, true, false, true, 0.0},   {false, false, false, false, 0.0},
      {true, false, false, true, -0.5}, {false, true, false, false, -0.5}, {true, true, false, false, -1.0}};
  for (const Row& row : rows) {
    tests::Dense dense(8);
    dense.at(voxel) = 1;
    dense.at({4, 3, 2}) = row.down_east;
    dense.at({3, 3, 2}) = row.down;
    dense.at({4, 3, 4}) = row.up_east;
    dense.at({3, 3, 4}) = row.up;
    // South and North go on.
    dense.at({3, 2, 3}) = dense.at({3, 4, 3}) = 1;
    const glm::dvec3 normal = context_normal(tests::octree_of(universe, dense), voxel, 0, 1);
    EXPECT_EQ(normal, glm::dvec3(1.0, 0.0, -row.slope)) << row.slope;
  }
}

TEST(Rendering, ATranslucentObjectLetsWhatIsBehindShineThroughAndAHiddenOneIsNotSeen) {
  const Universe universe{
      5, axis_aligned_lattice(glm::ivec3(32), glm::dvec3(1.0), glm::dvec3(0.0)).lps_from_voxel};
  tests::Dense front(32), back(32);
  front.for_each([&](const glm::ivec3& v) {
    front.at(v) = v.y < 4;
    back.at(v) = v.y > 20;
  });
  DrawnObject red{"front", tests::octree_of(universe, front), {1, 0, 0}};
  const DrawnObject blue{"back", tests::octree_of(universe, back), {0, 0, 1}};
  RenderOptions options;
  options.size_px = {32, 32};
  const std::size_t middle = 16 * 32 + 16;
  const auto seen = [&](float opacity) {
    red.opacity = opacity;
    return render({red, blue}, options);
  };
  const Picture opaque = seen(1.0f), veil = seen(0.4f), hidden = seen(0.0f);
  EXPECT_EQ(opaque.object[middle], 0);
  EXPECT_EQ(veil.object[middle], 1);
  EXPECT_EQ(hidden.object[middle], 1);
  EXPECT_EQ(opaque.rgb[3 * middle + 2] < 30, true);
  EXPECT_GT(veil.rgb[3 * middle], 30);
  EXPECT_GT(veil.rgb[3 * middle + 2], 60);
  EXPECT_LT(hidden.rgb[3 * middle], 30);
  // Picking: the point under the pixel is on the back object's front face.
  const std::optional<glm::dvec3> point = hidden.point_mm({16, 16});
  ASSERT_TRUE(point);
  EXPECT_NEAR(point->y, 20.5, 1e-4);
}

}  // namespace
}  // namespace octotomy::voxel
