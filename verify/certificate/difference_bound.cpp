// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Bounds the difference of two right answers, an octree and a solid that other code computed.
// boundary_model.cpp has the theory and its symbols; the constants are here. Terms of the volume's bound:
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
// Distances: as surface_distances.h defines them. A face of a right answer lies within half a voxel of the
// surface along the face's axis. Its distance is at most half a voxel's diagonal, and a quarter of an edge on
// average.
#include "verify/certificate/difference_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "brep/mesh/triangles.h"

namespace octotomy::verify {
namespace {

constexpr double coverage = 3.0;
constexpr double bent_share = 0.33;
constexpr double rough_share = 0.12;
constexpr double bent_cap = 0.1;
constexpr double interpolation = 0.06;
constexpr double ripple = 0.03;
constexpr double edge_shift = 0.3;
/// Relative error of a sum of many terms of one sign: some units in the last place in each kernel.
constexpr double rounded_sums = 64.0 * std::numeric_limits<double>::epsilon();

/// Returns the spacings for the curvature integral: those of the samples, limited as stated for `bent` above.
glm::dvec3 seen_spacing_mm(const glm::dvec3& sample_mm, const glm::dvec3& voxel_mm) {
  const double finest_mm = std::min({sample_mm.x, sample_mm.y, sample_mm.z});
  return glm::min(glm::min(sample_mm, 2.0 * voxel_mm), glm::dvec3(3.0 * finest_mm));
}

/// A layer of half a sample on those faces of the mesh that lie on the scan's border. Empty without a
/// scan_box_mm.
VolumeSpread border_of(const brep::Solid& solid, const BoundInputs& inputs, const glm::dvec3& about_mm) {
  VolumeSpread border;
  if (!inputs.scan_box_mm) return border;
  const voxel::Box& box = *inputs.scan_box_mm;
  const double near_mm = on_border_mm(box);
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

/// A layer of the given thickness over the whole mesh.
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

}  // namespace

double longest(const glm::dvec3& edges_mm) {
  return std::max({edges_mm.x, edges_mm.y, edges_mm.z});
}

Evidence evidence_of(const voxel::Octree& octree, const brep::Solid& solid, const BoundInputs& inputs,
                     const voxel::Progress& progress) {
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
  return evidence;
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
      {"border", "Where the scan cuts an object off, the kernels close it up to half a sample apart.",
       "s/2 * area", evidence.border.mm3},
      {"bent", "Triangles are chords of a curved surface.",
       "0.33 |integral of s^2 curvature|, with rough at most 0.1 s S", share * bent_mm3},
      {"rough", "One kernel joins samples that meet diagonally, the other separates them.",
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

double inertia_tolerance_mm5(const Certificate& certificate, const Evidence& evidence, double largest_mm5) {
  const BoundaryModel& model = evidence.model;
  const double arm_mm = 0.5 * glm::length(evidence.mesh.high_mm - evidence.mesh.low_mm);
  // Where displaced planes meet, their errors multiply. The product is smaller than the errors by a voxel
  // over the least extent.
  const glm::dvec3 extent_mm = evidence.mesh.high_mm - evidence.mesh.low_mm;
  const double meeting = 1.0 + longest(evidence.voxel_mm) / std::min({extent_mm.x, extent_mm.y, extent_mm.z});
  return coverage * std::sqrt(model.count_mm10) +
         meeting * (model.planes_without_sign.mm5 + model.unsure.mm5) + evidence.border.mm5 +
         evidence.apart.mm5 + evidence.unseen_mm3 * arm_mm * arm_mm +
         (bent_share + rough_share) * model.bent_without_sign.mm5 +
         evidence.mesh.volume_mm3 * std::pow(certificate.centroid_tolerance_mm.value_or(0.0), 2.0) +
         certificate.terms.back().value_mm3 * arm_mm * arm_mm + rounded_sums * largest_mm5;
}

double area_tolerance_mm2(const Evidence& evidence, double thin_mm2) {
  const BoundaryModel& model = evidence.model;
  return ripple * model.area_mm2 +
         longest(evidence.voxel_mm) * (edge_shift * model.curvature_mm + model.sharp_mm) + model.rims_mm2 +
         thin_mm2;
}

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

double on_border_mm(const voxel::Box& box_mm) {
  return 1e3 * std::numeric_limits<double>::epsilon() *
         glm::length(glm::max(glm::abs(box_mm.low_mm), glm::abs(box_mm.high_mm)));
}

}  // namespace octotomy::verify
