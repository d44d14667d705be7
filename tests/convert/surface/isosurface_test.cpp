// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/surface/isosurface.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <random>
#include <tbb/global_control.h>
#include <thread>

#include "brep/boolean/boolean.h"
#include "brep/mesh/health.h"
#include "brep/shape/prism.h"
#include "tests/convert/surfaces.h"
#include "tests/reference_data.h"
#include "voxel/scan/read_scene.h"

namespace octotomy::convert {
namespace {

using tests::area_mm2;
using tests::fault_in_closedness;
using tests::volume_mm3;

constexpr double no_limit = std::numeric_limits<double>::infinity();

voxel::Scene scene_of(const voxel::Lattice& lattice, voxel::Int16Samples samples) {
  voxel::Scene scene;
  scene.lattice = lattice;
  scene.samples = std::move(samples);
  scene.source = "test";
  return scene;
}

voxel::Scene noise(const glm::ivec3& dims, unsigned seed, int part_inside_percent) {
  std::mt19937 random(seed);
  voxel::Int16Samples samples(static_cast<std::size_t>(dims.x * dims.y * dims.z));
  for (std::int16_t& sample : samples) {
    const int value = static_cast<int>(random() % 1000);
    sample = static_cast<std::int16_t>(static_cast<int>(random() % 100) < part_inside_percent ? 1000 + value
                                                                                              : value);
  }
  return scene_of(voxel::axis_aligned_lattice(dims, {1, 1, 1}, {0, 0, 0}), samples);
}

/// The share of each voxel of the lattice that a ball fills, by 8^3 points, as int16 from 0 to 1000.
voxel::Scene ball_scene(const voxel::Lattice& lattice, const glm::dvec3& centre_mm, double radius_mm) {
  constexpr int cuts = 8;
  voxel::Int16Samples samples;
  samples.reserve(lattice.sample_count());
  const double reach_mm = 0.5 * glm::length(lattice.spacing_mm()) * 1.8;  // sheared voxels reach further
  for (int z = 0; z < lattice.dims.z; ++z)
    for (int y = 0; y < lattice.dims.y; ++y)
      for (int x = 0; x < lattice.dims.x; ++x) {
        const double distance = glm::length(lattice.lps_mm({x, y, z}) - centre_mm);
        int inside = 0;
        if (distance < radius_mm - reach_mm) {
          inside = cuts * cuts * cuts;
        } else if (distance < radius_mm + reach_mm) {
          for (int i = 0; i < cuts * cuts * cuts; ++i) {
            const glm::dvec3 part(i % cuts, i / cuts % cuts, i / (cuts * cuts));
            const glm::dvec3 p = lattice.lps_mm(glm::dvec3(x, y, z) - 0.5 + (part + 0.5) / double(cuts));
            if (glm::length(p - centre_mm) <= radius_mm) ++inside;
          }
        }
        samples.push_back(static_cast<std::int16_t>(std::lround(1000.0 * inside / (cuts * cuts * cuts))));
      }
  return scene_of(lattice, samples);
}

/// A cubic lattice that a ball about the origin's neighbourhood fits, of `voxels` voxels a radius.
voxel::Lattice lattice_for_ball(double radius_mm, int voxels, double aspect_z = 1.0) {
  const double h = radius_mm / voxels;
  const int n = 2 * voxels + 6;
  const int nz = static_cast<int>(n / aspect_z) + 2;
  return voxel::axis_aligned_lattice(
      {n, n, nz}, {h, h, h * aspect_z},
      {-0.5 * (n - 1) * h, -0.5 * (n - 1) * h, -0.5 * (nz - 1) * h * aspect_z});
}

struct BallErrors {
  double volume = 0.0;  ///< relative
  double area = 0.0;
};
BallErrors errors_of(const voxel::Scene& scene, double radius_mm) {
  const brep::Triangles surface = isosurface(scene, 500, no_limit);
  EXPECT_EQ(fault_in_closedness(surface), std::nullopt);
  const double volume = 4.0 / 3.0 * std::numbers::pi * std::pow(radius_mm, 3);
  const double area = 4.0 * std::numbers::pi * radius_mm * radius_mm;
  return {volume_mm3(surface) / volume - 1.0, area_mm2(surface) / area - 1.0};
}

/// A centre off the lattice's symmetry, so that no errors cancel.
glm::dvec3 ball_centre_mm(const voxel::Lattice& lattice) {
  return glm::dvec3(0.13, 0.29, -0.21) * lattice.spacing_mm().x;
}

BallErrors partial_volume_errors(const voxel::Lattice& lattice, double radius_mm) {
  return errors_of(ball_scene(lattice, ball_centre_mm(lattice), radius_mm), radius_mm);
}

/// The samples fall linearly with the distance from the centre, so only the triangles' own error remains.
BallErrors distance_errors(const voxel::Lattice& lattice, double radius_mm) {
  voxel::FloatSamples samples;
  for (int z = 0; z < lattice.dims.z; ++z)
    for (int y = 0; y < lattice.dims.y; ++y)
      for (int x = 0; x < lattice.dims.x; ++x)
        samples.push_back(static_cast<float>(
            500.0 + 100.0 * (radius_mm - glm::length(lattice.lps_mm({x, y, z}) - ball_centre_mm(lattice)))));
  voxel::Scene scene;
  scene.lattice = lattice;
  scene.samples = std::move(samples);
  return errors_of(scene, radius_mm);
}

TEST(Isosurface, OfWhiteNoiseIsClosedManifoldAndOriented) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    const glm::ivec3 dims(3 + seed % 7, 4 + seed % 5, 2 + seed % 11);
    const brep::Triangles surface =
        isosurface(noise(dims, seed, 10 + 3 * static_cast<int>(seed)), 1000, no_limit);
    ASSERT_GT(surface.faces.size(), 0U);
    EXPECT_EQ(fault_in_closedness(surface), std::nullopt) << "seed " << seed;
    EXPECT_GT(volume_mm3(surface), 0.0) << "seed " << seed;
  }
}

