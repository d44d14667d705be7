// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certificate/boundary_model.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

#include "brep/mesh/measure.h"
#include "brep/mesh/move.h"
#include "brep/shape/prism.h"
#include "convert/surface/isosurface.h"
#include "convert/surface/partial_surface.h"
#include "convert/voxel/voxelise.h"
#include "verify/phantom/implicit_solid.h"
#include "verify/phantom/solid_phantom.h"
#include "voxel/measure/measure.h"

namespace octotomy::verify {
namespace {

voxel::Lattice unit_lattice() {
  return voxel::axis_aligned_lattice({64, 64, 64}, {1, 1, 1}, {-31.5, -31.5, -31.5});
}

brep::Solid surface_of(const char* kind, double radius, const glm::dvec3& centre, const glm::dmat3& turn) {
  SolidPhantomOptions options;
  options.voxels = 64;
  options.radius_voxels = radius;
  options.centre_mm = centre;
  options.lps_from_axes = turn;
  return brep::trusted_solid(convert::isosurface(digitise_partial(solid_phantom(kind, options))),
                             brep::Proof::Construction);
}

TEST(BoundaryModel, ASphereCountsWithKendallsDeviation) {
  const BoundaryModel model = boundary_model(surface_of("sphere", 16, {0.1, 0.2, 0.3}, glm::dmat3(1)),
                                             {unit_lattice(), glm::dvec3(1.0), {}});
  // 0.0666 S; the widest of three cones is taken about each direction, which is more rather than less.
  EXPECT_NEAR(model.count_mm6 / model.area_mm2, 0.0666, 0.02);
}

TEST(BoundaryModel, TheDeviationPredictedIsThatOfACountOverManyPlaces) {
  for (const char* kind : {"sphere", "ellipsoid", "lens", "box"}) {
    const brep::Solid mesh = surface_of(kind, 10, {0, 0, 0}, turned({23, 41, 67}));
    const double truth_mm3 = brep::volume_mm3(mesh);
    const BoundaryModel model = boundary_model(mesh, {unit_lattice(), glm::dvec3(1.0), {}});
    const voxel::Universe universe{6, unit_lattice().lps_from_voxel};
    double squares = 0.0;
    constexpr int places = 64;
    for (int i = 0; i < places; ++i) {
      // Additive recurrence: spread evenly over a voxel.
      const glm::dvec3 by_mm =
          glm::fract(glm::dvec3(i) * glm::dvec3(0.8191725134, 0.6710436067, 0.5497004779));
      const auto count = static_cast<double>(
          convert::voxelise(universe, brep::moved(mesh, glm::translate(glm::dmat4(1.0), by_mm)).linked())
              .voxel_count());
      squares += (count - truth_mm3) * (count - truth_mm3);
    }
    const double found = std::sqrt(squares / places), predicted = std::sqrt(model.count_mm6);
    // One size of a body interferes with itself: its own deviation is up to sqrt(2) of the mean of sizes.
    EXPECT_GT(predicted, found / std::sqrt(2.0) / 1.1)
        << kind << ": found " << found << ", predicted " << predicted;
    EXPECT_LT(predicted, 1.8 * found) << kind << ": found " << found << ", predicted " << predicted;
  }
}

TEST(BoundaryModel, ABallsCurvatureIntegralIsFourPiRadiiByEachSpacingSquared) {
  const brep::Solid mesh = surface_of("sphere", 16, {0.1, 0.2, 0.3}, glm::dmat3(1));
  const double one = boundary_model(mesh, {unit_lattice(), {1, 1, 1}, {}}).bent.mm3;
  EXPECT_NEAR(one / (4.0 * std::numbers::pi * 16.0), 1.0, 0.05);
  // A third of a sphere's curvature lies along each axis.
  const double coarse = boundary_model(mesh, {unit_lattice(), {1, 1, 2}, {}}).bent.mm3;
  EXPECT_NEAR(coarse / one, 2.0, 0.05);
}

/// What a turn t of the faces loses along a unit of edge, see boundary_model.cpp.
double lost_along(double turn_deg) {
  const double t = turn_deg * std::numbers::pi / 180.0;
  return 0.295 * (1.0 - t / std::tan(t));
}

TEST(BoundaryModel, SharpEdgesLoseTheAreaOfTheChordsThatLinesOfCentresMiss) {
  for (const double apex_deg : {90.0, 40.0, 25.0}) {
    // A prism of an isosceles triangle.
    constexpr double side_mm = 24.0, length_mm = 20.0;
    const double half = 0.5 * apex_deg * std::numbers::pi / 180.0;
    const double across_mm = 2.0 * side_mm * std::sin(half), high_mm = side_mm * std::cos(half);
    brep::Prism prism;
    prism.polygons_mm = {
        {{-0.4 * high_mm, -0.5 * across_mm}, {0.6 * high_mm, 0.0}, {-0.4 * high_mm, 0.5 * across_mm}}};
    prism.from_mm = -0.5 * length_mm;
    prism.to_mm = 0.5 * length_mm;
    const brep::Solid still = brep::solid_of(prism);
    const double base_deg = 0.5 * (180.0 - apex_deg);
    const double expected = length_mm * (lost_along(180.0 - apex_deg) + 2.0 * lost_along(180.0 - base_deg)) +
                            2.0 * (2.0 * side_mm + across_mm) * lost_along(89.999);
    const voxel::Universe universe{6, unit_lattice().lps_from_voxel};
    double lost_mm2 = 0.0;
    constexpr int poses = 60;
    for (int i = 0; i < poses; ++i) {
      const glm::dvec3 angles =
          360.0 * glm::fract(glm::dvec3(i + 1) * glm::dvec3(0.8191725134, 0.6710436067, 0.5497004779));
      const brep::Solid mesh = brep::moved(still, glm::dmat4(turned(angles)));
      const BoundaryModel model = boundary_model(mesh, {unit_lattice(), glm::dvec3(1.0), {}});
      lost_mm2 +=
          model.crofton13_mm2 - voxel::measure(convert::voxelise(universe, mesh.linked())).area_crofton13_mm2;
    }
    EXPECT_NEAR(lost_mm2 / poses, expected, 0.05 * expected) << apex_deg;
    // What a certificate allows beside 0.3 of the mean curvature is the rest of it.
    const BoundaryModel model = boundary_model(still, {unit_lattice(), glm::dvec3(1.0), {}});
    EXPECT_GE(0.3 * model.curvature_mm + model.sharp_mm, 0.95 * expected) << apex_deg;
  }
}

TEST(BoundaryModel, APlanesDisplacementIsExactAndASlopesIsNone) {
  brep::Prism prism;
  prism.polygons_mm = {{{-8.2, -6.0}, {9.4, -6.0}, {9.4, 7.3}, {-8.2, 7.3}}};
  prism.from_mm = -5.3;
  prism.to_mm = 4.4;
  const brep::Solid box = brep::solid_of(prism);
  const BoundaryModel model = boundary_model(box, {unit_lattice(), glm::dvec3(1.0), {}});
  const voxel::Universe universe{6, unit_lattice().lps_from_voxel};
  const auto count = static_cast<double>(convert::voxelise(universe, box.linked()).voxel_count());
  // To first order: along 100 mm of edges displacements of 0.3 and 0.4 mm multiply.
  EXPECT_NEAR(count - brep::volume_mm3(box), model.planes.mm3, 15.0);
  EXPECT_DOUBLE_EQ(model.count_mm6, 0.0);
  const glm::dmat4 turn(turned({10, 20, 30}));
  const BoundaryModel oblique = boundary_model(brep::moved(box, turn), {unit_lattice(), glm::dvec3(1.0), {}});
  EXPECT_DOUBLE_EQ(oblique.planes.mm3, 0.0);
  EXPECT_GT(oblique.count_mm6, 0.0);
}

/// A plate along the lattice whose faces noise has roughened by a tenth of a voxel errs in step, nearly as
/// the smooth one, and a count of centres shows it.
TEST(BoundaryModel, ARoughPlaneIsDisplacedInStepThoughNoneOfItsTrianglesIsFlat) {
  const voxel::Universe universe{6, unit_lattice().lps_from_voxel};
  for (const double top : {4.1, 4.35, 4.7, 4.9}) {
    // A height map over a disc of radius 20 on a flat floor between centres, its wall oblique.
    voxel::Scene scene;
    scene.lattice = unit_lattice();
    voxel::FloatSamples samples;
    for (int z = 0; z < 64; ++z)
      for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
          const glm::dvec3 p = scene.lattice.lps_mm(glm::dvec3(x, y, z));
          const double rough = 0.1 * std::sin(12.9898 * x + 78.233 * y);
          const double height = std::min(top + rough - p.z, p.z + 4.0);
          samples.push_back(static_cast<float>(std::min(height, 20.0 - std::hypot(p.x, p.y))));
        }
    scene.samples = std::move(samples);
    const brep::Solid mesh =
        brep::trusted_solid(convert::isosurface(scene, 0.0, 1e9), brep::Proof::Construction);
    const BoundaryModel model = boundary_model(mesh, {unit_lattice(), glm::dvec3(1.0), {}});
    const auto count = static_cast<double>(convert::voxelise(universe, mesh.linked()).voxel_count());
    const double displaced = count - brep::volume_mm3(mesh);
    EXPECT_NEAR(displaced, model.planes.mm3 + model.nearly_planes.mm3, 3.0 * std::sqrt(model.count_mm6))
        << "top at " << top;
  }
}

}  // namespace
}  // namespace octotomy::verify
