// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Compares an octree with a solid that other code computed, and bounds the difference of two right answers.
// boundary_model.h has the theory and its symbols; the constants are here. The terms of the volume's bound:
//
// count        Three standard deviations of a count. Against closed forms (eight solids in 60 random poses
//              each, spacings 1:1:1 to 5:1:1) the deviation was 0.8 to 1.1 of the predicted one. Narrow cones
//              of normals predict the coherent error of nearly flat parts along the lattice.
// flat         The sum of the displacements of planes and of parts nearly along them, with its sign.
// flat_unsure  Half a voxel for planes through centres, rims, and declared cuts that were not found.
// border       If the solid ends with the scan, the mesh closes half a sample beyond the last one. The voxels
//              end where their samples leave the window, at the last sample or after it. So both ends are up
//              to half a sample apart.
// bent         A mesh's volume is low by c times the signed curvature integral: c is 0.14 for binary samples,
//              0.2 to 0.28 for blurred ones and fractions, 0.32 with edges and corners if voxels are samples.
//              0.33 is used. Between samples further apart than two voxels both kernels interpolate along the
//              same straight lines, so a spacing counts as two voxel edges at most. It counts as three times
//              the finest spacing at most, because crossings of the finer lattice lines fix the facets.
// bent_cap     `bent` and `rough` have no limit on a surface of crumbs, where the bound would then allow any
//              answer. A surface that bends with a radius of three samples errs by 0.33 s^2 / r, about 0.1 s,
//              times its area. A sharper surface is lost as a whole, which must be reported. s is the finest
//              spacing. The area is the smaller one of both answers, so that the roughness of a wrong answer
//              does not widen its own bound.
// rough        In a cell whose inside samples meet diagonally the mesh separates the corners; the interpolant
//              that the octree samples joins some. Not derived: a CT of a head at 0.7 of its sample spacing
//              showed 0.12 of the curvature without sign.
// distances    Where each kernel moved a surface by distances that it measured, the mean errors of both
//              (offset_witness.cpp) times the area.
// rounding     Coordinates have an error of a few units in the last place.
//
// Symmetric difference: errors that cancel in the volume add up here. The terms are 0.06 s S on oblique
// planes between saturated samples (0.02 s S on spheres), 0.33 of the curvature integral without sign, a
// layer for planes through centres, and three standard deviations of the number of voxels in those layers.
// Centroid and inertia: the first and second moment of each error.
// Area: the voxels' Crofton estimate against the same formula on the mesh's triangles, so that flat parts
// have the same error in both. The terms are 3 % of S for ripple (marching cubes adds up to 2.6 % to the
// formula's answer), 0.3 h M for displaced edges with M the mean curvature integral, the further loss of
// voxels at sharp edges, and the strips that displaced planes add beside their rims (boundary_model.cpp
// derives the last two).
// Distances: as surface_distances.h defines them. A face of a right answer lies anywhere within half a voxel
// of the surface along its axis: at most half a voxel's diagonal, a quarter of an edge on average.

#include "verify/certificate/certify_bounded.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

#include "brep/mesh/measure.h"
#include "brep/mesh/triangles.h"
#include "convert/voxel/voxelise.h"
#include "verify/certificate/boundary_model.h"
#include "verify/certificate/necks.h"
#include "verify/certificate/places.h"
#include "verify/certificate/surface_distances.h"
#include "verify/certificate/topology.h"
#include "voxel/measure/measure.h"
#include "voxel/solid/combine.h"
#include "voxel/space/rounded.h"

