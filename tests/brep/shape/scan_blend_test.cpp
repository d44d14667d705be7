// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Two balls that overlap stand for teeth that touch: their scan has both caps whole, so that it crosses itself.
#include "brep/shape/scan_blend.h"

#include <gtest/gtest.h>

#include "brep/boolean/boolean.h"
#include "brep/mesh/distance.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

constexpr double radius_mm = 5.0, apart_mm = 8.0, border_mm = -2.0;

Triangles two_balls(double by_mm) {
  Triangles both = shapes::sphere({-0.5 * apart_mm, 0, 0}, by_mm, 4);
  const Triangles other = shapes::sphere({0.5 * apart_mm, 0, 0}, by_mm, 4);
  const auto first = static_cast<std::uint32_t>(both.points_mm.size());
  both.points_mm.insert(both.points_mm.end(), other.points_mm.begin(), other.points_mm.end());
  for (const auto& [a, b, c] : other.faces) both.faces.push_back({a + first, b + first, c + first});
  return both;
}

/// The caps above the border.
Mesh crossing_scan() {
  Triangles caps = two_balls(radius_mm);
  std::erase_if(caps.faces, [&](const auto& face) { return caps.points_mm[face[0]].z < border_mm; });
  return mesh_of(caps);
}

/// The teeth as another scan shows them, a little thicker.
Solid thicker_teeth() {
  constexpr double thicker_mm = 0.3;
  return boolean(trusted_solid(shapes::sphere({-0.5 * apart_mm, 0, 0}, radius_mm + thicker_mm, 4),
                               Proof::Construction),
                 Operation::Union,
                 trusted_solid(shapes::sphere({0.5 * apart_mm, 0, 0}, radius_mm + thicker_mm, 4),
                               Proof::Construction),
                 {})
      .solid;
}

ScanBlendOptions crowns() {
  ScanBlendOptions options;
  options.to_roots = {0, 0, -1};
  options.tips_mm = -radius_mm;
  return options;
}

TEST(ScanBlend, WhereTheScanCrossesItselfNoSurfaceIsLeftWithinTheTeeth) {
  const ScanBlendOptions options = crowns();
  const Mesh scan = crossing_scan();
  const ScanBlend made = blended_with_scan(thicker_teeth(), scan, options);
  EXPECT_EQ(made.solid.components().size(), 1u);
  // Within one ball, and 0.38 mm outside the other one's buried cap.
  EXPECT_TRUE(made.solid.tree().is_inside({-1.0, 0, 2.0}));
  EXPECT_TRUE(made.solid.tree().is_inside({1.0, 0, 2.0}));
  EXPECT_FALSE(made.solid.tree().is_inside({0, 0, 4.0})) << "in the gap between both";
  // Of the crowns, all points lie on a cap, and none on a part that is buried in the other ball.
  const SurfaceTree tree(scan);
  const double most_mm = scan_blend_allowance_mm(options);
  std::size_t crown_points = 0;
  for (const glm::dvec3& p : made.solid.triangles().points_mm) {
    if (p.z < 2.0) continue;
    ++crown_points;
    std::uint32_t start = 0;
    EXPECT_LE(tree.distance_mm(p, start), most_mm) << p.x << " " << p.y << " " << p.z;
    for (const double x : {-0.5 * apart_mm, 0.5 * apart_mm})
      EXPECT_GE(glm::distance(p, {x, 0, 0}), radius_mm - most_mm) << p.x << " " << p.y << " " << p.z;
  }
  EXPECT_GT(crown_points, 1000u);
}

TEST(ScanBlend, SmallerCellsLieNearerToTheScan) {
  ScanBlendOptions options = crowns();
  const Mesh scan = crossing_scan();
  const SurfaceTree tree(scan);
  const Solid before = thicker_teeth();
  const auto farthest_mm = [&](double cell_mm) {
    options.cell_mm = cell_mm;
    double most = 0.0;
    const ScanBlend made = blended_with_scan(before, scan, options);
    const Triangles& surface = made.solid.triangles();
    for (const auto& [a, b, c] : surface.faces) {
      const glm::dvec3 middle = (surface.points_mm[a] + surface.points_mm[b] + surface.points_mm[c]) / 3.0;
      std::uint32_t start = 0;
      if (middle.z > 2.0) most = std::max(most, tree.distance_mm(middle, start));
    }
    return most;
  };
  const double coarse_mm = farthest_mm(1.0), fine_mm = farthest_mm(0.25);
  EXPECT_LT(fine_mm, 0.5 * coarse_mm);
  options.cell_mm = 0.25;
  EXPECT_LE(fine_mm, scan_blend_allowance_mm(options));
}

TEST(ScanBlend, CellsThatWouldTakeTooMuchMemoryAreRefusedAndAStopEndsTheWork) {
  const Solid before = thicker_teeth();
  ScanBlendOptions options = crowns();
  options.cell_mm = 0.002;
  EXPECT_THROW(blended_with_scan(before, crossing_scan(), options), std::length_error);
  options.cell_mm = 0.25;
  std::stop_source source;
  options.progress.stop = source.get_token();
  int reports = 0;
  options.progress.report = [&](double) {
    if (++reports == 2) source.request_stop();
  };
  EXPECT_THROW(blended_with_scan(before, crossing_scan(), options), Stopped);
  EXPECT_EQ(reports, 2);
}

}  // namespace
}  // namespace octotomy::brep