TEST(Isosurface, AcrossWordsOfBitsIsClosedToo) {
  for (const int nx : {62, 63, 64, 65, 126, 127, 128, 130}) {
    const brep::Triangles surface =
        isosurface(noise({nx, 5, 4}, static_cast<unsigned>(nx), 50), 1000, no_limit);
    EXPECT_EQ(fault_in_closedness(surface), std::nullopt) << nx << " samples a row";
  }
}

TEST(Isosurface, TheProofOfClosednessSeesALostAndAFlippedTriangle) {
  brep::Triangles surface = isosurface(noise({6, 6, 6}, 1, 50), 1000, no_limit);
  brep::Triangles lost = surface;
  lost.faces.pop_back();
  EXPECT_NE(fault_in_closedness(lost), std::nullopt);
  std::swap(surface.faces[7][0], surface.faces[7][1]);
  EXPECT_NE(fault_in_closedness(surface), std::nullopt);
}

TEST(Isosurface, OfNoiseDoesNotIntersectItself) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    voxel::Scene scene = noise({14, 13, 12}, seed, 30 + 12 * static_cast<int>(seed));
    if (seed == 3)
      scene.lattice.lps_from_voxel = glm::rotate(glm::dmat4(1.0), 0.7, glm::dvec3(1, 2, 3)) *
                                     glm::scale(glm::dmat4(1.0), {0.7, 0.9, 2.5});
    const brep::Health health = brep::health(brep::mesh_of(isosurface(scene, 1000, no_limit)));
    EXPECT_GT(health.faces, 1000U);
    EXPECT_EQ(health.self_intersections, 0U) << "seed " << seed;
    EXPECT_EQ(health.degenerate_faces, 0U) << "seed " << seed;
    EXPECT_TRUE(health.closed && health.manifold) << "seed " << seed;
  }
}

