// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certificate.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "brep/boolean.h"
#include "brep/measure.h"
#include "brep/move.h"
#include "brep/prism.h"
#include "brep/triangles.h"
#include "convert/isosurface.h"
#include "voxel/combine.h"

namespace octotomy::verify {
namespace {

// Signed distances, negative inside, in millimetres.
using Distance = std::function<double(const glm::dvec3&)>;

Distance ball(const glm::dvec3& centre_mm, double radius_mm) {
  return [=](const glm::dvec3& p) { return glm::length(p - centre_mm) - radius_mm; };
}
Distance box(const glm::dvec3& centre_mm, const glm::dvec3& half_mm) {
  return [=](const glm::dvec3& p) {
    const glm::dvec3 q = glm::abs(p - centre_mm) - half_mm;
    return std::max({q.x, q.y, q.z});
  };
}
Distance cut_by(const Distance& a, const glm::dvec3& normal, double offset_mm) {
  return [=](const glm::dvec3& p) { return std::max(a(p), glm::dot(p, normal) - offset_mm); };
}
Distance either(const Distance& a, const Distance& b) {
  return [=](const glm::dvec3& p) { return std::min(a(p), b(p)); };
}

// Samples are the fraction of their voxel inside, from -1000 to 1000: half is 0.
voxel::Scene scan_of(const Distance& distance, double spacing_mm, double half_extent_mm) {
  voxel::Scene scene;
  const int side = static_cast<int>(std::ceil(2.0 * half_extent_mm / spacing_mm));
  scene.lattice = voxel::axis_aligned_lattice(glm::ivec3(side), glm::dvec3(spacing_mm),
                                              glm::dvec3(-0.5 * (side - 1) * spacing_mm));
  voxel::Int16Samples samples;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const glm::dvec3 p = scene.lattice.lps_mm({x, y, z});
        const double d = distance(p);
        double fraction = d < 0.0 ? 1.0 : 0.0;
        if (std::abs(d) < spacing_mm) {
          int inside = 0;
          for (int i = 0; i < 512; ++i)
            inside += distance(p + (glm::dvec3(i & 7, (i >> 3) & 7, i >> 6) - 3.5) / 8.0 * spacing_mm) < 0.0;
          fraction = inside / 512.0;
        }
        samples.push_back(static_cast<std::int16_t>(std::lround(2000.0 * fraction - 1000.0)));
      }
  scene.samples = std::move(samples);
  scene.source = "phantom";
  return scene;
}

struct Pair {
  voxel::Octree octree;
  brep::Mesh mesh;
  double spacing_mm;
};

// The window's octree on a universe of voxels of its own, and the isosurface of the same scan.
Pair both_kernels(const Distance& distance, double spacing_mm, double voxel_mm, double half_extent_mm) {
  const voxel::Scene scan = scan_of(distance, spacing_mm, half_extent_mm);
  const voxel::Universe universe = voxel::universe_around(voxel::bounds(scan.lattice), voxel_mm);
  const voxel::GreyOctree grey = voxel::grey_octree_of(universe, scan, -1000);
  return {voxel::combine(universe, voxel::Window{grey, 0.0, 32767.0}),
          brep::mesh_of(convert::isosurface(scan, 0.0, 32767.0)), spacing_mm};
}

Certificate certify(const Pair& pair) {
  BoundInputs inputs;
  inputs.operation = "window";
  inputs.voxel_lineage = "octree";
  inputs.mesh_lineage = "isosurface";
  inputs.scan_spacing_mm = glm::dvec3(pair.spacing_mm);
  return certify_bounded(pair.octree, pair.mesh, inputs);
}

std::string told(const Certificate& certificate) {
  char text[512];
  std::snprintf(
      text, sizeof text, "%s dV %.3f of %.3f, XOR %.3f of %.3f, centroid %.5f of %.5f, H95 %.3f H %.3f",
      to_string(certificate.agreement).c_str(), certificate.difference_mm3, certificate.tolerance_mm3,
      certificate.symmetric_difference_mm3, certificate.symmetric_difference_tolerance_mm3,
      certificate.centroid_distance_mm.value_or(-1), certificate.centroid_tolerance_mm.value_or(-1),
      certificate.hausdorff95_mm.value_or(-1), certificate.hausdorff_mm.value_or(-1));
  std::string result = text;
  for (const ToleranceTerm& term : certificate.terms)
    result += "; " + term.name + " " + std::to_string(term.value_mm3);
  for (const std::string& reason : certificate.reasons) result += "; " + reason;
  return result;
}

struct Named {
  std::string name;
  Distance distance;
};

std::vector<Named> phantoms() {
  const glm::dvec3 oblique = glm::normalize(glm::dvec3(0.31, 0.53, 0.79));
  return {{"sphere", ball({0.13, -0.21, 0.32}, 14.3)},
          {"small sphere", ball({0.4, 0.1, -0.3}, 6.2)},
          {"box", box({0.2, 0.3, -0.1}, {9.4, 12.1, 7.3})},
          {"cut sphere", cut_by(ball({0.3, 0.2, 0.1}, 14.0), oblique, 3.2)},
          {"flatly cut sphere", cut_by(ball({0.3, 0.2, 0.1}, 14.0), {0, 0, 1}, 4.3)},
          {"two spheres", either(ball({-7, 0.3, 0.2}, 7.1), ball({8.2, 1.1, 0.4}, 6.3))}};
}

glm::dmat4 shifted(const glm::dvec3& by_mm) {
  glm::dmat4 matrix(1.0);
  matrix[3] = glm::dvec4(by_mm, 1.0);
  return matrix;
}

TEST(CertifyBounded, RightAnswersPassAtSeveralResolutions) {
  for (const Named& phantom : phantoms())
    for (const double spacing_mm : {1.0, 0.7, 0.5})
      for (const double voxel_mm : {1.0, 0.6}) {
        const Certificate certificate = certify(both_kernels(phantom.distance, spacing_mm, voxel_mm, 18.0));
        EXPECT_EQ(certificate.agreement, Agreement::Pass)
            << phantom.name << ", samples " << spacing_mm << ", voxels " << voxel_mm << ": "
            << told(certificate);
      }
}

TEST(CertifyBounded, AShiftOfHalfAVoxelDoesNotPassOnAnyPhantom) {
  for (const Named& phantom : phantoms()) {
    Pair pair = both_kernels(phantom.distance, 1.0, 1.0, 18.0);
    // Faces along the voxels' planes can move half a voxel without any voxel changing, so the box moves by
    // one.
    pair.mesh = brep::moved(pair.mesh, shifted({phantom.name == "box" ? 1.0 : 0.5, 0, 0}));
    const Certificate certificate = certify(pair);
    EXPECT_NE(certificate.agreement, Agreement::Pass) << phantom.name << ": " << told(certificate);
  }
}

Agreement verdict_on(const Certificate& certificate, const std::string& quantity) {
  for (const Comparison& comparison : certificate.comparisons)
    if (comparison.quantity == quantity) return comparison.agreement;
  ADD_FAILURE() << quantity << " was not compared";
  return Agreement::Fail;
}

TEST(CertifyBounded, AShiftThatNoVolumeSeesHasVerdictsOfItsOwn) {
  Pair pair = both_kernels(phantoms()[0].distance, 1.0, 1.0, 18.0);
  const Certificate right = certify(pair);
  for (const char* quantity :
       {"volume", "symmetric difference", "centroid", "area", "inertia", "hausdorff95", "mean distance"})
    EXPECT_EQ(verdict_on(right, quantity), Agreement::Pass) << quantity;
  pair.mesh = brep::moved(pair.mesh, shifted({0.5, 0, 0}));
  const Certificate wrong = certify(pair);
  EXPECT_EQ(verdict_on(wrong, "volume"), Agreement::Pass);
  EXPECT_EQ(verdict_on(wrong, "area"), Agreement::Pass);
  EXPECT_EQ(verdict_on(wrong, "centroid"), Agreement::Fail) << told(wrong);
}

TEST(CertifyBounded, TheVolumesToleranceIsWithinThreeTimesWhatSpheresShow) {
  double worst = 0.0;
  for (int i = 0; i < 12; ++i) {
    const glm::dvec3 centre =
        glm::fract(glm::dvec3(i) * glm::dvec3(0.8191725134, 0.6710436067, 0.5497004779));
    const Certificate certificate = certify(both_kernels(ball(centre, 12.0 + 0.09 * i), 1.0, 1.0, 16.0));
    ASSERT_EQ(certificate.agreement, Agreement::Pass) << told(certificate);
    worst = std::max(worst, std::abs(certificate.difference_mm3) / certificate.tolerance_mm3);
  }
  EXPECT_GT(worst, 1.0 / 3.0);
}

TEST(CertifyBounded, WhereVoxelsAreTheSamplesTopologyIsCertifiedAndALostHandleFails) {
  const Distance ring = [](const glm::dvec3& p) {
    return glm::length(glm::dvec2(glm::length(glm::dvec2(p)) - 10.2, p.z)) - 3.3;
  };
  const voxel::Scene scan = scan_of(ring, 1.0, 16.0);
  const voxel::Universe universe = voxel::universe_around(voxel::bounds(scan.lattice), 1.0);
  const voxel::GreyOctree grey = voxel::grey_octree_of(universe, scan, -1000);
  const voxel::Octree octree = voxel::combine(universe, voxel::Window{grey, 0.0, 32767.0});
  BoundInputs inputs;
  inputs.voxels_are_samples = true;
  const Certificate right =
      certify_bounded(octree, brep::mesh_of(convert::isosurface(scan, 0.0, 32767.0)), inputs);
  EXPECT_EQ(verdict_on(right, "euler"), Agreement::Pass) << told(right);
  const voxel::Scene plug = scan_of(either(ring, ball({0, 0, 0}, 8.0)), 1.0, 16.0);
  const Certificate wrong =
      certify_bounded(octree, brep::mesh_of(convert::isosurface(plug, 0.0, 32767.0)), inputs);
  EXPECT_EQ(verdict_on(wrong, "euler"), Agreement::Fail) << told(wrong);
  EXPECT_EQ(verdict_on(right, "components"), Agreement::Pass) << told(right);
  const voxel::Scene stray = scan_of(either(ring, ball({0, 0, 0}, 3.0)), 1.0, 16.0);
  const Certificate parted =
      certify_bounded(octree, brep::mesh_of(convert::isosurface(stray, 0.0, 32767.0)), inputs);
  EXPECT_EQ(verdict_on(parted, "components"), Agreement::Fail) << told(parted);
}

TEST(CertifyBounded, AMeshTurnedInsideOutFails) {
  Pair pair = both_kernels(phantoms()[0].distance, 1.0, 1.0, 18.0);
  brep::Triangles triangles = brep::triangles_of(pair.mesh);
  for (auto& face : triangles.faces) std::swap(face[0], face[1]);
  pair.mesh = brep::mesh_of(triangles);
  EXPECT_EQ(certify(pair).agreement, Agreement::Fail);
}

TEST(CertifyBounded, ASmallLostComponentDoesNotPass) {
  Pair pair = both_kernels(either(ball({-4, 0, 0}, 11.0), ball({14.2, 1.1, 0.4}, 2.4)), 1.0, 1.0, 18.0);
  EXPECT_EQ(certify(pair).agreement, Agreement::Pass) << told(certify(pair));
  pair.mesh = both_kernels(ball({-4, 0, 0}, 11.0), 1.0, 1.0, 18.0).mesh;
  EXPECT_NE(certify(pair).agreement, Agreement::Pass) << told(certify(pair));
}

TEST(CertifyBounded, ADifferenceOfMeshesPassesAndItsSwappedOperandsFail) {
  const Pair a = both_kernels(ball({-3, 0.2, 0.1}, 11.0), 1.0, 1.0, 18.0);
  const Pair b = both_kernels(ball({5, 0.4, 0.3}, 9.0), 1.0, 1.0, 18.0);
  const voxel::Octree octree =
      voxel::combine(a.octree.universe(), voxel::Expression(a.octree) - voxel::Expression(b.octree));
  const Pair right{octree, brep::boolean(a.mesh, brep::Operation::Difference, b.mesh).mesh, 1.0};
  EXPECT_EQ(certify(right).agreement, Agreement::Pass) << told(certify(right));
  const Pair swapped{octree, brep::boolean(b.mesh, brep::Operation::Difference, a.mesh).mesh, 1.0};
  EXPECT_EQ(certify(swapped).agreement, Agreement::Fail) << told(certify(swapped));
}

TEST(CertifyBounded, ACutAt45DegreesErrsInStepAndIsAllowedThatNoMore) {
  const Pair a = both_kernels(box({0.2, 0.3, -0.1}, {13, 13, 13}), 1.0, 1.0, 18.0);
  const glm::dvec3 diagonal = glm::normalize(glm::dvec3(1, 1, 0));
  brep::Prism prism;
  prism.look = {0, 0, 1};
  prism.up = diagonal;
  prism.right = glm::cross(prism.look, prism.up);
  prism.from_mm = -40.0;
  prism.to_mm = 40.0;
  for (const double offset_mm : {0.0, 0.3, 0.6}) {
    prism.polygons_mm = {{{-40, -40}, {40, -40}, {40, offset_mm}, {-40, offset_mm}}};
    const voxel::Octree octree = voxel::combine(
        a.octree.universe(), voxel::Expression(a.octree) & voxel::HalfSpace{diagonal, offset_mm});
    const brep::Mesh mesh = brep::boolean(a.mesh, brep::Operation::Intersection, brep::mesh_of(prism)).mesh;
    const Certificate certificate = certify({octree, mesh, 1.0});
    EXPECT_EQ(certificate.agreement, Agreement::Pass) << offset_mm << ": " << told(certificate);
    // The twin: the mesh is cut a millimetre further on.
    prism.polygons_mm[0][2].y = prism.polygons_mm[0][3].y = offset_mm + 1.0;
    const brep::Mesh wrong = brep::boolean(a.mesh, brep::Operation::Intersection, brep::mesh_of(prism)).mesh;
    EXPECT_NE(certify({octree, wrong, 1.0}).agreement, Agreement::Pass) << offset_mm;
  }
}

TEST(CertifyBounded, AFewVoxelsProveNothing) {
  const Certificate certificate = certify(both_kernels(ball({0, 0, 0}, 2.5), 1.0, 1.0, 6.0));
  EXPECT_EQ(certificate.agreement, Agreement::BelowResolution);
  EXPECT_FALSE(certificate.reasons.empty());
}

TEST(CertifyBounded, NothingAgreesWithNothingOnly) {
  const Pair something = both_kernels(ball({0, 0, 0}, 8.0), 1.0, 1.0, 12.0);
  const voxel::Octree none = voxel::Octree::empty(something.octree.universe());
  EXPECT_EQ(certify({none, brep::Mesh(), 1.0}).agreement, Agreement::Pass);
  EXPECT_EQ(certify({none, something.mesh, 1.0}).agreement, Agreement::Fail);
  EXPECT_EQ(certify({something.octree, brep::Mesh(), 1.0}).agreement, Agreement::Fail);
}

}  // namespace
}  // namespace octotomy::verify
