// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/region_tetrahedra.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "convert/deck/deck.h"
#include "tests/unit_universe.h"
#include "voxel/solid/combine.h"

namespace octotomy::convert {
namespace {

using voxel::Expression;

voxel::Octree ball(double radius, const glm::dvec3& centre = glm::dvec3(15.5)) {
  return voxel::combine(tests::unit_universe(5), Expression(voxel::Sphere{centre, radius}));
}
voxel::Octree left_half() {
  return voxel::combine(tests::unit_universe(5),
                        Expression(voxel::Box{{-1.0, -1.0, -1.0}, {15.5, 32.0, 32.0}}));
}

double volume_mm3(const Tetrahedra& t, std::uint32_t region) {
  double six = 0.0;
  for (std::size_t i = 0; i < t.tets.size(); ++i)
    if (t.region_of_tet[i] == region) six += six_volumes(corners_mm(t, i));
  return six / 6.0;
}

double area_mm2(const Tetrahedra& t, const std::vector<ElementFace>& faces) {
  double twice = 0.0;
  for (const ElementFace& face : faces) {
    const auto [a, b, c] = corners_of(t, face);
    twice += glm::length(glm::cross(t.nodes_mm[b] - t.nodes_mm[a], t.nodes_mm[c] - t.nodes_mm[a]));
  }
  return twice / 2.0;
}

TEST(RegionTetrahedra, ACoreAndItsShellAreSmoothShareTheirNodesAndHaveNoFlatElement) {
  // The core belongs to the first region, the rest of the ball to the second.
  const Tetrahedra t = smooth_tetrahedra_of({ball(7.0), ball(12.0)});
  const double core_mm3 = 4.0 / 3.0 * M_PI * std::pow(7.0, 3),
               whole_mm3 = 4.0 / 3.0 * M_PI * std::pow(12.0, 3);
  EXPECT_NEAR(volume_mm3(t, 0), core_mm3, 0.03 * core_mm3);
  EXPECT_NEAR(volume_mm3(t, 1), whole_mm3 - core_mm3, 0.03 * whole_mm3);
  EXPECT_GT(quality(t).min_dihedral_deg, 5.0);
  EXPECT_GT(quality(t).min_volume_mm3, 0.0);
  const std::vector<Interface> between = interfaces(t);
  ASSERT_EQ(between.size(), 1u) << "nodes are shared, or there would be no common face";
  // Voxels' faces would have half as much area again as the ball.
  EXPECT_NEAR(area_mm2(t, between[0].faces), 4.0 * M_PI * 49.0, 0.08 * 4.0 * M_PI * 49.0);
  EXPECT_NEAR(area_mm2(t, surface_faces(t)), 4.0 * M_PI * 144.0, 0.08 * 4.0 * M_PI * 144.0);
  for (const std::uint32_t v : t.boundary_nodes)
    EXPECT_NEAR(glm::distance(t.nodes_mm[v], glm::dvec3(15.5)), 12.0, 0.7) << "those of the outside alone";
  EXPECT_EQ(t.findings.size(), 2u);
}

TEST(RegionTetrahedra, ACutBetweenTwoPiecesIsADisc) {
  const Tetrahedra t = smooth_tetrahedra_of(
      {voxel::combine(tests::unit_universe(5), Expression(ball(10.0)) & Expression(left_half())),
       ball(10.0)});
  const std::vector<Interface> between = interfaces(t);
  ASSERT_EQ(between.size(), 1u);
  EXPECT_NEAR(area_mm2(t, between[0].faces), M_PI * 100.0, 0.06 * M_PI * 100.0);
  EXPECT_NEAR(volume_mm3(t, 0), volume_mm3(t, 1), 0.02 * volume_mm3(t, 0));
  EXPECT_GT(quality(t).min_dihedral_deg, 5.0);
}

/// Distances of an interface's nodes from the plane of a cut.
std::vector<double> off_plane_mm(const Tetrahedra& t, const glm::dvec3& on_mm, const glm::dvec3& normal) {
  std::vector<std::uint32_t> nodes;
  for (const Interface& between : interfaces(t))
    for (const ElementFace& face : between.faces)
      for (const std::uint32_t v : corners_of(t, face)) nodes.push_back(v);
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  std::vector<double> off_mm;
  for (const std::uint32_t v : nodes) off_mm.push_back(std::abs(glm::dot(t.nodes_mm[v] - on_mm, normal)));
  return off_mm;
}

TEST(RegionTetrahedra, AnObliqueCutBetweenTwoPiecesIsFlat) {
  const glm::dvec3 normal = glm::normalize(glm::dvec3(0.3, -0.2, 1.0)), on_mm(15.3);
  const voxel::Octree whole = ball(9.0, on_mm);
  const voxel::Octree half = voxel::combine(
      tests::unit_universe(5),
      Expression(voxel::Sphere{on_mm, 9.0}) & Expression(voxel::HalfSpace{normal, glm::dot(on_mm, normal)}));
  for (const double size_mm : {3.0, 4.0, 5.0}) {
    RegionMeshOptions options;
    options.size_mm = size_mm;
    const Tetrahedra t = smooth_tetrahedra_of({half, whole}, options);
    EXPECT_GE(quality(t).min_dihedral_deg, 5.0);
    std::vector<double> off_mm = off_plane_mm(t, on_mm, normal);
    std::sort(off_mm.begin(), off_mm.end());
    // The plane is determined from voxels alone, to a fraction of a voxel. Steps of voxels would put half of
    // the nodes off.
    constexpr double known_mm = 0.25;
    EXPECT_LT(off_mm.back(), known_mm) << size_mm;
    EXPECT_EQ(t.findings.size(), 2u) << t.findings.back();
  }
}

TEST(RegionTetrahedra, EveryPartOfARegionIsThereHoweverSmall) {
  const voxel::Octree far = ball(2.5, glm::dvec3(27.0, 27.0, 27.0));
  const Tetrahedra t = smooth_tetrahedra_of(
      {voxel::combine(tests::unit_universe(5), Expression(ball(8.0)) | Expression(far))});
  double found_mm3 = 0.0;
  for (std::size_t i = 0; i < t.tets.size(); ++i)
    if (corners_mm(t, i)[0].x > 24.0) found_mm3 += six_volumes(corners_mm(t, i)) / 6.0;
  EXPECT_NEAR(found_mm3, static_cast<double>(far.voxel_count()),
              0.25 * static_cast<double>(far.voxel_count()));
}

TEST(RegionTetrahedra, APlateThinnerThanItsElementsIsRefusedAndTheMessageSaysWhichRegion) {
  const voxel::Octree plate =
      voxel::combine(tests::unit_universe(5), Expression(voxel::Box{{4.0, 4.0, 27.6}, {27.0, 27.0, 28.4}}));
  ASSERT_FALSE(plate.is_empty());
  RegionMeshOptions coarse;
  coarse.size_mm = 12.0;
  try {
    const Tetrahedra t = smooth_tetrahedra_of({plate, ball(8.0)}, coarse);
    FAIL() << volume_mm3(t, 0) << " of " << plate.voxel_count();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("region 1 has "), std::string::npos) << error.what();
  }
}

TEST(RegionTetrahedra, TheSameRegionsGiveTheSameBits) {
  const Tetrahedra one = smooth_tetrahedra_of({ball(5.0), ball(9.0)});
  const Tetrahedra other = smooth_tetrahedra_of({ball(5.0), ball(9.0)});
  EXPECT_EQ(one.nodes_mm, other.nodes_mm);
  EXPECT_EQ(one.tets, other.tets);
  EXPECT_EQ(one.region_of_tet, other.region_of_tet);
}

TEST(RegionTetrahedra, ATimeLimitAndAStopAreNamed) {
  const auto refusal = [](const RegionMeshOptions& options) {
    try {
      smooth_tetrahedra_of({ball(12.0)}, options);
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  RegionMeshOptions hurried;
  hurried.size_mm = 0.8;
  hurried.time_limit = std::chrono::milliseconds(1);
  EXPECT_NE(refusal(hurried).find("time limit of 1 ms"), std::string::npos) << refusal(hurried);
  std::stop_source source;
  source.request_stop();
  RegionMeshOptions stopped;
  stopped.progress.stop = source.get_token();
  EXPECT_THROW(smooth_tetrahedra_of({ball(12.0)}, stopped), voxel::Stopped);
}

TEST(RegionTetrahedra, RefusesWhatItCannotBeAskedFor) {
  EXPECT_THROW(smooth_tetrahedra_of({}), std::invalid_argument);
  EXPECT_THROW(smooth_tetrahedra_of({voxel::Octree::empty(tests::unit_universe(5))}), std::invalid_argument);
  EXPECT_THROW(smooth_tetrahedra_of({ball(8.0), voxel::Octree::full(tests::unit_universe(4))}),
               std::invalid_argument);
  EXPECT_THROW(smooth_tetrahedra_of({ball(8.0), ball(5.0)}), std::invalid_argument) << "all within the first";
  RegionMeshOptions none;
  none.size_mm = 0.0;
  EXPECT_THROW(smooth_tetrahedra_of({ball(8.0)}, none), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::convert