namespace octotomy::verify {
namespace {

constexpr double coverage = 3.0;
constexpr double bent_share = 0.33;
constexpr double rough_share = 0.12;
constexpr double bent_cap = 0.1;
constexpr double interpolation = 0.06;
constexpr double ripple = 0.03;
constexpr double edge_shift = 0.3;
/// With fewer voxels across, most of the object's voxels are boundary.
constexpr double resolved_voxels = 6.0;
/// Relative error of a sum of many terms of one sign: some units in the last place in each kernel.
constexpr double rounded_sums = 64.0 * std::numeric_limits<double>::epsilon();
/// A surface has no counterpart if the other surface is further away than this multiple of the distance that
/// digitisation explains. Parts thinner than a voxel may be lost over two or three voxels, so the verdict is
/// WARN, not FAIL.
constexpr double lost = 3.0;

double longest(const glm::dvec3& edges_mm) {
  return std::max({edges_mm.x, edges_mm.y, edges_mm.z});
}

/// Spacings for the curvature integral (see `bent` above).
glm::dvec3 seen_spacing_mm(const glm::dvec3& sample_mm, const glm::dvec3& voxel_mm) {
  const double finest_mm = std::min({sample_mm.x, sample_mm.y, sample_mm.z});
  return glm::min(glm::min(sample_mm, 2.0 * voxel_mm), glm::dvec3(3.0 * finest_mm));
}

/// Measures of both answers, and the numbers that the bound is computed from.
struct Evidence {
  voxel::Measures voxels;
  brep::Measures mesh;
  BoundaryModel model;
  glm::dvec3 voxel_mm{1.0};
  glm::dvec3 sample_mm{1.0};  ///< as seen_spacing_mm()
  double voxel_mm3 = 1.0;
  double unseen_mm3 = 0.0;  ///< half a voxel times the area of cuts that were declared and not found
  VolumeSpread border;
  bool witnessed = false;      ///< a witness judges every place separately
  bool totals_decide = false;  ///< the witness judges places more coarsely than totals
  VolumeSpread apart;          ///< between surfaces that each kernel measured for itself
};

/// Adds a comparison of totals. With a witness the verdict is WARN at worst, unless totals decide: a
/// difference that is no error of a kernel in any place comes from resampling or from triangles between
/// samples.
void compare(Certificate& certificate, const Evidence& evidence, Comparison comparison,
             Verdict worst_verdict = Verdict::Fail) {
  add_comparison(certificate, std::move(comparison),
                 evidence.witnessed && !evidence.totals_decide ? Verdict::Warn : worst_verdict);
}

/// Half a sample times the area of the mesh's faces on the scan's border.
VolumeSpread border_of(const brep::Solid& solid, const BoundInputs& inputs, const glm::dvec3& about_mm) {
  VolumeSpread border;
  if (!inputs.scan_box_mm) return border;
  const voxel::Box& box = *inputs.scan_box_mm;
  const double near_mm = 1e3 * std::numeric_limits<double>::epsilon() *
                         glm::length(glm::max(glm::abs(box.low_mm), glm::abs(box.high_mm)));
  const brep::Triangles& triangles = solid.triangles();
  for (const auto& face : triangles.faces) {
    const glm::dvec3 &a = triangles.points_mm[face[0]], &b = triangles.points_mm[face[1]],
                     &c = triangles.points_mm[face[2]];
    for (int axis = 0; axis < 3; ++axis) {
      const auto on = [&](double at) {
        return std::abs(a[axis] - at) < near_mm && std::abs(b[axis] - at) < near_mm &&
               std::abs(c[axis] - at) < near_mm;
      };
      if (!on(box.low_mm[axis]) && !on(box.high_mm[axis])) continue;
      const double area_mm2 = 0.5 * glm::length(glm::cross(b - a, c - a));
      border.add(0.5 * area_mm2 * inputs.scan_spacing_mm[axis], glm::distance((a + b + c) / 3.0, about_mm));
    }
  }
  return border;
}

/// A layer over all of the mesh.
VolumeSpread layer_of(const brep::Solid& solid, double thick_mm, const glm::dvec3& about_mm) {
  VolumeSpread layer;
  if (!(thick_mm > 0.0)) return layer;
  const brep::Triangles& triangles = solid.triangles();
  for (const auto& face : triangles.faces) {
    const glm::dvec3 &a = triangles.points_mm[face[0]], &b = triangles.points_mm[face[1]],
                     &c = triangles.points_mm[face[2]];
    layer.add(0.5 * thick_mm * glm::length(glm::cross(b - a, c - a)),
              glm::distance((a + b + c) / 3.0, about_mm));
  }
  return layer;
}

double count_deviation_mm3(const Evidence& evidence) {
  return std::sqrt(evidence.model.count_mm6);
}

void derive_volume_tolerance(Certificate& certificate, const Evidence& evidence) {
  const BoundaryModel& model = evidence.model;
  const double reach_mm =
      glm::length(glm::max(glm::abs(evidence.mesh.low_mm), glm::abs(evidence.mesh.high_mm)));
  const double bent_mm3 = bent_share * std::abs(model.bent.mm3);
  const double rough_mm3 = rough_share * model.bent_without_sign.mm3;
  const glm::dvec3& s = evidence.sample_mm;
  const double most_mm3 = bent_cap * std::min({s.x, s.y, s.z}) *
                          std::min(evidence.mesh.area_mm2, evidence.voxels.area_crofton13_mm2);
  const double share =
      evidence.witnessed && bent_mm3 + rough_mm3 > most_mm3 ? most_mm3 / (bent_mm3 + rough_mm3) : 1.0;
  certificate.terms = {
      {"count", "Voxels are counted by their centres, which scatters on curved and oblique boundary.",
       "3 sqrt(sum over k of a(k) / (4 pi^2 |k|^4)), about 3 * 0.26 h^2 sqrt(S)",
       coverage * count_deviation_mm3(evidence)},
      {"flat", "Voxels move flat parts along the lattice to the nearest voxel face.",
       "|sum of area * displacement|", std::abs(model.planes.mm3 + model.nearly_planes.mm3)},
      {"flat_unsure",
       "Flat parts through voxel centres, their rims, and cuts that were declared but not found may move "
       "either way.",
       "h/2 * area", model.unsure.mm3 + evidence.unseen_mm3},
      {"border", "The kernels close an object that ends with the scan up to half a sample apart.",
       "s/2 * area", evidence.border.mm3},
      {"bent", "Triangles are chords of a curved surface.",
       "0.33 |integral of s^2 curvature|, with rough at most 0.1 s S", share * bent_mm3},
      {"rough", "One kernel joins samples that meet diagonally, the other parts them.",
       "0.12 * integral of |s^2 curvature|, with bent at most 0.1 s S", share * rough_mm3},
      {"distances", "Each kernel measures distances to its own points of a surface.",
       "mean errors of both distances * S", evidence.apart.mm3},
      // Each of several operations rounds a coordinate by half a unit in the last place.
      {"rounding", "Coordinates are rounded to double precision.", "16 eps |p| S",
       16.0 * std::numeric_limits<double>::epsilon() * reach_mm * evidence.mesh.area_mm2}};
  certificate.tolerance_mm3 = 0.0;
  for (const ToleranceTerm& term : certificate.terms) certificate.tolerance_mm3 += term.value_mm3;
}

void derive_other_tolerances(Certificate& certificate, const Evidence& evidence) {
  const BoundaryModel& model = evidence.model;
  const double free_mm2 = std::max(model.area_mm2 - model.coherent_mm2, 0.0);
  const double layer =
      interpolation * longest(evidence.sample_mm) * free_mm2 + bent_share * model.bent_without_sign.mm3 +
      2.0 * (model.tied_mm3 + evidence.unseen_mm3) + evidence.border.mm3 + evidence.apart.mm3;
  certificate.symmetric_difference_tolerance_mm3 =
      layer + coverage * std::sqrt(layer * evidence.voxel_mm3) + evidence.voxel_mm3;
  if (evidence.mesh.volume_mm3 > 0.0 && model.area_mm2 > 0.0) {
    const double arm_mm = 0.5 * glm::length(evidence.mesh.high_mm - evidence.mesh.low_mm);
    const double mm4 = coverage * std::sqrt(model.count_mm8) +
                       glm::length(model.planes.mm4 + model.nearly_planes.mm4) + model.unsure.mm4 +
                       evidence.unseen_mm3 * arm_mm + evidence.border.mm4 + evidence.apart.mm4 +
                       bent_share * glm::length(model.bent.mm4) + rough_share * model.bent_without_sign.mm4 +
                       certificate.terms.back().value_mm3 * arm_mm;
    certificate.centroid_tolerance_mm = mm4 / evidence.mesh.volume_mm3;
  }
}

/// Inertia about a point at a density of one, by the tetrahedra from the point to each triangle.
glm::dmat3 inertia_about(const brep::Triangles& triangles, const glm::dvec3& about_mm) {
  glm::dmat3 second(0.0);
  for (const auto& face : triangles.faces) {
    const glm::dvec3 a = triangles.points_mm[face[0]] - about_mm, b = triangles.points_mm[face[1]] - about_mm,
                     c = triangles.points_mm[face[2]] - about_mm;
    const double six_mm3 = glm::dot(a, glm::cross(b, c));
    // Over a tetrahedron with a corner at the origin and corners p = a, b, c, the mean of x x' is (sum of
    // p p' + s s') / 20 with s = a + b + c.
    const glm::dvec3 s = a + b + c;
    second += (six_mm3 / 120.0) * (glm::outerProduct(a, a) + glm::outerProduct(b, b) +
                                   glm::outerProduct(c, c) + glm::outerProduct(s, s));
  }
  return glm::dmat3(second[0][0] + second[1][1] + second[2][2]) - second;
}

Comparison area_of(const Evidence& evidence, double thin_mm2) {
  const BoundaryModel& model = evidence.model;
  return {
      "area",
      "mm2",
      evidence.voxels.area_crofton13_mm2,
      model.crofton13_mm2,
      std::abs(evidence.voxels.area_crofton13_mm2 - model.crofton13_mm2),
      ripple * model.area_mm2 +
          longest(evidence.voxel_mm) * (edge_shift * model.curvature_mm + model.sharp_mm) + model.rims_mm2 +
          thin_mm2,
      "0.03 S for ripple, 0.3 h M for edges, more for sharp ones, rims of flat parts, parts thinner than a "
      "voxel; both areas by the Crofton formula of 13 directions"};
}

void compare_inertia(Certificate& certificate, const Evidence& evidence, const brep::Solid& solid) {
  const BoundaryModel& model = evidence.model;
  if (!evidence.voxels.inertia_mm5 || !(evidence.mesh.volume_mm3 > 0.0)) return;
  const glm::dmat3 inertia = inertia_about(solid.triangles(), *evidence.mesh.centroid_mm);
  double most = 0.0, largest = 0.0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      most = std::max(most, std::abs((*evidence.voxels.inertia_mm5)[i][j] - inertia[i][j]));
      largest = std::max(largest, std::abs(inertia[i][j]));
    }
  const double arm_mm = 0.5 * glm::length(evidence.mesh.high_mm - evidence.mesh.low_mm);
  // Where displaced planes meet, the error is of second order in a voxel over the least extent.
  const glm::dvec3 extent_mm = evidence.mesh.high_mm - evidence.mesh.low_mm;
  const double meeting = 1.0 + longest(evidence.voxel_mm) / std::min({extent_mm.x, extent_mm.y, extent_mm.z});
  const double tolerance =
      coverage * std::sqrt(model.count_mm10) + meeting * (model.planes_without_sign.mm5 + model.unsure.mm5) +
      evidence.border.mm5 + evidence.apart.mm5 + evidence.unseen_mm3 * arm_mm * arm_mm +
      (bent_share + rough_share) * model.bent_without_sign.mm5 +
      evidence.mesh.volume_mm3 * std::pow(certificate.centroid_tolerance_mm.value_or(0.0), 2.0) +
      certificate.terms.back().value_mm3 * arm_mm * arm_mm + rounded_sums * largest;
  compare(certificate, evidence,
          {"inertia", "mm5", (*evidence.voxels.inertia_mm5)[0][0], inertia[0][0], most, tolerance,
           "second moment of the terms, V times the centroid's tolerance squared, 64 eps",
           "The inertia tensors differ by up to % in a component"});
}

struct DistanceBounds {
  double percentile95_mm = 0.0, mean_mm = 0.0;
};

DistanceBounds distance_bounds(const Evidence& evidence) {
  const BoundaryModel& model = evidence.model;
  const double apart_mm = 0.1 * longest(evidence.sample_mm);
  const double free_mm2 = std::max(model.area_mm2 - model.coherent_mm2, 0.0);
  const double layers_mm3 = model.planes_without_sign.mm3 + model.tied_mm3 + evidence.unseen_mm3 +
                            model.unsure.mm3 + evidence.border.mm3 + evidence.apart.mm3;
  return {0.5 * glm::length(evidence.voxel_mm) + apart_mm + evidence.apart.mm3 / model.area_mm2,
          0.25 * longest(evidence.voxel_mm) * (1.0 + free_mm2 / model.area_mm2) / 2.0 + apart_mm +
              layers_mm3 / model.area_mm2};
}

/// Compares area and distances; for a resolved object with a witness, on a sample of the surfaces' points.
/// Any other object is searched for parts thinner than a voxel if its distances exceed their bounds, and the
/// certificate then states the lost area.
void compare_surfaces(Certificate& certificate, const Evidence& evidence, const voxel::Octree& octree,
                      const brep::Solid& solid) {
  const bool is_strict = evidence.witnessed && certificate.resolved();
  SurfaceDistances distances(octree, solid, is_strict);
  certificate.hausdorff_mm = distances.largest_mm();
  certificate.hausdorff95_mm = distances.percentile95_mm();
  if (!certificate.worst) certificate.worst = distances.worst();
  const DistanceBounds bounds = distance_bounds(evidence);
  const double far_mm = lost * 0.5 * (glm::length(evidence.voxel_mm) + glm::length(evidence.sample_mm));
  Comparison area = area_of(evidence, 0.0);
  const bool loses_area = evidence.witnessed && *area.mesh - *area.voxel > *area.tolerance;
  const std::string lost_share = voxel::rounded(100.0 * (1.0 - *area.voxel / *area.mesh));
  if (!is_strict &&
      !(area.difference <= *area.tolerance && distances.percentile95_mm() <= bounds.percentile95_mm &&
        distances.mean_mm() <= bounds.mean_mm && distances.largest_mm() <= far_mm))
    area = area_of(evidence, distances.leave_out_thin());
  // Sheets thinner than a voxel lose much area and little volume, so the verdict is WARN at worst.
  compare(certificate, evidence, std::move(area), Verdict::Warn);
  if (loses_area && is_strict)
    certificate.reasons.push_back("At this voxel size " + lost_share +
                                  " % of the surface is lost: of walls and gaps that are thinner than a "
                                  "voxel.");
  if (loses_area && certificate.unresolved)
    certificate.unresolved->reason += ", and " + lost_share + " % of its surface is lost";
  compare(certificate, evidence,
          {.quantity = "hausdorff95",
           .unit = "mm",
           .difference = distances.percentile95_mm(),
           .tolerance = bounds.percentile95_mm,
           .formula = "half a voxel's diagonal + 0.1 s; in doubt, without parts thinner than a voxel",
           .statement = "Five per cent of one surface is % or more from the other"});
  compare(certificate, evidence,
          {.quantity = "mean distance",
           .unit = "mm",
           .difference = distances.mean_mm(),
           .tolerance = bounds.mean_mm,
           .formula = "h/4 on curved boundary + displacement of flats + 0.1 s; in doubt, as above",
           .statement = "The surfaces are % apart on average"});
  if (!evidence.witnessed && distances.largest_mm() > far_mm)
    lower(certificate, Verdict::Warn, text_of(distances.worst()));
}

/// Every place at which the witness contradicts a kernel is an error, because the witness allows for
/// interpolation and rounding. Up to seven voxels, or an equal area of surface, are a WARN, because
/// coordinates on a voxel's centre may cause as much.
void judge_by_witness(Certificate& certificate, const Evidence& evidence, const Places& places) {
  constexpr std::uint64_t doubtful_voxels = 8;
  certificate.limit = places.limit;
  certificate.worst = places.worst;
  const double voxels_mm3 = static_cast<double>(places.voxel_count) * evidence.voxel_mm3;
  const double face_mm2 = std::pow(evidence.voxel_mm3, 2.0 / 3.0);
  const Verdict most = places.voxel_count >= doubtful_voxels || places.stray_mm2 >= doubtful_voxels * face_mm2
                           ? Verdict::Fail
                           : Verdict::Warn;
  add_comparison(certificate,
                 {.quantity = "contradicted voxels",
                  .unit = "mm3",
                  .difference = voxels_mm3,
                  .tolerance = 0.0,
                  .formula = "0: voxels at which the scan and the plan leave a kernel one answer",
                  .statement = "Voxels of % contradict the scan"},
                 most);
  add_comparison(certificate,
                 {.quantity = "stray surface",
                  .unit = "mm2",
                  .difference = places.stray_mm2,
                  .tolerance = 0.0,
                  .formula = "0: triangles where the scan and the plan have a surface",
                  .statement = "Triangles of % lie where the scan has no surface"},
                 most);
}

/// Adds the places of bridges as WARN: the kernels chose differently whether a thin neck connects a part.
void judge_bridges(Certificate& certificate, const Places& places) {
  constexpr std::size_t most_told = 3;
  for (const OpenPart& part : places.open) certificate.bridges.push_back(part.bridge);
  for (std::size_t i = 0; i < std::min(certificate.bridges.size(), most_told); ++i) {
    const WorstPlace& bridge = certificate.bridges[i];
    lower(certificate, Verdict::Warn,
          "An ambiguous bridge near " + voxel::rounded(bridge.at_mm) + ": " + bridge.what + ", " +
              voxel::rounded(bridge.volume_mm3) +
              " mm3, that the other one cuts off. The neck is thinner than " + thin_neck +
              ": decide it by 'keep_bridges_mm' or 'cut_bridges_mm' of the step that chooses parts, "
              "or take smaller voxels.");
  }
  if (certificate.bridges.size() > most_told)
    certificate.reasons.push_back(std::to_string(certificate.bridges.size() - most_told) +
                                  " more parts hang on by such bridges.");
  if (!certificate.bridges.empty() && !certificate.worst) certificate.worst = certificate.bridges.front();
}

/// Sets `unresolved` if the object is too small or too thin. Does not depend on the verdict.
void judge_extent(Certificate& certificate, const Evidence& evidence) {
  double extent_voxels = std::numeric_limits<double>::infinity();
  const auto shorten = [&](const glm::dvec3& extent_mm) {
    for (int axis = 0; axis < 3; ++axis)
      extent_voxels = std::min(extent_voxels, extent_mm[axis] / evidence.voxel_mm[axis]);
  };
  if (evidence.voxels.extents) shorten(evidence.voxels.extents->high_mm - evidence.voxels.extents->low_mm);
  if (evidence.mesh.area_mm2 > 0.0) shorten(evidence.mesh.high_mm - evidence.mesh.low_mm);
  if (extent_voxels < resolved_voxels)
    certificate.unresolved = {extent_voxels, "the object's smallest extent is " +
                                                 voxel::rounded(extent_voxels) + " voxels, six are needed"};
  if (!(evidence.mesh.area_mm2 > 0.0)) return;
  // Twice the volume over the area is a sheet's thickness. Chance decides which voxels lie inside a sheet
  // thinner than a voxel. With the larger volume, the object is thin only if it is thin in both kernels.
  const double larger_mm3 = std::max(std::abs(evidence.mesh.volume_mm3), evidence.voxels.volume_mm3);
  const double thickness_voxels = 2.0 * larger_mm3 / evidence.mesh.area_mm2 / longest(evidence.voxel_mm);
  if (thickness_voxels < std::min(1.0, extent_voxels))
    certificate.unresolved = {thickness_voxels, "the object is " + voxel::rounded(thickness_voxels) +
                                                    " voxels thick on average, one is needed"};
}

void judge_volume(Certificate& certificate, const Evidence& evidence) {
  const voxel::Measures& voxels = evidence.voxels;
  const brep::Measures& mesh = evidence.mesh;
  if (mesh.volume_mm3 < 0.0)
    lower(certificate, Verdict::Fail,
          "The mesh is inside out: its volume is " + voxel::rounded(mesh.volume_mm3) +
              " mm3. Reverse its triangles, or check the frame that it was read in.");
  // A sliver between voxels' centres may be empty for one kernel alone. A witness decides about it if there
  // is one.
  if (!evidence.witnessed && (voxels.voxel_count == 0) != (mesh.area_mm2 == 0.0)) {
    const bool lost_by_voxels = voxels.voxel_count == 0;
    lower(certificate, Verdict::Fail,
          lost_by_voxels ? "The voxel kernel's object is empty, the mesh kernel's is not."
                         : "The mesh kernel's object is empty, the voxel kernel's is not.");
    const glm::dvec3 low_mm = lost_by_voxels ? mesh.low_mm : voxels.extents->low_mm,
                     high_mm = lost_by_voxels ? mesh.high_mm : voxels.extents->high_mm;
    certificate.worst = {0.5 * (low_mm + high_mm), longest(high_mm - low_mm),
                         lost_by_voxels ? part_of_mesh_only : part_of_voxels_only};
  }
  compare(certificate, evidence,
          {"volume", "mm3", voxels.volume_mm3, mesh.volume_mm3, std::abs(certificate.difference_mm3),
           certificate.tolerance_mm3, "sum of the terms"});
  compare(certificate, evidence,
          {.quantity = "symmetric difference",
           .unit = "mm3",
           .difference = certificate.symmetric_difference_mm3,
           .tolerance = certificate.symmetric_difference_tolerance_mm3,
           .formula = "layers of voxels that may differ, and three standard deviations of their number",
           .statement = "Voxels of % are inside for one kernel only"});
  if (certificate.centroid_distance_mm && certificate.centroid_tolerance_mm)
    compare(certificate, evidence,
            {.quantity = "centroid",
             .unit = "mm",
             .difference = *certificate.centroid_distance_mm,
             .tolerance = certificate.centroid_tolerance_mm,
             .formula = "first moment of the terms / volume",
             .statement = "The centroids are % apart"});
}

/// Compares the mesh's volume with the number of voxel centres inside it. Parts that the mesh has several
/// times count once among the centres.
void compare_counted(Certificate& certificate, const Evidence& evidence, const voxel::Octree& digitised) {
  const double counted_mm3 = static_cast<double>(digitised.voxel_count()) * evidence.voxel_mm3;
  add_comparison(
      certificate,
      {"volume counted inside of the mesh", "mm3", counted_mm3, evidence.mesh.volume_mm3,
       std::abs(counted_mm3 - evidence.mesh.volume_mm3), certificate.tolerance_mm3 + evidence.voxel_mm3,
       "the volume's tolerance, and a voxel",
       "The mesh's volume and its inside, counted by voxels' centres, are % apart, as where it has a part "
       "several times"});
}

/// Indices of the keys that share a slot of a hash table with at least eight slots per key: all equal keys,
/// and at most about an eighth of the others.
std::vector<std::uint32_t> in_shared_slots(const std::vector<std::uint64_t>& keys) {
  const std::uint64_t last = std::bit_ceil(8 * keys.size() + 1) - 1;
  std::vector<bool> taken(last + 1, false), shared(last + 1, false);
  for (const std::uint64_t key : keys)
    (taken[(key >> 32) & last] ? shared : taken)[(key >> 32) & last] = true;
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < keys.size(); ++i)
    if (shared[(keys[i] >> 32) & last]) found.push_back(i);
  return found;
}

