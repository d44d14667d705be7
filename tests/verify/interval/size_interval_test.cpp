// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/interval/size_interval.h"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>

#include "brep/boolean/boolean.h"
#include "brep/mesh/move.h"
#include "brep/shape/prism.h"
#include "convert/surface/isosurface.h"
#include "verify/certificate/boundary_model.h"
#include "verify/phantom/implicit_solid.h"
#include "verify/phantom/phantom_scan.h"

namespace octotomy::verify {
namespace {

SolidPhantom ball() {
  SolidPhantomOptions options;
  options.voxels = 32;
  options.radius_voxels = 11.0;
  options.centre_mm = {0.1, 0.2, 0.3};
  return solid_phantom("sphere", options);
}

voxel::Scene scan_of_ball(double blur_voxels) {
  Chance chance(1);
  return phantom_scan(digitise_partial(ball()), {blur_voxels, 0.0}, chance);
}

brep::Solid surface_of(const voxel::Scene& scan) {
  return brep::trusted_solid(convert::isosurface(scan, 0.0, std::numeric_limits<double>::infinity()),
                             brep::Proof::Construction);
}

double blur_found(const voxel::Scene& scan) {
  const auto nearest = [&](const glm::dvec3& p_mm) {
    const glm::dvec3 q = scan.lattice.voxel(p_mm), first = glm::floor(q), t = q - first;
    double value = 0.0;
    for (int i = 0; i < 8; ++i) {
      const glm::dvec3 corner(i & 1, (i >> 1) & 1, i >> 2), weight = glm::mix(1.0 - t, t, corner);
      const glm::ivec3 at(first + corner);
      value += weight.x * weight.y * weight.z *
               std::get<voxel::Int16Samples>(
                   scan.samples)[static_cast<std::size_t>((at.z * 32 + at.y) * 32 + at.x)];
    }
    return value;
  };
  return blur_of(surface_of(scan), glm::dmat3(1.0), nearest);
}

TEST(SizeInterval, TheBlurOfAScanIsFoundFromItsSamples) {
  EXPECT_NEAR(blur_found(scan_of_ball(0.7)), 0.49, 0.1);
  EXPECT_LT(blur_found(scan_of_ball(0.0)), 0.1);
}

TEST(SizeInterval, HoldsABallAndNoneThatIsTwoPerCentLarger) {
  const voxel::Scene scan = scan_of_ball(0.0);
  SampledFrom from;
  from.blur_samples2 = blur_found(scan);
  const SizeIntervals found = size_intervals(surface_of(scan), from);
  const SolidPhantom truth = ball();
  EXPECT_NEAR(found.volume_mm3.value, truth.volume_mm3, found.volume_mm3.half_width);
  EXPECT_NEAR(found.area_mm2.value, truth.area_mm2, found.area_mm2.half_width);
  EXPECT_GT(std::abs(1.02 * found.volume_mm3.value - truth.volume_mm3), found.volume_mm3.half_width);
}

// A slope that blur would give may be the object's own.
TEST(SizeInterval, TellsBlurAsDoubtAndAddsNothingForIt) {
  const voxel::Scene scan = scan_of_ball(0.7);
  const brep::Solid surface = surface_of(scan);
  SampledFrom sharp, blurred;
  blurred.blur_samples2 = blur_found(scan);
  const SizeIntervals found = size_intervals(surface, blurred), without = size_intervals(surface, sharp);
  const SolidPhantom truth = ball();
  EXPECT_NEAR(found.volume_mm3.value, truth.volume_mm3, found.volume_mm3.half_width);
  EXPECT_NEAR(found.area_mm2.value, truth.area_mm2, found.area_mm2.half_width);
  EXPECT_EQ(found.volume_mm3.value, without.volume_mm3.value);
  EXPECT_EQ(found.area_mm2.value, without.area_mm2.value);
  EXPECT_GT(found.volume_mm3.half_width, without.volume_mm3.half_width);
  EXPECT_LT(found.volume_mm3.half_width, 0.1 * truth.volume_mm3);
}

TEST(SizeInterval, AMotionKeepsBoth) {
  const brep::Solid surface = surface_of(scan_of_ball(0.0));
  const glm::dmat3 turn = turned({10, 20, 30});
  SampledFrom still, moved;
  still.sample_edges = glm::dmat3({1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  moved.sample_edges = turn * still.sample_edges;
  const SizeIntervals here = size_intervals(surface, still),
                      there = size_intervals(brep::moved(surface, glm::dmat4(turn)), moved);
  EXPECT_NEAR(there.volume_mm3.value, here.volume_mm3.value, 1e-6 * here.volume_mm3.value);
  EXPECT_NEAR(there.volume_mm3.half_width, here.volume_mm3.half_width, 0.02 * here.volume_mm3.half_width);
  EXPECT_NEAR(there.area_mm2.half_width, here.area_mm2.half_width, 0.05 * here.area_mm2.half_width);
}

TEST(SizeInterval, PartsAddUpToTheirWholeAndAreNoSurerOfTheirWindow) {
  const brep::Solid whole = surface_of(scan_of_ball(0.0));
  brep::Prism prism;
  prism.polygons_mm = {{{-20.0, -20.0}, {3.3, -20.0}, {3.3, 20.0}, {-20.0, 20.0}}};
  prism.from_mm = -20.0;
  prism.to_mm = 20.0;
  const brep::Booleans parts = brep::booleans(whole, brep::solid_of(prism), {false, true, true, false});
  SampledFrom from;
  from.window_shift_mm = 0.05;
  const auto window_of = [&](const SizeIntervals& intervals) {
    double half_width = 0.0;
    for (const DoubtSource& source : intervals.volume_mm3.sources)
      if (source.name == "window") half_width = source.half_width;
    return half_width;
  };
  const SizeIntervals all = size_intervals(whole, from), piece = size_intervals(*parts.intersection, from),
                      rest = size_intervals(*parts.a_minus_b, from);
  // A cut is exact: its rim adds nothing to either part.
  EXPECT_NEAR(piece.volume_mm3.value + rest.volume_mm3.value, all.volume_mm3.value,
              0.002 * all.volume_mm3.value);
  EXPECT_GE(window_of(piece) + window_of(rest), window_of(all));
}

TEST(SizeInterval, TellsTheCurvatureThatTheBoundarysModelHas) {
  brep::Prism prism;  // its edges are cuts, which bend no part but have their curvature
  prism.polygons_mm = {{{-8.0, -8.0}, {3.3, -7.0}, {3.3, 8.0}, {-8.0, 9.0}}};
  prism.from_mm = -5.0;
  prism.to_mm = 6.0;
  SampledFrom from;
  for (const brep::Solid& surface : {surface_of(scan_of_ball(0.5)), brep::solid_of(prism)}) {
    from.along_lps_mm.reset();
    EXPECT_EQ(size_intervals(surface, from).triangles.curvature_mm, 0.0);
    from.along_lps_mm = glm::dvec3(1.0, 0.8, 1.3);
    const AreaAndCurvature found = size_intervals(surface, from).triangles;
    const BoundaryModel model =
        boundary_model(surface, {scan_of_ball(0.5).lattice, *from.along_lps_mm, glm::dvec3(0.0)});
    EXPECT_EQ(found.curvature_mm, model.curvature_mm);
    EXPECT_GT(found.curvature_mm, 50.0);
    EXPECT_NEAR(found.area_mm2, surface.size().area_mm2, 1e-9 * found.area_mm2);
  }
}

}  // namespace
}  // namespace octotomy::verify
