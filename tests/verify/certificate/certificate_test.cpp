// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "brep/boolean/boolean.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/move.h"
#include "brep/mesh/triangles.h"
#include "brep/shape/prism.h"
#include "convert/surface/isosurface.h"
#include "verify/certificate/certify_bounded.h"
#include "voxel/solid/combine.h"

namespace octotomy::verify {
namespace {

// Signed distances, negative inside, in millimetres.
using Distance = std::function<double(const glm::dvec3&)>;

Distance ball_distance(const glm::dvec3& centre_mm, double radius_mm) {
  return [=](const glm::dvec3& p) { return glm::length(p - centre_mm) - radius_mm; };
}
Distance box_distance(const glm::dvec3& centre_mm, const glm::dvec3& half_mm) {
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
  brep::Solid solid;
  double spacing_mm;
};

brep::Solid isosurface_solid(const voxel::Scene& scan) {
  return brep::trusted_solid(convert::isosurface(scan, 0.0, 32767.0), brep::Proof::Construction);
}

// The window's octree on a universe of voxels of its own, and the isosurface of the same scan.
Pair both_kernels(const Distance& distance, double spacing_mm, double voxel_mm, double half_extent_mm) {
  const voxel::Scene scan = scan_of(distance, spacing_mm, half_extent_mm);
  const voxel::Universe universe = voxel::universe_around(voxel::bounds(scan.lattice), voxel_mm);
  const voxel::GreyOctree grey = voxel::grey_octree_of(universe, scan, -1000);
  return {voxel::combine(universe, voxel::Window{grey, 0.0, 32767.0}), isosurface_solid(scan), spacing_mm};
}

Certificate certify(const Pair& pair) {
  BoundInputs inputs;
  inputs.operation = "window";
  inputs.voxel_lineage = "octree";
  inputs.mesh_lineage = "isosurface";
  inputs.scan_spacing_mm = glm::dvec3(pair.spacing_mm);
  return certify_bounded(pair.octree, pair.solid, inputs);
}

std::string told(const Certificate& certificate) {
  char text[512];
  std::snprintf(text, sizeof text,
                "%s dV %.3f of %.3f, XOR %.3f of %.3f, centroid %.5f of %.5f, H95 %.3f H %.3f",
                to_string(certificate.verdict).c_str(), certificate.difference_mm3, certificate.tolerance_mm3,
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
  return {{"sphere", ball_distance({0.13, -0.21, 0.32}, 14.3)},
          {"small sphere", ball_distance({0.4, 0.1, -0.3}, 6.2)},
          {"box", box_distance({0.2, 0.3, -0.1}, {9.4, 12.1, 7.3})},
          {"cut sphere", cut_by(ball_distance({0.3, 0.2, 0.1}, 14.0), oblique, 3.2)},
          {"flatly cut sphere", cut_by(ball_distance({0.3, 0.2, 0.1}, 14.0), {0, 0, 1}, 4.3)},
          {"two spheres", either(ball_distance({-7, 0.3, 0.2}, 7.1), ball_distance({8.2, 1.1, 0.4}, 6.3))}};
}

TEST(CertifyBounded, RightAnswersPassAtSeveralResolutions) {
  for (const Named& phantom : phantoms())
    for (const double spacing_mm : {1.0, 0.7, 0.5})
      for (const double voxel_mm : {1.0, 0.6}) {
        const Certificate certificate = certify(both_kernels(phantom.distance, spacing_mm, voxel_mm, 18.0));
        EXPECT_EQ(certificate.verdict, Verdict::Pass) << phantom.name << ", samples " << spacing_mm
                                                      << ", voxels " << voxel_mm << ": " << told(certificate);
      }
}

TEST(CertifyBounded, AShiftOfHalfAVoxelDoesNotPassOnAnyPhantom) {
  for (const Named& phantom : phantoms()) {
    Pair pair = both_kernels(phantom.distance, 1.0, 1.0, 18.0);
    // Faces along the voxels' planes can move half a voxel without any voxel changing, so the box moves by
    // one.
    pair.solid =
        brep::moved(pair.solid, glm::translate(glm::dmat4(1.0), {phantom.name == "box" ? 1.0 : 0.5, 0, 0}));
    const Certificate certificate = certify(pair);
    EXPECT_NE(certificate.verdict, Verdict::Pass) << phantom.name << ": " << told(certificate);
  }
}

Verdict verdict_on(const Certificate& certificate, const std::string& quantity) {
  for (const Comparison& comparison : certificate.comparisons)
    if (comparison.quantity == quantity) return comparison.verdict;
  ADD_FAILURE() << quantity << " was not compared";
  return Verdict::Fail;
}

TEST(CertifyBounded, AShiftThatNoVolumeSeesHasVerdictsOfItsOwn) {
  Pair pair = both_kernels(phantoms()[0].distance, 1.0, 1.0, 18.0);
  const Certificate right = certify(pair);
  for (const char* quantity :
       {"volume", "symmetric difference", "centroid", "area", "inertia", "hausdorff95", "mean distance"})
    EXPECT_EQ(verdict_on(right, quantity), Verdict::Pass) << quantity;
  pair.solid = brep::moved(pair.solid, glm::translate(glm::dmat4(1.0), {0.5, 0, 0}));
  const Certificate wrong = certify(pair);
  EXPECT_EQ(verdict_on(wrong, "volume"), Verdict::Pass);
  EXPECT_EQ(verdict_on(wrong, "area"), Verdict::Pass);
  EXPECT_EQ(verdict_on(wrong, "centroid"), Verdict::Fail) << told(wrong);
}

TEST(CertifyBounded, TheVolumesToleranceIsWithinThreeTimesWhatSpheresShow) {
  double worst = 0.0;
  for (int i = 0; i < 12; ++i) {
    const glm::dvec3 centre =
        glm::fract(glm::dvec3(i) * glm::dvec3(0.8191725134, 0.6710436067, 0.5497004779));
    const Certificate certificate =
        certify(both_kernels(ball_distance(centre, 12.0 + 0.09 * i), 1.0, 1.0, 16.0));
    ASSERT_EQ(certificate.verdict, Verdict::Pass) << told(certificate);
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
  const Certificate right = certify_bounded(octree, isosurface_solid(scan), inputs);
  EXPECT_EQ(verdict_on(right, "euler"), Verdict::Pass) << told(right);
  const voxel::Scene plug = scan_of(either(ring, ball_distance({0, 0, 0}, 8.0)), 1.0, 16.0);
  const Certificate wrong = certify_bounded(octree, isosurface_solid(plug), inputs);
  EXPECT_EQ(verdict_on(wrong, "euler"), Verdict::Fail) << told(wrong);
  EXPECT_EQ(verdict_on(right, "components"), Verdict::Pass) << told(right);
  const voxel::Scene stray = scan_of(either(ring, ball_distance({0, 0, 0}, 3.0)), 1.0, 16.0);
  const Certificate parted = certify_bounded(octree, isosurface_solid(stray), inputs);
  EXPECT_EQ(verdict_on(parted, "components"), Verdict::Fail) << told(parted);
}

TEST(CertifyBounded, AMeshTurnedInsideOutFails) {
  Pair pair = both_kernels(phantoms()[0].distance, 1.0, 1.0, 18.0);
  brep::Triangles triangles = pair.solid.triangles();
  for (auto& face : triangles.faces) std::swap(face[0], face[1]);
  pair.solid = brep::trusted_solid(triangles, brep::Proof::Connection);
  EXPECT_EQ(certify(pair).verdict, Verdict::Fail);
}

TEST(CertifyBounded, ASmallLostComponentDoesNotPass) {
  Pair pair = both_kernels(either(ball_distance({-4, 0, 0}, 11.0), ball_distance({14.2, 1.1, 0.4}, 2.4)), 1.0,
                           1.0, 18.0);
  EXPECT_EQ(certify(pair).verdict, Verdict::Pass) << told(certify(pair));
  pair.solid = both_kernels(ball_distance({-4, 0, 0}, 11.0), 1.0, 1.0, 18.0).solid;
  EXPECT_NE(certify(pair).verdict, Verdict::Pass) << told(certify(pair));
}

TEST(CertifyBounded, NamesThePlaceThatDiffersMostAndTheKernelThatHasAPartThere) {
  const glm::dvec3 lost_mm(14.2, 1.1, 0.4);
  const Pair both =
      both_kernels(either(ball_distance({-4, 0, 0}, 11.0), ball_distance(lost_mm, 2.4)), 1.0, 1.0, 18.0);
  const Pair one = both_kernels(ball_distance({-4, 0, 0}, 11.0), 1.0, 1.0, 18.0);
  const auto expect_at = [&](const Pair& pair, const std::string& what) {
    const Certificate certificate = certify(pair);
    ASSERT_TRUE(certificate.worst);
    EXPECT_LT(glm::distance(certificate.worst->at_mm, lost_mm), 4.0) << told(certificate);
    EXPECT_DOUBLE_EQ(certificate.worst->size_mm, *certificate.hausdorff_mm);
    EXPECT_EQ(certificate.worst->what, what);
    const std::string place = text_of(*certificate.worst);
    EXPECT_EQ(std::count(certificate.reasons.begin(), certificate.reasons.end(), place), 1)
        << told(certificate);
  };
  expect_at({both.octree, one.solid, 1.0}, part_of_voxels_only);
  expect_at({one.octree, both.solid, 1.0}, part_of_mesh_only);
  EXPECT_EQ(text_of({{12.2, -80.0, 43.9}, 6.035699, part_of_mesh_only}),
            "The two surfaces differ by up to 6.04 mm near (12, -80, 44): the mesh has a part there that the "
            "voxels "
            "lack.");
}

TEST(CertifyBounded, ReasonsQuoteBothKernelsInRoundedNumbersWithUnits) {
  Certificate certificate;
  add_comparison(certificate, {"volume", "mm3", 768.0, 807.573, 39.573, 12.3456});
  EXPECT_EQ(certificate.verdict, Verdict::Fail);
  EXPECT_EQ(certificate.reasons.back(),
            "The volume is 768 mm3 in the voxel kernel and 808 mm3 in the mesh kernel, 39.6 mm3 apart; "
            "theory allows "
            "12.3 mm3.");
  add_comparison(certificate, {.quantity = "centroid",
                               .unit = "mm",
                               .difference = 0.861389,
                               .tolerance = 0.524624,
                               .statement = "The centroids are % apart"});
  EXPECT_EQ(certificate.reasons.back(), "The centroids are 0.861 mm apart; theory allows 0.525 mm.");
}

TEST(CertifyBounded, StopsWhenAsked) {
  const Pair pair = both_kernels(ball_distance({0, 0, 0}, 8.0), 1.0, 1.0, 12.0);
  std::stop_source source;
  int reports = 0;
  const voxel::Progress progress{source.get_token(), [&](double) {
                                   if (++reports == 3) source.request_stop();
                                 }};
  EXPECT_THROW(certify_bounded(pair.octree, pair.solid, {}, progress), voxel::Stopped);
  EXPECT_EQ(reports, 3);
}

TEST(CertifyBounded, ADifferenceOfMeshesPassesAndItsSwappedOperandsFail) {
  const Pair a = both_kernels(ball_distance({-3, 0.2, 0.1}, 11.0), 1.0, 1.0, 18.0);
  const Pair b = both_kernels(ball_distance({5, 0.4, 0.3}, 9.0), 1.0, 1.0, 18.0);
  const voxel::Octree octree =
      voxel::combine(a.octree.universe(), voxel::Expression(a.octree) - voxel::Expression(b.octree));
  const Pair right{octree, brep::boolean(a.solid, brep::Operation::Difference, b.solid).solid, 1.0};
  EXPECT_EQ(certify(right).verdict, Verdict::Pass) << told(certify(right));
  const Pair swapped{octree, brep::boolean(b.solid, brep::Operation::Difference, a.solid).solid, 1.0};
  EXPECT_EQ(certify(swapped).verdict, Verdict::Fail) << told(certify(swapped));
}

TEST(CertifyBounded, ACutAt45DegreesErrsInStepAndIsAllowedThatNoMore) {
  const Pair a = both_kernels(box_distance({0.2, 0.3, -0.1}, {13, 13, 13}), 1.0, 1.0, 18.0);
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
    const brep::Solid piece =
        brep::boolean(a.solid, brep::Operation::Intersection, brep::solid_of(prism)).solid;
    const Certificate certificate = certify({octree, piece, 1.0});
    EXPECT_EQ(certificate.verdict, Verdict::Pass) << offset_mm << ": " << told(certificate);
    // The twin: the mesh is cut a millimetre further on.
    prism.polygons_mm[0][2].y = prism.polygons_mm[0][3].y = offset_mm + 1.0;
    const brep::Solid wrong =
        brep::boolean(a.solid, brep::Operation::Intersection, brep::solid_of(prism)).solid;
    EXPECT_NE(certify({octree, wrong, 1.0}).verdict, Verdict::Pass) << offset_mm;
  }
}

TEST(CertifyBounded, AFewVoxelsProveNothing) {
  const Certificate certificate = certify(both_kernels(ball_distance({0, 0, 0}, 2.5), 1.0, 1.0, 6.0));
  EXPECT_EQ(certificate.verdict, Verdict::Pass) << told(certificate);
  ASSERT_FALSE(certificate.resolved());
  EXPECT_NEAR(certificate.unresolved->extent_voxels.value(), 4.0, 0.1);
  EXPECT_EQ(verdict_text(certificate),
            "PASS, not resolved: the object's smallest extent is 4 voxels, six are needed");
}

TEST(CertifyBounded, HalfOfAnObjectThatIsNotResolvedMissingDoesNotPass) {
  // A ball of five voxels, a sheet of three and one thinner than a voxel.
  const std::vector<Named> small{{"ball", ball_distance({0.1, 0, 0.2}, 2.5)},
                                 {"sheet", box_distance({0.2, 0.3, 0.1}, {8.2, 9.1, 1.6})},
                                 {"thin sheet", box_distance({0.2, 0.3, 0.1}, {8.2, 9.1, 0.4})}};
  for (const Named& object : small) {
    const Pair whole = both_kernels(object.distance, 1.0, 1.0, 12.0);
    const Certificate right = certify(whole);
    EXPECT_FALSE(right.resolved()) << object.name << ": " << told(right);
    EXPECT_EQ(right.verdict, Verdict::Pass) << object.name << ": " << told(right);
    const Pair half = both_kernels(cut_by(object.distance, {1, 0, 0}, 0.2), 1.0, 1.0, 12.0);
    for (const Pair& spoiled : {Pair{half.octree, whole.solid, 1.0}, Pair{whole.octree, half.solid, 1.0}}) {
      const Certificate wrong = certify(spoiled);
      EXPECT_FALSE(wrong.resolved()) << object.name << ": " << told(wrong);
      EXPECT_NE(wrong.verdict, Verdict::Pass) << object.name << ": " << told(wrong);
    }
  }
}

TEST(CertifyBounded, AFailureOfWhatIsNotResolvedStaysAFailure) {
  Pair pair = both_kernels(ball_distance({0, 0, 0}, 2.5), 1.0, 1.0, 6.0);
  brep::Triangles triangles = pair.solid.triangles();
  for (auto& face : triangles.faces) std::swap(face[0], face[1]);
  pair.solid = brep::trusted_solid(triangles, brep::Proof::Connection);
  const Certificate certificate = certify(pair);
  EXPECT_EQ(certificate.verdict, Verdict::Fail);
  EXPECT_FALSE(certificate.resolved());
  EXPECT_EQ(verdict_text(certificate).substr(0, 20), "FAIL, not resolved: ");
}

TEST(Certificates, AreRankedByVerdictThenByWhetherVoxelsResolveThem) {
  Certificate pass, unresolved, warn, unresolved_fail;
  unresolved.unresolved = unresolved_fail.unresolved = Unresolved{2.0, ""};
  warn.verdict = Verdict::Warn;
  unresolved_fail.verdict = Verdict::Fail;
  EXPECT_TRUE(is_worse(unresolved_fail, warn));
  EXPECT_TRUE(is_worse(warn, pass));
  EXPECT_TRUE(is_worse(pass, unresolved));
  EXPECT_FALSE(is_worse(unresolved, pass));
}

TEST(CertifyBounded, NothingAgreesWithNothingAloneAndProvesNothing) {
  const Pair something = both_kernels(ball_distance({0, 0, 0}, 8.0), 1.0, 1.0, 12.0);
  const voxel::Octree none = voxel::Octree::empty(something.octree.universe());
  const Certificate nothing = certify({none, brep::Solid(), 1.0});
  EXPECT_EQ(nothing.verdict, Verdict::Warn);
  EXPECT_FALSE(nothing.resolved());
  EXPECT_EQ(certify({none, something.solid, 1.0}).verdict, Verdict::Fail);
  EXPECT_EQ(certify({something.octree, brep::Solid(), 1.0}).verdict, Verdict::Fail);
}

}  // namespace
}  // namespace octotomy::verify