/// Adds the area of triangles that the mesh has a second time with the same winding; a set of voxels cannot
/// show them. Equal triangles are found by a hash of their corners. Among a million triangles two different
/// ones have the same hash with a probability of 2^-24.
void compare_repeated(Certificate& certificate, const brep::Triangles& mesh) {
  const auto hash = [](const glm::dvec3& p) {
    std::uint64_t made = 0;
    for (int axis = 0; axis < 3; ++axis)
      made = (std::rotl(made, 21) ^ std::bit_cast<std::uint64_t>(p[axis] + 0.0)) * 0x9E3779B97F4A7C15ULL;
    return made ^ (made >> 29);
  };
  std::vector<std::uint64_t> keys(mesh.faces.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, keys.size(), 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      std::array<std::uint64_t, 3> corners{};
      for (std::size_t k = 0; k < 3; ++k) corners[k] = hash(mesh.points_mm[mesh.faces[i][k]]);
      // Start at the corner with the smallest hash; the winding does not change.
      std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
      for (const std::uint64_t corner : corners)
        keys[i] = (std::rotl(keys[i], 17) ^ corner) * 0xBF58476D1CE4E5B9ULL;
    }
  });
  double area_mm2 = 0.0;
  std::vector<std::uint32_t> shared = in_shared_slots(keys);
  std::stable_sort(shared.begin(), shared.end(),
                   [&](std::uint32_t i, std::uint32_t j) { return keys[i] < keys[j]; });
  for (std::size_t i = 1; i < shared.size(); ++i) {
    if (keys[shared[i]] != keys[shared[i - 1]]) continue;
    const auto& [a, b, c] = mesh.faces[shared[i]];
    area_mm2 += 0.5 * glm::length(glm::cross(mesh.points_mm[b] - mesh.points_mm[a],
                                             mesh.points_mm[c] - mesh.points_mm[a]));
  }
  add_comparison(certificate, {.quantity = "repeated surface",
                               .unit = "mm2",
                               .difference = area_mm2,
                               .tolerance = 0.0,
                               .formula = "0: no triangle is there twice",
                               .statement = "Triangles of % are there several times in the mesh"});
}