TEST(Isosurface, StaysApartAsFarFromTheOriginAsItSays) {
  // Samples on the bound, and others so far below it that crossings lie as close to samples as they may.
  voxel::Scene scene = noise({20, 19, 18}, 5, 50);
  for (std::int16_t& sample : std::get<voxel::Int16Samples>(scene.samples))
    sample = sample >= 1000 ? 1000 : -30000;
  const glm::dmat4 sheared = glm::rotate(glm::dmat4(1.0), 0.7, glm::dvec3(1, 2, 3)) *
                             glm::dmat4({0.2, 0, 0, 0}, {0.1, 0.3, 0, 0}, {0.1, -0.1, 0.9, 0}, {0, 0, 0, 1});
  for (const glm::dmat4& axes : {glm::scale(glm::dmat4(1.0), glm::dvec3(0.2)), sheared}) {
    scene.lattice.lps_from_voxel = axes;
    scene.lattice.lps_from_voxel[3] = {9000.0, -7000.0, 5000.0, 1.0};
    ASSERT_TRUE(stays_apart(scene.lattice));
    const brep::Health health = brep::health(isosurface(scene, 1000, no_limit));
    EXPECT_GT(health.faces, 5000U);
    EXPECT_EQ(health.self_intersections, 0U);
    EXPECT_EQ(health.degenerate_faces, 0U);
    scene.lattice.lps_from_voxel[3].x = 14000.0;
    EXPECT_FALSE(stays_apart(scene.lattice));
  }
  // The case for which the bound exists: doubles are a quarter of a millimetre apart here.
  scene.lattice.lps_from_voxel[3].x = 0x1p51;
  EXPECT_FALSE(stays_apart(scene.lattice));
  EXPECT_GT(brep::health(isosurface(scene, 1000, no_limit)).self_intersections, 0U);
}

// Triangles with their points on a sphere of r voxels lie within it by 0.2 / r of a voxel on average, so
// volume is 0.6 / r^2 low, area 0.31 / r^2.
TEST(Isosurface, VolumeAndAreaOfADistanceFieldConvergeAtSecondOrder) {
  const BallErrors coarse = distance_errors(lattice_for_ball(12.0, 12), 12.0);
  const BallErrors fine = distance_errors(lattice_for_ball(12.0, 24), 12.0);
  EXPECT_NEAR(fine.volume * 24 * 24, -0.60, 0.02);
  EXPECT_NEAR(fine.area * 24 * 24, -0.31, 0.02);
  EXPECT_NEAR(coarse.volume / fine.volume, 4.0, 0.1);
  EXPECT_NEAR(coarse.area / fine.area, 4.0, 0.2);
}

// A voxel's mean over a curved surface is low by a 24th of its mean curvature, which adds 1/4 / r^2 to the
// loss of volume: the order stays. Area does not converge: the mean of a voxel that an oblique plane cuts is
// not linear in the plane's place, so crossings lie off the plane by a part of a voxel that is the same at
// every resolution, and the ripple makes a sphere's area 0.4 % too large.
TEST(Isosurface, VolumeOfPartialVolumeSamplesConvergesAtSecondOrderAndAreaToFourPerMille) {
  const BallErrors coarse = partial_volume_errors(lattice_for_ball(12.0, 12), 12.0);
  const BallErrors fine = partial_volume_errors(lattice_for_ball(12.0, 24), 12.0);
  EXPECT_NEAR(fine.volume * 24 * 24, -0.82, 0.03);
  EXPECT_NEAR(coarse.volume / fine.volume, 4.0, 0.15);
  EXPECT_LT(std::abs(coarse.area), 0.005);
  EXPECT_LT(std::abs(fine.area), 0.005);
  EXPECT_NEAR(fine.area + 0.31 / (24 * 24), 0.0038, 0.0005);
}

TEST(Isosurface, OfABallInThickSlicesKeepsVolumeAndArea) {
  const BallErrors errors = partial_volume_errors(lattice_for_ball(24.0, 24, 2.0), 24.0);
  // Along z the voxel's edge is twice as long: a third of the second-order terms is four times as large.
  EXPECT_NEAR(errors.volume * 24 * 24, -0.82 * (2.0 + 4.0) / 3.0, 0.2);
  EXPECT_LT(std::abs(errors.area), 0.01);
}

