// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/surface/label_surfaces.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <tbb/global_control.h>

#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "tests/convert/surfaces.h"
#include "voxel/filter/label_map.h"

namespace octotomy::convert {
namespace {

using tests::area_mm2;
using tests::fault_in_closedness;
using tests::volume_mm3;

voxel::Scene labels_on(const voxel::Lattice& lattice, const std::function<int(const glm::ivec3&)>& label) {
  voxel::Scene scene;
  scene.lattice = lattice;
  scene.source = "labels";
  voxel::Int16Samples samples;
  for (int z = 0; z < lattice.dims.z; ++z)
    for (int y = 0; y < lattice.dims.y; ++y)
      for (int x = 0; x < lattice.dims.x; ++x) samples.push_back(static_cast<std::int16_t>(label({x, y, z})));
  scene.samples = std::move(samples);
  return scene;
}

voxel::Lattice cube_of(int side) {
  return voxel::axis_aligned_lattice(glm::ivec3(side), glm::dvec3(1.0), glm::dvec3(0.0));
}

voxel::Scene noise(int side, int count, unsigned seed) {
  std::mt19937 random(seed);
  return labels_on(cube_of(side), [&](const glm::ivec3&) {
    return static_cast<int>(random() % static_cast<unsigned>(count));
  });
}

/// A ball in three sectors about the x axis, in a shell.
voxel::Scene three_in_a_shell(int side) {
  const double middle = 0.5 * (side - 1), radius = 0.3 * side;
  return labels_on(cube_of(side), [=](const glm::ivec3& p) {
    const glm::dvec3 from = glm::dvec3(p) - middle;
    if (glm::length(from) > 1.25 * radius) return 0;
    if (glm::length(from) > radius) return 9;
    const double turn = std::atan2(from.z + 0.3, from.y + 0.2) / std::numbers::pi;
    return turn < -1.0 / 3.0 ? 1 : turn < 1.0 / 3.0 ? 2 : 3;
  });
}

/// The reason why the surfaces do not divide space; empty if they do.
std::string fault_in(const brep::PartedSurface& parted) {
  double sum_mm3 = 0.0;
  for (const auto& [part, unused] : parted.names) {
    const brep::Triangles surface = brep::surface_of_part(parted, part);
    const std::string which = "part " + std::to_string(part) + ": ";
    if (const auto fault = fault_in_closedness(surface)) return which + *fault;
    const brep::Health health = brep::health(surface);
    if (!health.solid()) return which + health.findings.front();
    sum_mm3 += volume_mm3(surface);
  }
  // Triangles with nothing on one side bound all parts together.
  brep::PartedSurface whole = parted;
  for (auto& [behind, front] : whole.sides) {
    behind = behind == 0 ? 0 : 1;
    front = front == 0 ? 0 : 1;
  }
  std::vector<std::array<std::uint32_t, 3>> faces;
  for (std::size_t f = 0; f < whole.sides.size(); ++f)
    if (whole.sides[f].front == 0) faces.push_back(parted.triangles.faces[f]);
  const double whole_mm3 = volume_mm3({parted.triangles.points_mm, faces});
  // Far from the origin a triangle's share of a volume loses digits.
  if (std::abs(sum_mm3 - whole_mm3) > 1e-7 * whole_mm3)
    return "the parts have " + std::to_string(sum_mm3) + " mm3, all together " + std::to_string(whole_mm3);
  return {};
}

TEST(LabelSurfaces, AreSolidsThatFillTheWholeForAnyNoise) {
  for (unsigned seed = 0; seed < 12; ++seed)
    for (const int count : {2, 3, 5, 40})
      for (const int smooth : {0, 1, 2}) {
        LabelSurfaceOptions options;
        options.smooth_voxels = smooth;
        EXPECT_EQ(fault_in(label_surfaces(noise(6, count, seed), options)), "")
            << count << " labels, seed " << seed << ", smooth " << smooth;
      }
}

TEST(LabelSurfaces, CommonFacesAreTheSameFromBothSides) {
  const brep::PartedSurface parted = label_surfaces(three_in_a_shell(24));
  ASSERT_EQ(fault_in(parted), "");
  std::map<std::pair<int, int>, double> contact_mm2;
  for (std::size_t f = 0; f < parted.sides.size(); ++f) {
    const auto& [behind, front] = parted.sides[f];
    EXPECT_TRUE(front == 0 || behind < front);
    EXPECT_NE(behind, 0);
    contact_mm2[{behind, front}] += area_mm2({parted.triangles.points_mm, {parted.triangles.faces[f]}});
  }
  const double radius = 0.3 * 24;
  for (const auto& pair : {std::pair{1, 2}, {2, 3}, {1, 3}})
    EXPECT_NEAR(contact_mm2.at(pair), 0.5 * std::numbers::pi * radius * radius, 0.25 * radius * radius);
  EXPECT_FALSE(contact_mm2.contains({1, 0})) << "the shell lies between";
  double inner_mm2 = 0.0, of_shell_mm2 = 0.0;
  for (const int part : {1, 2, 3}) inner_mm2 += contact_mm2.at({part, 9});
  of_shell_mm2 = area_mm2(brep::surface_of_part(parted, 9)) - contact_mm2.at({9, 0});
  EXPECT_NEAR(inner_mm2, of_shell_mm2, 1e-9 * inner_mm2);
}

TEST(LabelSurfaces, OfABallHaveItsVolumeAndNearlyItsArea) {
  for (const int side : {32, 64}) {
    const double middle = 0.5 * (side - 1) + 0.2, radius = 0.35 * side;
    const voxel::Scene scene = labels_on(cube_of(side), [&](const glm::ivec3& p) {
      return glm::distance(glm::dvec3(p), glm::dvec3(middle)) <= radius ? 5 : 0;
    });
    const auto samples = static_cast<double>(voxel::labels(scene).front().samples);
    const auto area = [&](int smooth) {
      LabelSurfaceOptions options;
      options.smooth_voxels = smooth;
      const brep::Triangles surface = brep::surface_of_part(label_surfaces(scene, options), 5);
      // Binomial weights of s rounds have the variance s / 2 along an axis, and draw a sphere in by that over
      // its radius.
      EXPECT_NEAR(volume_mm3(surface), samples, (1.5 * smooth / (radius * radius) + 0.006) * samples)
          << smooth;
      return area_mm2(surface) / (4.0 * std::numbers::pi * radius * radius);
    };
    for (const int smooth : {1, 2, 3}) EXPECT_NEAR(area(smooth), 1.0, 0.02) << side << ", smooth " << smooth;
    EXPECT_GT(area(0), 1.05) << "unsmoothed, steps of voxels show";
  }
}

TEST(LabelSurfaces, FollowTheLatticeAndCloseAtItsBorder) {
  voxel::Lattice lattice = cube_of(5);
  const voxel::Scene full = labels_on(lattice, [](const glm::ivec3& p) { return p.x < 2 ? 1 : 2; });
  const brep::PartedSurface straight = label_surfaces(full);
  const double first_mm3 = volume_mm3(brep::surface_of_part(straight, 1)),
               second_mm3 = volume_mm3(brep::surface_of_part(straight, 2));
  EXPECT_NEAR(first_mm3 + second_mm3, 125.0, 12.0) << "corners are cut";
  EXPECT_LT(first_mm3, second_mm3);
  // Turned, mirrored, of other spacings and far away: the same volumes by the lattice's determinant.
  lattice.lps_from_voxel = glm::translate(glm::dmat4(1.0), glm::dvec3(1000, -2000, 300)) *
                           glm::rotate(glm::dmat4(1.0), 0.7, glm::normalize(glm::dvec3(1, 2, 3))) *
                           glm::scale(glm::dmat4(1.0), glm::dvec3(0.5, 2.0, -1.5));
  voxel::Scene mirrored = full;
  mirrored.lattice = lattice;
  const brep::PartedSurface parted = label_surfaces(mirrored);
  ASSERT_EQ(parted.triangles.faces.size(), straight.triangles.faces.size());
  for (const int part : {1, 2})
    EXPECT_NEAR(brep::volume_mm3(brep::mesh_of(brep::surface_of_part(parted, part))),
                1.5 * volume_mm3(brep::surface_of_part(straight, part)), 1e-6);
  EXPECT_EQ(fault_in(parted), "");
}

TEST(LabelSurfaces, OtherLabelsAreNothingAndThoseThatAreMissingAreRefused) {
  const voxel::Scene scene = three_in_a_shell(16);
  LabelSurfaceOptions options;
  options.labels = {2, 9};
  const brep::PartedSurface parted = label_surfaces(scene, options);
  EXPECT_EQ(parted.names.size(), 2u);
  EXPECT_EQ(fault_in(parted), "");
  options.labels = {2, 4};
  EXPECT_THROW(label_surfaces(scene, options), voxel::Error);
  EXPECT_THROW(label_surfaces(labels_on(cube_of(4), [](const glm::ivec3&) { return -3; })),
               std::invalid_argument);
  options.smooth_voxels = 5;
  EXPECT_THROW(label_surfaces(scene, options), std::invalid_argument);
  EXPECT_TRUE(
      label_surfaces(labels_on(cube_of(4), [](const glm::ivec3&) { return 0; })).triangles.faces.empty());
}

TEST(LabelSurfaces, OfLabelsThatOverlapOrAreNoSixteenBitsAreEachWhole) {
  const auto in = [](const glm::ivec3& p, int low, int high) {
    return glm::all(glm::greaterThanEqual(p, glm::ivec3(low))) &&
           glm::all(glm::lessThan(p, glm::ivec3(high)));
  };
  voxel::Scene both = labels_on(
      cube_of(12), [&](const glm::ivec3& p) { return (in(p, 2, 7) ? 1 : 0) + (in(p, 5, 10) ? 2 : 0); });
  both.overlaps = {{3, {1, 2}}};
  LabelSurfaceOptions options;
  options.smooth_voxels = 0;
  const brep::PartedSurface parted = label_surfaces(both, options);
  ASSERT_EQ(parted.names.size(), 2u);
  const double alone_mm3 = volume_mm3(brep::surface_of_part(
      label_surfaces(labels_on(cube_of(12), [&](const glm::ivec3& p) { return in(p, 2, 7) ? 1 : 0; }),
                     options),
      1));
  for (const int part : {1, 2})
    EXPECT_NEAR(volume_mm3(brep::surface_of_part(parted, part)), alone_mm3, 1e-9) << part;
  options.labels = {2};
  EXPECT_EQ(label_surfaces(both, options).names.size(), 1u);
  options.labels = {3};
  EXPECT_THROW(label_surfaces(both, options), voxel::Error) << "a number of an overlap is no label";
  voxel::Scene large = both;
  large.overlaps.clear();
  voxel::FloatSamples samples;
  for (const std::int16_t label : std::get<voxel::Int16Samples>(both.samples))
    samples.push_back(label == 1 ? 2.9999F : label == 2 ? 70000.0F : 0.0F);
  large.samples = samples;
  const brep::PartedSurface named = label_surfaces(large);
  EXPECT_TRUE(named.names.contains(3));
  EXPECT_TRUE(named.names.contains(70000));
  EXPECT_EQ(fault_in(named), "");
}

TEST(LabelSurfaces, AreTheSameBitsOnOneThread) {
  const voxel::Scene scene = noise(20, 6, 3);
  const brep::PartedSurface many = label_surfaces(scene);
  const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
  const brep::PartedSurface one = label_surfaces(scene);
  EXPECT_EQ(one.triangles.points_mm, many.triangles.points_mm);
  EXPECT_EQ(one.triangles.faces, many.triangles.faces);
}

TEST(LabelSurfaces, ASpoiledSideIsSeen) {
  brep::PartedSurface parted = label_surfaces(three_in_a_shell(16));
  ASSERT_EQ(fault_in(parted), "");
  const auto between = std::find_if(parted.sides.begin(), parted.sides.end(),
                                    [](const auto& sides) { return sides.front == 9; });
  ASSERT_NE(between, parted.sides.end());
  between->front = 0;
  EXPECT_NE(fault_in(parted), "");
}

}  // namespace
}  // namespace octotomy::convert