/// Compares amounts measured along lines with both answers. If the answers agree with each other and not with
/// the lines, both are wrong.
void compare_with_lines(Certificate& certificate, const Evidence& evidence, const LineReading& lines,
                        const voxel::Box& world, const voxel::Progress& progress) {
  if (!lines) return;
  LineCountOptions options;
  options.world_mm = world;
  options.progress.stop = progress.stop;
  certificate.third = count_along_lines(lines, options);
  const LineCount& third = *certificate.third;
  // The mean over twelve directions is off by more than five estimated deviations in one of 2000 objects.
  constexpr double sure = 5.0;
  const double tolerance_mm3 = certificate.tolerance_mm3 + sure * third.deviation_mm3 + evidence.voxel_mm3;
  const double of_voxels = std::abs(evidence.voxels.volume_mm3 - third.volume_mm3);
  const double of_mesh = std::abs(evidence.mesh.volume_mm3 - third.volume_mm3);
  const bool both_stray = std::min(of_voxels, of_mesh) > tolerance_mm3;
  add_comparison(certificate, {"volume by lines", "mm3", third.volume_mm3,
                               of_voxels < of_mesh ? evidence.voxels.volume_mm3 : evidence.mesh.volume_mm3,
                               std::min(of_voxels, of_mesh), tolerance_mm3,
                               "the volume's tolerance, five deviations of the lines, and a voxel",
                               "Lines through the scan find " + voxel::rounded(third.volume_mm3) +
                                   " mm3, from which the nearer answer is % off"});
  if (both_stray || std::abs(certificate.difference_mm3) <= certificate.tolerance_mm3) return;
  const auto told = [&](const char* kernel, double volume_mm3) {
    const double lost_mm3 = third.volume_mm3 - volume_mm3;
    const double share = 100.0 * std::abs(lost_mm3) / std::max(third.volume_mm3, volume_mm3);
    certificate.reasons.push_back("The scan's own samples have " + voxel::rounded(third.volume_mm3) +
                                  " mm3 along lines: " + kernel +
                                  (lost_mm3 > 0.0 ? voxel::rounded(share) + " % of this tissue."
                                                  : voxel::rounded(share) + " % too much."));
  };
  if (of_voxels > of_mesh)
    told(evidence.voxels.volume_mm3 < third.volume_mm3 ? "at this voxel size resampling loses "
                                                       : "at this voxel size resampling adds ",
         evidence.voxels.volume_mm3);
  else
    told(evidence.mesh.volume_mm3 < third.volume_mm3
             ? "the mesh, whose triangles pass over what lies between two samples, loses "
             : "the mesh has ",
         evidence.mesh.volume_mm3);
}

}  // namespace