TEST(Isosurface, OfABallOnAnObliqueLatticeKeepsVolumeAndArea) {
  voxel::Lattice lattice = lattice_for_ball(24.0, 24);
  lattice.lps_from_voxel =
      glm::rotate(glm::dmat4(1.0), 0.5, glm::normalize(glm::dvec3(1, 2, 3))) * lattice.lps_from_voxel;
  const BallErrors errors = partial_volume_errors(lattice, 24.0);
  EXPECT_NEAR(errors.volume * 24 * 24, -0.82, 0.03);
  EXPECT_LT(std::abs(errors.area), 0.005);
}

TEST(Isosurface, OfATiltedGantrysShearedLatticeKeepsTheVolume) {
  voxel::Lattice lattice = lattice_for_ball(12.0, 12);
  lattice.lps_from_voxel[2].y += 0.3;
  lattice.lps_from_voxel[3].y -= 0.3 * 0.5 * (lattice.dims.z - 1);
  lattice.dims.y += 10;
  lattice.lps_from_voxel[3].y -= 5.0;
  const BallErrors errors = partial_volume_errors(lattice, 12.0);
  EXPECT_LT(std::abs(errors.volume), 0.006);
}

TEST(Isosurface, OnAMirrorImageLatticeStillTurnsOutward) {
  const voxel::Scene scene = noise({7, 8, 9}, 5, 50);
  voxel::Scene mirrored = scene;
  mirrored.lattice.lps_from_voxel[1][1] = -1.0;
  ASSERT_FALSE(mirrored.lattice.right_handed());
  const brep::Triangles surface = isosurface(scene, 1000, no_limit);
  const brep::Triangles image = isosurface(mirrored, 1000, no_limit);
  EXPECT_EQ(fault_in_closedness(image), std::nullopt);
  EXPECT_GT(volume_mm3(image), 0.0);
  EXPECT_NEAR(volume_mm3(image), volume_mm3(surface), 1e-10 * volume_mm3(surface));
}

TEST(Isosurface, BothBoundsOfTheWindowAreInsideAndCrossingsLieAtTheBoundThatIsCrossed) {
  // One row of samples, 10 apart: inside from 20 to 50, so four samples.
  const voxel::Scene scene =
      scene_of(voxel::axis_aligned_lattice({8, 1, 1}, {1, 1, 1}, {0, 0, 0}), {0, 10, 20, 30, 40, 50, 60, 70});
  const auto ends = [&](double low, double high) {
    glm::dvec2 x(1e9, -1e9);
    for (const glm::dvec3& p : isosurface(scene, low, high).points_mm) {
      x[0] = std::min(x[0], p.x);
      x[1] = std::max(x[1], p.x);
    }
    return x;
  };
  EXPECT_DOUBLE_EQ(ends(15, 55)[0], 1.5);
  EXPECT_DOUBLE_EQ(ends(15, 55)[1], 5.5);
  EXPECT_DOUBLE_EQ(ends(12.5, 52.5)[0], 1.25);
  EXPECT_DOUBLE_EQ(ends(12.5, 52.5)[1], 5.25);
  // A sample equal to a bound is inside, and the surface keeps its small distance from it, on the outside.
  EXPECT_LT(ends(20, 50)[0], 2.0);
  EXPECT_GT(ends(20, 50)[0], 1.998);
  EXPECT_GT(ends(20, 50)[1], 5.0);
  EXPECT_LT(ends(20, 50)[1], 5.002);
}

