// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Isosurfaces beside those of VTK's flying edges on the same samples.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "brep/mesh/distance.h"
#include "convert/surface/isosurface.h"
#include "tests/bench/flat_scan.h"
#include "tests/bench/vtk_contour.h"
#include "verify/phantom/head_phantom.h"

namespace octotomy::convert {
namespace {

brep::Triangles of_vtk(const voxel::Scene& scene, double value) {
  const bench::VtkContour contour(bench::flat_scan(scene), value, 1);
  contour.triangles();
  const bench::FlatMesh flat = contour.surface();
  brep::Triangles surface;
  for (std::size_t i = 0; i < flat.points_mm.size(); i += 3)
    surface.points_mm.emplace_back(flat.points_mm[i], flat.points_mm[i + 1], flat.points_mm[i + 2]);
  for (std::size_t i = 0; i < flat.faces.size(); i += 3)
    surface.faces.push_back({flat.faces[i], flat.faces[i + 1], flat.faces[i + 2]});
  return surface;
}

/// Distances of the points of either surface from the other, ascending.
std::vector<double> between(const brep::Triangles& a, const brep::Triangles& b) {
  std::vector<double> all = brep::SurfaceTree(b).distances_mm(a.points_mm);
  const std::vector<double> back = brep::SurfaceTree(a).distances_mm(b.points_mm);
  all.insert(all.end(), back.begin(), back.end());
  std::sort(all.begin(), all.end());
  return all;
}

TEST(VtkSurface, OfABlurredBallIsTheSameToAHundredthOfAVoxelAndInTrianglesToTheLast) {
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice(glm::ivec3(64), glm::dvec3(0.8), glm::dvec3(-25.0, 3.0, 11.0));
  voxel::Int16Samples samples;
  for (int z = 0; z < 64; ++z)
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x)
        samples.push_back(static_cast<std::int16_t>(std::lround(
            300.0 + 500.0 * std::clamp(22.3 - std::hypot(x - 31.4, y - 31.7, z - 30.9), -2.0, 2.0))));
  scene.samples = std::move(samples);
  const brep::Triangles own = isosurface(scene, 300.0, std::numeric_limits<double>::infinity());
  const brep::Triangles vtk = of_vtk(scene, 300.0);
  EXPECT_EQ(own.faces.size(), vtk.faces.size());
  EXPECT_LE(between(own, vtk).back(), 0.01 * 0.8);
  // The comparison detects a level that is slightly off.
  EXPECT_GT(between(isosurface(scene, 320.0, std::numeric_limits<double>::infinity()), vtk).back(),
            0.01 * 0.8);
}

TEST(VtkSurface, OfAHeadIsTheSameToAHundredthOfAVoxelAndInTrianglesToTheLast) {
  verify::HeadOptions options;
  options.voxel_mm = 3.0;
  const voxel::Scene head = verify::head_phantom(options);
  const brep::Triangles own = isosurface(head, 300.0, std::numeric_limits<double>::infinity());
  const brep::Triangles vtk = of_vtk(head, 300.0);
  const std::vector<double> apart = between(own, vtk);
  ASSERT_GT(own.faces.size(), 10000U);
  EXPECT_EQ(own.faces.size(), vtk.faces.size());
  EXPECT_LE(apart.back(), 0.01 * 3.0);
}

}  // namespace
}  // namespace octotomy::convert