Certificate certify_bounded(const voxel::Octree& octree, const brep::Solid& solid, const BoundInputs& inputs,
                            const voxel::Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const voxel::Lattice lattice = octree.universe().lattice();
  Evidence evidence;
  evidence.witnessed = static_cast<bool>(inputs.witness);
  progress.at(0.0);
  evidence.voxels = inputs.voxel_measures ? *inputs.voxel_measures : voxel::measure(octree);
  progress.at(0.1);
  evidence.mesh = solid.measures();
  evidence.voxel_mm = lattice.spacing_mm();
  evidence.voxel_mm3 = lattice.voxel_mm3();
  evidence.sample_mm = seen_spacing_mm(inputs.scan_spacing_mm, evidence.voxel_mm);
  const glm::dvec3 about_mm =
      evidence.mesh.centroid_mm.value_or(0.5 * (evidence.mesh.low_mm + evidence.mesh.high_mm));
  progress.at(0.2);
  evidence.model = boundary_model(solid, {lattice, evidence.sample_mm, about_mm});
  evidence.border = border_of(solid, inputs, about_mm);
  evidence.apart = layer_of(solid, inputs.measured_apart_mm, about_mm);
  evidence.totals_decide = inputs.measured_apart_mm > 0.0;
  evidence.unseen_mm3 = glm::dot(glm::max(inputs.flat_cut_mm2 - evidence.model.flat_mm2, glm::dvec3(0.0)),
                                 0.5 * evidence.voxel_mm);

  Certificate certificate;
  certificate.operation = inputs.operation;
  certificate.tier = Tier::Bounded;
  certificate.voxel = {inputs.voxel_lineage, evidence.voxels.volume_mm3, evidence.voxels.area_crofton13_mm2,
                       evidence.voxels.centroid_mm};
  certificate.mesh = {inputs.mesh_lineage, evidence.mesh.volume_mm3, evidence.mesh.area_mm2,
                      evidence.mesh.centroid_mm};
  certificate.difference_mm3 = evidence.voxels.volume_mm3 - evidence.mesh.volume_mm3;
  derive_volume_tolerance(certificate, evidence);
  derive_other_tolerances(certificate, evidence);
  progress.at(0.4);
  const voxel::Octree digitised = convert::voxelise(octree.universe(), solid.linked());
  const voxel::Octree either =
      voxel::combine(octree.universe(), voxel::Expression(octree) ^ voxel::Expression(digitised));
  certificate.symmetric_difference_mm3 = static_cast<double>(either.voxel_count()) * evidence.voxel_mm3;
  if (evidence.voxels.centroid_mm && evidence.mesh.centroid_mm)
    certificate.centroid_distance_mm = glm::length(*evidence.voxels.centroid_mm - *evidence.mesh.centroid_mm);
  if (evidence.witnessed) {
    const Places places = judge_places(octree, digitised, solid, inputs.witness, {progress.stop, {}});
    judge_by_witness(certificate, evidence, places);
    judge_bridges(certificate, places);
  }
  judge_volume(certificate, evidence);
  if (evidence.witnessed) compare_counted(certificate, evidence, digitised);
  compare_repeated(certificate, solid.triangles());
  compare_with_lines(certificate, evidence, inputs.witness.lines(), voxel::bounds(lattice), progress);
  progress.at(0.45);
  compare_topology(certificate, octree, digitised);
  judge_extent(certificate, evidence);
  if (!octree.is_empty() && evidence.mesh.area_mm2 > 0.0) {
    progress.at(0.5);
    compare_surfaces(certificate, evidence, octree, solid);
    progress.at(0.9);
    compare_inertia(certificate, evidence, solid);
    if (inputs.voxels_are_samples) compare_same_topology(certificate, octree, solid);
  }
  judge_evidence(certificate);
  // The search for parts that both kernels lack samples one voxel in each block of two voxels a side, so it
  // may miss a part of up to eight voxels.
  if (!inputs.is_surely_empty)
    judge_emptiness(certificate, 8.0 * evidence.voxel_mm3);
  else if (!octree.is_empty() || !solid.empty())
    lower(certificate, Verdict::Fail, "The object must be empty, and an answer is not.");
  const auto has_place = [&](const std::string& reason) { return reason.rfind("The two surfaces", 0) == 0; };
  if (certificate.verdict != Verdict::Pass && certificate.worst &&
      std::none_of(certificate.reasons.begin(), certificate.reasons.end(), has_place))
    certificate.reasons.push_back(text_of(*certificate.worst));
  progress.at(1.0);
  certificate.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return certificate;
}

}  // namespace octotomy::verify