TEST(Isosurface, AnObjectThatReachesTheScansBorderIsClosedHalfAVoxelBeyondIt) {
  const voxel::Lattice lattice = voxel::axis_aligned_lattice({5, 4, 3}, {1.0, 0.5, 2.0}, {10, 20, 30});
  const brep::Triangles surface =
      isosurface(scene_of(lattice, voxel::Int16Samples(lattice.sample_count(), 100)), 50, 200);
  EXPECT_EQ(fault_in_closedness(surface), std::nullopt);
  const voxel::Box box = voxel::bounds(lattice);
  glm::dvec3 low(1e9);
  glm::dvec3 high(-1e9);
  for (const glm::dvec3& p : surface.points_mm) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  EXPECT_EQ(low, box.low_mm);
  EXPECT_EQ(high, box.high_mm);
  // In voxels: the box minus an eighth per unit of edge, minus what the eight corners lose in addition (1/2 -
  // 1/48 - ...).
  const double edges = 4.0 * ((5 - 1) + (4 - 1) + (3 - 1));
  const double voxels = 5.0 * 4.0 * 3.0 - edges / 8.0 - 8.0 * (1.0 / 8.0 - 1.0 / 48.0);
  EXPECT_NEAR(volume_mm3(surface), voxels * lattice.voxel_mm3(), 1e-10);
}

TEST(Isosurface, OfASingleSampleIsAnOctahedron) {
  const brep::Triangles surface =
      isosurface(scene_of(voxel::axis_aligned_lattice({1, 1, 1}, {1, 1, 1}, {0, 0, 0}), {7}), 7, 7);
  EXPECT_EQ(surface.points_mm.size(), 6U);
  EXPECT_EQ(surface.faces.size(), 8U);
  EXPECT_NEAR(volume_mm3(surface), 1.0 / 6.0, 1e-15);
}

TEST(Isosurface, OfNothingInsideIsEmpty) {
  const voxel::Scene scene = noise({4, 4, 4}, 1, 50);
  EXPECT_TRUE(isosurface(scene, 3000, no_limit).faces.empty());
  EXPECT_TRUE(isosurface(scene, 500, 400).faces.empty());
  EXPECT_TRUE(isosurface(scene, 40000, 50000).points_mm.empty());
}

TEST(Isosurface, SamplesThatAreNoNumbersAreOutside) {
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice({3, 3, 3}, {1, 1, 1}, {0, 0, 0});
  voxel::FloatSamples samples(27, std::numeric_limits<float>::quiet_NaN());
  samples[13] = 1.0F;
  samples[12] = -std::numeric_limits<float>::infinity();
  scene.samples = samples;
  const brep::Triangles surface = isosurface(scene, 0.5, no_limit);
  EXPECT_EQ(fault_in_closedness(surface), std::nullopt);
  EXPECT_EQ(surface.faces.size(), 8U);
  for (const glm::dvec3& p : surface.points_mm) EXPECT_TRUE(std::isfinite(p.x + p.y + p.z));
}

TEST(Isosurface, ABoundThatIsNoNumberIsRefused) {
  EXPECT_THROW(isosurface(noise({2, 2, 2}, 1, 50), std::nan(""), 1.0), std::invalid_argument);
}

TEST(Isosurface, IntegerAndFloatSamplesOfOneScanGiveTheSameSurface) {
  const voxel::Scene integers = noise({9, 8, 7}, 11, 50);
  voxel::Scene floats = integers;
  const auto& samples = std::get<voxel::Int16Samples>(integers.samples);
  floats.samples = voxel::FloatSamples(samples.begin(), samples.end());
  const brep::Triangles a = isosurface(integers, 999.5, 1700.25);
  const brep::Triangles b = isosurface(floats, 999.5, 1700.25);
  EXPECT_EQ(a.faces, b.faces);
  EXPECT_EQ(a.points_mm, b.points_mm);
}

TEST(Isosurface, OfAGreyOctreeHasTheBitsOfItsSamplesScene) {
  for (const int depth : {2, 4, 5, 6}) {
    const int side = 1 << depth;
    voxel::Scene scene = noise(glm::ivec3(side), 17, 30);
    voxel::Universe universe;
    universe.depth = depth;
    const voxel::GreyOctree grey = voxel::grey_octree_of(universe, scene);
    const brep::Triangles of_scene = isosurface(scene, 1000, no_limit);
    const brep::Triangles of_octree = isosurface(grey, 1000, no_limit);
    EXPECT_EQ(of_octree.faces, of_scene.faces) << "depth " << depth;
    EXPECT_EQ(of_octree.points_mm, of_scene.points_mm) << "depth " << depth;
    EXPECT_GT(of_octree.faces.size(), 0U);
  }
}

TEST(Isosurface, OfAGreyOctreesAirClosesWithTheScanAsThatOfItsSceneDoes) {
  voxel::Universe universe;
  universe.depth = 6;
  voxel::Scene scene = noise({37, 40, 21}, 5, 30);
  const auto reversed = [](std::int16_t value) { return static_cast<std::int16_t>(-value); };
  auto& samples = std::get<voxel::Int16Samples>(scene.samples);
  std::transform(samples.begin(), samples.end(), samples.begin(), reversed);
  const double high = -600.0;
  const voxel::GreyOctree grey = voxel::grey_octree_of(universe, scene, -2000);
  const brep::Triangles of_scene = isosurface(scene, -no_limit, high);
  const brep::Triangles of_octree = isosurface(grey, -no_limit, high);
  EXPECT_NEAR(volume_mm3(of_octree), volume_mm3(of_scene), 1e-9 * volume_mm3(of_scene));
  EXPECT_EQ(of_octree.faces.size(), of_scene.faces.size());
  EXPECT_LT(volume_mm3(of_octree), 37.0 * 40 * 21);
}

TEST(Isosurface, HasTheSameBitsOnOneThreadAndMany) {
  const voxel::Scene scene = noise({40, 30, 20}, 3, 50);
  const brep::Triangles many = isosurface(scene, 1000, no_limit);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const brep::Triangles single = isosurface(scene, 1000, no_limit);
  ASSERT_EQ(many.points_mm.size(), single.points_mm.size());
  EXPECT_EQ(many.faces, single.faces);
  EXPECT_EQ(0, std::memcmp(many.points_mm.data(), single.points_mm.data(),
                           many.points_mm.size() * sizeof(glm::dvec3)));
}

/// Corefinement computes a point on several edges from the pair of triangles that it finds first.
TEST(Isosurface, OfARealSkullIsCutToTheSameBitsWhereverMemoryLies) {
  OCTOTOMY_NEEDS_DATA("ct_unc_cthead.nrrd");
  const brep::Solid skull = brep::trusted_solid(
      isosurface(voxel::read_scene(tests::reference_data("ct_unc_cthead.nrrd")), 300.0, 1e9),
      brep::Proof::Construction);
  const glm::dvec3 middle = 0.5 * (skull.size().low_mm + skull.size().high_mm);
  const auto prism = [&](const glm::dvec3& look, const glm::dvec3& right, double low, double high) {
    brep::Prism drawn{look, {0, 0, 1}, right, {{{low, -40}, {high, -40}, {high, -5}, {low, -5}}}, -700, 700};
    for (glm::dvec2& p : drawn.polygons_mm.front()) p += glm::dvec2(glm::dot(middle, right), middle.z);
    return brep::solid_of(drawn);
  };
  const brep::Solid cut = brep::boolean(prism({0, 1, 0}, {1, 0, 0}, -40, 40), brep::Operation::Intersection,
                                        prism({-1, 0, 0}, {0, 1, 0}, -90, -20))
                              .solid;
  std::mt19937 random(1);
  std::optional<brep::Triangles> first;
  for (int i = 0; i < 8; ++i) {
    std::vector<std::unique_ptr<char[]>> held;
    for (int k = 0; k < 300; ++k) held.push_back(std::make_unique<char[]>(std::size_t{1} << random() % 22));
    for (auto& block : held)
      if (random() % 2 == 0) block.reset();
    brep::Triangles piece;
    const auto take = [&] {
      piece = brep::boolean(skull, brep::Operation::Intersection, cut).solid.triangles();
    };
    // Another thread uses another heap.
    if (i % 2 == 0)
      take();
    else
      std::thread(take).join();
    if (!first) first = piece;
    ASSERT_EQ(piece.points_mm, first->points_mm) << "in round " << i;
    ASSERT_EQ(piece.faces, first->faces) << "in round " << i;
  }
}

}  // namespace
}  // namespace octotomy::convert
