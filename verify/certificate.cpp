// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Compares an octree with a solid of another lineage, as a metrologist would: what is the largest difference
// that two right answers may show? boundary_model.h has the theory and its symbols; here are the constants.
//
// count      Three standard deviations of a count. Against closed forms 60 seeds each of eight solids, turned
//            by chance, at spacings 1:1:1 to 5:1:1, showed 0.8 to 1.1 of the deviation predicted; along the
//            lattice, where nearly flat parts err in step, narrow cones predict that.
// flat       The sum of planes' displacements, as it is.
// flat_unsure  Planes through centres, rims, cuts that were declared and are not seen (h / 2 each).
// border     Where the solid ends with the scan the mesh closes half a sample beyond the last, and the voxels
//            end where their samples leave the window, at the last or after it: up to half a sample apart.
// bent       A mesh's volume is low by c times the signed curvature integral, c from 0.14 (samples that are
//            0 or 1) over 0.2 to 0.28 (blurred, fractions) to 0.32 (with edges and corners) where voxels are
//            samples: 0.33 of it. Between samples further apart than two voxels both kernels follow the same
//            straight lines along the lattice, so spacings count up to twice a voxel's edge only; and up to
//            three times the finest, as the crossings of the finer lattice lines hold the facets.
// rough      Cells in which samples of both sides meet diagonally: the mesh keeps the inside corners apart,
//            the interpolant that the octree samples joins some. Not derived: 0.12 of the curvature without
//            sign is what a CT of a head at 0.7 of its sample spacing showed.
// rounding   Coordinates are good to a few units in the last place.
//
// The symmetric difference counts what cancels in the volume: 0.06 s S on oblique planes between saturated
// samples (0.02 s S on spheres), 0.33 of the curvature integral without sign, a layer where planes go through
// centres, and three standard deviations of the count of voxels in those layers. The centroid moves by the
// first moment of each error over the volume; second moments by the second. Area: the voxels' Crofton answer
// is held against what the formula gives for the mesh's own triangles, so that the loss on flats is on both
// sides; 3 % of S for ripple (marching cubes adds up to 2.6 % to the response), 0.3 h M for edges displaced,
// M the mean curvature integral, and what displaced planes add beside their rims.
//
// Distances: centres of the octree's boundary faces to the triangles, and points spread over the triangles to
// the boundary faces; each weighted by its area. The 95th percentile is the smallest distance that at least
// 95 % of that area does not exceed; of the two directions the larger is given. A right face lies evenly
// within half a voxel of the surface along its axis: at most half a voxel's diagonal, a quarter of an edge in
// the mean; flats where counting puts them.

#include "verify/certificate.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "brep/components.h"
#include "brep/distance.h"
#include "brep/health.h"
#include "brep/measure.h"
#include "brep/sample_surface.h"
#include "brep/triangles.h"
#include "convert/voxelise.h"
#include "verify/boundary_model.h"
#include "verify/voxel_boundary.h"
#include "voxel/cell_counts.h"
#include "voxel/combine.h"
#include "voxel/components.h"
#include "voxel/measure.h"

namespace octotomy::verify {
namespace {

constexpr double coverage = 3.0;
constexpr double bent_share = 0.33;
constexpr double rough_share = 0.12;
constexpr double interpolation = 0.06;
constexpr double ripple = 0.03;
constexpr double edge_shift = 0.3;
/// A difference up to so many tolerances is doubtful, beyond it wrong: a normal error of three standard
/// deviations that is met six deviations off is no accident.
constexpr double doubt = 2.0;
/// Fewer voxels across and the boundary's voxels are most of the object.
constexpr double resolved_voxels = 6.0;
/// Of sums of many terms of one sign, as a share: some units in the last place of each of both kernels' sums.
constexpr double rounded_sums = 64.0 * std::numeric_limits<double>::epsilon();
/// The mesh is sampled this densely: an isosurface's triangles are smaller and have one sample each.
constexpr double sample_voxels = 2.0;
/// A surface so many times further away than digitisation explains has no counterpart. What is thinner than a
/// voxel may be lost in one of them for two or three voxels, so this is a doubt and not a failure.
constexpr double lost = 3.0;

double longest(const glm::dvec3& edges_mm) {
  return std::max({edges_mm.x, edges_mm.y, edges_mm.z});
}

/// Spacings as the curvature integral takes them, see above: up to twice a voxel's edge and three times the
/// finest.
glm::dvec3 seen_spacing_mm(const glm::dvec3& sample_mm, const glm::dvec3& voxel_mm) {
  const double finest_mm = std::min({sample_mm.x, sample_mm.y, sample_mm.z});
  return glm::min(glm::min(sample_mm, 2.0 * voxel_mm), glm::dvec3(3.0 * finest_mm));
}

/// Distances with the area that each stands for.
struct Weighted {
  std::vector<double> distances_mm, areas_mm2;

  double largest() const {
    return distances_mm.empty() ? 0.0 : *std::max_element(distances_mm.begin(), distances_mm.end());
  }
  double mean() const {
    double sum = 0.0, area = 0.0;
    for (std::size_t i = 0; i < distances_mm.size(); ++i) {
      sum += distances_mm[i] * areas_mm2[i];
      area += areas_mm2[i];
    }
    return area > 0.0 ? sum / area : 0.0;
  }
  double percentile95() const {
    std::vector<std::size_t> order(distances_mm.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return distances_mm[a] < distances_mm[b]; });
    const double total = std::accumulate(areas_mm2.begin(), areas_mm2.end(), 0.0);
    double reached = 0.0;
    for (const std::size_t i : order) {
      reached += areas_mm2[i];
      if (reached >= 0.95 * total) return distances_mm[i];
    }
    return largest();
  }
};

/// The boundary faces as two triangles each, and their centres.
struct Boundary {
  brep::Triangles triangles;
  std::vector<glm::dvec3> centres_mm;
  std::vector<double> areas_mm2;
};

Boundary boundary_of(const voxel::Octree& octree) {
  const voxel::Lattice lattice = octree.universe().lattice();
  Boundary boundary;
  for (const VoxelFace& face : voxel_boundary(octree)) {
    const int u = (face.axis + 1) % 3, v = (face.axis + 2) % 3;
    glm::dvec3 centre(face.voxel);
    centre[face.axis] += 0.5 * face.side;
    const auto first = static_cast<std::uint32_t>(boundary.triangles.points_mm.size());
    for (const glm::dvec2& corner : {glm::dvec2(-0.5, -0.5), {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
      glm::dvec3 p = centre;
      p[u] += corner.x;
      p[v] += corner.y;
      boundary.triangles.points_mm.push_back(lattice.lps_mm(p));
    }
    boundary.triangles.faces.push_back({first, first + 1, first + 2});
    boundary.triangles.faces.push_back({first, first + 2, first + 3});
    boundary.centres_mm.push_back(lattice.lps_mm(centre));
    boundary.areas_mm2.push_back(glm::length(
        glm::cross(glm::dvec3(lattice.lps_from_voxel[u]), glm::dvec3(lattice.lps_from_voxel[v]))));
  }
  return boundary;
}

/// Both directions: voxel faces to triangles, points spread over the triangles to voxel faces.
struct Distances {
  Weighted from_voxels, from_mesh;
  brep::SurfaceSamples samples;  ///< of the mesh
  double mean_mm() const { return std::max(from_voxels.mean(), from_mesh.mean()); }
  double percentile95_mm() const { return std::max(from_voxels.percentile95(), from_mesh.percentile95()); }
  double largest_mm() const { return std::max(from_voxels.largest(), from_mesh.largest()); }
};

Distances surface_distances(const voxel::Octree& octree, const brep::Mesh& mesh) {
  const Boundary boundary = boundary_of(octree);
  Distances distances;
  distances.from_voxels = {brep::SurfaceTree(mesh).distances_mm(boundary.centres_mm), boundary.areas_mm2};
  distances.samples =
      brep::sample_surface(mesh, sample_voxels * longest(octree.universe().lattice().spacing_mm()));
  distances.from_mesh = {brep::SurfaceTree(boundary.triangles).distances_mm(distances.samples.points_mm),
                         distances.samples.areas_mm2};
  return distances;
}

/// Leaves out of the mesh's side what voxels cannot show, sheets and gaps thinner than a voxel; answers its
/// area. A slab holds a centre next to each of its points if it is as wide as a voxel's shadow on its normal.
double leave_out_thin(Distances& distances, const brep::Mesh& mesh, const voxel::Lattice& lattice) {
  const brep::SurfaceSamples& samples = distances.samples;
  std::vector<glm::dvec3> within_mm, beyond_mm;
  for (std::size_t i = 0; i < samples.points_mm.size(); ++i) {
    double shadow_mm = 0.0;
    for (int axis = 0; axis < 3; ++axis)
      shadow_mm += std::abs(glm::dot(glm::dvec3(lattice.lps_from_voxel[axis]), samples.normals[i]));
    within_mm.push_back(samples.points_mm[i] - shadow_mm * samples.normals[i]);
    beyond_mm.push_back(samples.points_mm[i] + shadow_mm * samples.normals[i]);
  }
  const brep::SurfaceTree tree(mesh);
  const std::vector<std::uint8_t> thick = tree.inside(within_mm), closing = tree.inside(beyond_mm);
  double thin_mm2 = 0.0;
  Weighted kept;
  for (std::size_t i = 0; i < thick.size(); ++i) {
    if (!thick[i] || closing[i]) {
      thin_mm2 += samples.areas_mm2[i];
      continue;
    }
    kept.distances_mm.push_back(distances.from_mesh.distances_mm[i]);
    kept.areas_mm2.push_back(samples.areas_mm2[i]);
  }
  distances.from_mesh = std::move(kept);
  return thin_mm2;
}

/// Both answers and what they are judged by.
struct Evidence {
  voxel::Measures voxels;
  brep::Measures mesh;
  BoundaryModel model;
  glm::dvec3 voxel_mm{1.0};
  glm::dvec3 sample_mm{1.0};  ///< as far apart as voxels can tell
  double voxel_mm3 = 1.0;
  double unseen_mm3 = 0.0;  ///< cuts that were declared and are not seen
  VolumeSpread border;
};

/// The mesh's faces on the box that the scan's voxels fill, by half a sample each way.
VolumeSpread border_of(const brep::Mesh& mesh, const BoundInputs& inputs, const glm::dvec3& about_mm) {
  VolumeSpread border;
  if (!inputs.scan_box_mm) return border;
  const voxel::Box& box = *inputs.scan_box_mm;
  const double near_mm = 1e3 * std::numeric_limits<double>::epsilon() *
                         glm::length(glm::max(glm::abs(box.low_mm), glm::abs(box.high_mm)));
  const brep::Triangles triangles = brep::triangles_of(mesh);
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

double count_deviation_mm3(const Evidence& evidence) {
  return std::sqrt(evidence.model.count_mm6);
}

void derive_volume_tolerance(Certificate& certificate, const Evidence& evidence) {
  const BoundaryModel& model = evidence.model;
  const double reach_mm =
      glm::length(glm::max(glm::abs(evidence.mesh.low_mm), glm::abs(evidence.mesh.high_mm)));
  certificate.terms = {
      {"count", "3 * sqrt(sum of a(k) / (4 pi^2 |k|^4)), about 3 * 0.26 h^2 sqrt(S)",
       coverage * count_deviation_mm3(evidence)},
      {"flat", "|sum of area * displacement to the nearest voxel face|", std::abs(model.planes.mm3)},
      {"flat_unsure", "h/2 * area of planes through voxel centres or not seen, and rims",
       model.unsure.mm3 + evidence.unseen_mm3},
      {"border", "s/2 * area where the scan ends", evidence.border.mm3},
      {"bent", "0.33 |integral of s^2 curvature|", bent_share * std::abs(model.bent.mm3)},
      {"rough", "0.12 * integral of |s^2 curvature|", rough_share * model.bent_without_sign.mm3},
      // Each coordinate is off by half a unit in the last place, some operations each.
      {"rounding", "16 eps |p| S",
       16.0 * std::numeric_limits<double>::epsilon() * reach_mm * evidence.mesh.area_mm2}};
  certificate.tolerance_mm3 = 0.0;
  for (const ToleranceTerm& term : certificate.terms) certificate.tolerance_mm3 += term.value_mm3;
}

void derive_other_tolerances(Certificate& certificate, const Evidence& evidence) {
  const BoundaryModel& model = evidence.model;
  const double free_mm2 = std::max(model.area_mm2 - model.coherent_mm2, 0.0);
  const double layer = interpolation * longest(evidence.sample_mm) * free_mm2 +
                       bent_share * model.bent_without_sign.mm3 +
                       2.0 * (model.tied_mm3 + evidence.unseen_mm3) + evidence.border.mm3;
  certificate.symmetric_difference_tolerance_mm3 =
      layer + coverage * std::sqrt(layer * evidence.voxel_mm3) + evidence.voxel_mm3;
  if (evidence.mesh.volume_mm3 > 0.0 && model.area_mm2 > 0.0) {
    const double arm_mm = 0.5 * glm::length(evidence.mesh.high_mm - evidence.mesh.low_mm);
    const double mm4 = coverage * std::sqrt(model.count_mm8) + glm::length(model.planes.mm4) +
                       model.unsure.mm4 + evidence.unseen_mm3 * arm_mm + evidence.border.mm4 +
                       bent_share * glm::length(model.bent.mm4) + rough_share * model.bent_without_sign.mm4 +
                       certificate.terms.back().value_mm3 * arm_mm;
    certificate.centroid_tolerance_mm = mm4 / evidence.mesh.volume_mm3;
  }
}

/// Inertia about the centroid at a density of one, by tetrahedra from there to each triangle.
glm::dmat3 inertia_about(const brep::Triangles& triangles, const glm::dvec3& about_mm) {
  glm::dmat3 second(0.0);
  for (const auto& face : triangles.faces) {
    const glm::dvec3 a = triangles.points_mm[face[0]] - about_mm, b = triangles.points_mm[face[1]] - about_mm,
                     c = triangles.points_mm[face[2]] - about_mm;
    const double six_mm3 = glm::dot(a, glm::cross(b, c));
    // Over a tetrahedron with a corner at the origin the mean of x x' is (sum of p p' + s s') / 20, s =
    // a+b+c.
    const glm::dvec3 s = a + b + c;
    second += (six_mm3 / 120.0) * (glm::outerProduct(a, a) + glm::outerProduct(b, b) +
                                   glm::outerProduct(c, c) + glm::outerProduct(s, s));
  }
  return glm::dmat3(second[0][0] + second[1][1] + second[2][2]) - second;
}

Comparison area_of(const Evidence& evidence, double thin_mm2) {
  const BoundaryModel& model = evidence.model;
  return {"area",
          "mm2",
          evidence.voxels.area_crofton13_mm2,
          model.crofton13_mm2,
          std::abs(evidence.voxels.area_crofton13_mm2 - model.crofton13_mm2),
          ripple * model.area_mm2 + edge_shift * longest(evidence.voxel_mm) * model.curvature_mm +
              model.rims_mm2 + thin_mm2,
          "0.03 S + 0.3 h M + rims + area of what is thinner than a voxel; both by the Crofton formula of 13 "
          "directions"};
}

void compare_inertia(Certificate& certificate, const Evidence& evidence, const brep::Mesh& solid) {
  const BoundaryModel& model = evidence.model;
  if (!evidence.voxels.inertia_mm5 || !(evidence.mesh.volume_mm3 > 0.0)) return;
  const glm::dmat3 inertia = inertia_about(brep::triangles_of(solid), *evidence.mesh.centroid_mm);
  double most = 0.0, largest = 0.0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      most = std::max(most, std::abs((*evidence.voxels.inertia_mm5)[i][j] - inertia[i][j]));
      largest = std::max(largest, std::abs(inertia[i][j]));
    }
  const double arm_mm = 0.5 * glm::length(evidence.mesh.high_mm - evidence.mesh.low_mm);
  // Displaced planes meet: second order in a voxel over the least extent.
  const glm::dvec3 extent_mm = evidence.mesh.high_mm - evidence.mesh.low_mm;
  const double meeting = 1.0 + longest(evidence.voxel_mm) / std::min({extent_mm.x, extent_mm.y, extent_mm.z});
  const double tolerance =
      coverage * std::sqrt(model.count_mm10) + meeting * (model.planes_without_sign.mm5 + model.unsure.mm5) +
      evidence.border.mm5 + evidence.unseen_mm3 * arm_mm * arm_mm +
      (bent_share + rough_share) * model.bent_without_sign.mm5 +
      evidence.mesh.volume_mm3 * std::pow(certificate.centroid_tolerance_mm.value_or(0.0), 2.0) +
      certificate.terms.back().value_mm3 * arm_mm * arm_mm + rounded_sums * largest;
  add_comparison(certificate,
                 {"inertia", "mm5", (*evidence.voxels.inertia_mm5)[0][0], inertia[0][0], most, tolerance,
                  "second moment of the terms, V * centroid's ^ 2, 64 eps; largest component of the tensors' "
                  "difference"});
}

struct DistanceBounds {
  double percentile95_mm = 0.0, mean_mm = 0.0;
};

DistanceBounds distance_bounds(const Evidence& evidence) {
  const BoundaryModel& model = evidence.model;
  const double apart_mm = 0.1 * longest(evidence.sample_mm);
  const double free_mm2 = std::max(model.area_mm2 - model.coherent_mm2, 0.0);
  const double layers_mm3 = model.planes_without_sign.mm3 + model.tied_mm3 + evidence.unseen_mm3 +
                            model.unsure.mm3 + evidence.border.mm3;
  return {0.5 * glm::length(evidence.voxel_mm) + apart_mm,
          0.25 * longest(evidence.voxel_mm) * (1.0 + free_mm2 / model.area_mm2) / 2.0 + apart_mm +
              layers_mm3 / model.area_mm2};
}

/// Area and distances. What is thinner than a voxel is looked for only where they leave a doubt.
void compare_surfaces(Certificate& certificate, const Evidence& evidence, const voxel::Octree& octree,
                      const brep::Mesh& solid) {
  Distances distances = surface_distances(octree, solid);
  certificate.hausdorff_mm = distances.largest_mm();
  certificate.hausdorff95_mm = distances.percentile95_mm();
  const DistanceBounds bounds = distance_bounds(evidence);
  const double far_mm = lost * 0.5 * (glm::length(evidence.voxel_mm) + glm::length(evidence.sample_mm));
  Comparison area = area_of(evidence, 0.0);
  if (!(area.difference <= *area.tolerance && distances.percentile95_mm() <= bounds.percentile95_mm &&
        distances.mean_mm() <= bounds.mean_mm && distances.largest_mm() <= far_mm))
    area = area_of(evidence, leave_out_thin(distances, solid, octree.universe().lattice()));
  // Sheets thinner than a voxel lose their area before their volume shows it: a doubt, whatever its size.
  if (!(area.difference <= *area.tolerance)) {
    area.agreement = Agreement::Warn;
    lower(certificate, Agreement::Warn,
          "area differs by " + std::to_string(area.difference) + " mm2 where theory allows " +
              std::to_string(*area.tolerance));
  }
  certificate.comparisons.push_back(std::move(area));
  add_comparison(certificate,
                 {"hausdorff95",
                  "mm",
                  {},
                  {},
                  distances.percentile95_mm(),
                  bounds.percentile95_mm,
                  "half a voxel's diagonal + 0.1 s; in doubt, without what is thinner than a voxel"});
  add_comparison(certificate, {"mean distance",
                               "mm",
                               {},
                               {},
                               distances.mean_mm(),
                               bounds.mean_mm,
                               "h/4 on curved boundary + displacement of flats + 0.1 s; in doubt, as above"});
  if (distances.largest_mm() > far_mm)
    lower(certificate, Agreement::Warn,
          "a part of one surface is " + std::to_string(distances.largest_mm()) +
              " mm from the other: it may be missing there");
}

/// Where voxels are the mesh's samples both must be of one topology: the mesh keeps inside corners apart that
/// meet at edges and corners, and outside corners that meet at a cell's corners only. The voxels' number by
/// faces joins those last, a tunnel each.
void compare_topology(Certificate& certificate, const voxel::Octree& octree, const brep::Mesh& solid) {
  std::int64_t solid_euler = voxel::euler_numbers(octree).by_faces;
  const std::array<std::uint64_t, 256> cells = voxel::cell_counts(octree);
  for (unsigned corner = 0; corner < 4; ++corner)
    solid_euler += static_cast<std::int64_t>(cells[255U - (1U << corner) - (1U << (7U - corner))]);
  const auto twice = 2.0 * static_cast<double>(solid_euler);
  const auto surface = static_cast<double>(brep::health(brep::triangles_of(solid), {false}).euler);
  add_comparison(certificate, {"euler", "", twice, surface, std::abs(twice - surface), 0.0,
                               "0: one topology; twice the voxels' number beside the surface's"});
  const auto parts = static_cast<double>(voxel::components(octree).voxel_counts.size());
  const std::vector<brep::Component> shells = brep::components(solid);
  const auto solids = static_cast<double>(std::count_if(
      shells.begin(), shells.end(), [](const brep::Component& shell) { return shell.volume_mm3 > 0.0; }));
  add_comparison(certificate, {"components", "", parts, solids, std::abs(parts - solids), 0.0,
                               "0: voxels that touch by faces beside outer shells"});
}

void judge_extent(Certificate& certificate, const Evidence& evidence) {
  double extent_voxels = std::numeric_limits<double>::infinity();
  const auto shorten = [&](const glm::dvec3& extent_mm) {
    for (int axis = 0; axis < 3; ++axis)
      extent_voxels = std::min(extent_voxels, extent_mm[axis] / evidence.voxel_mm[axis]);
  };
  if (evidence.voxels.extents) shorten(evidence.voxels.extents->high_mm - evidence.voxels.extents->low_mm);
  if (evidence.mesh.area_mm2 > 0.0) shorten(evidence.mesh.high_mm - evidence.mesh.low_mm);
  // Twice the volume over the area is a sheet's thickness. Of one thinner than a voxel, chance decides which
  // voxels are inside, if any. Both kernels must say that it is thin.
  const double larger_mm3 = std::max(std::abs(evidence.mesh.volume_mm3), evidence.voxels.volume_mm3);
  if (evidence.mesh.area_mm2 > 0.0 &&
      2.0 * larger_mm3 < longest(evidence.voxel_mm) * evidence.mesh.area_mm2) {
    certificate.agreement = Agreement::BelowResolution;
    certificate.reasons.emplace_back("it is " + std::to_string(2.0 * larger_mm3 / evidence.mesh.area_mm2) +
                                     " mm thick on average, less than a voxel");
  }
  if (extent_voxels >= resolved_voxels) return;
  certificate.agreement = Agreement::BelowResolution;
  certificate.reasons.emplace_back("the smallest extent is " + std::to_string(extent_voxels) +
                                   " voxels; six are needed for agreement to prove anything");
}

void judge_volume(Certificate& certificate, const Evidence& evidence) {
  const voxel::Measures& voxels = evidence.voxels;
  const brep::Measures& mesh = evidence.mesh;
  if (mesh.volume_mm3 < 0.0)
    lower(certificate, Agreement::Fail, "the mesh is turned inside out: its volume is negative");
  if ((voxels.voxel_count == 0) != (mesh.area_mm2 == 0.0))
    lower(certificate, Agreement::Fail,
          voxels.voxel_count == 0 ? "the octree is empty, the mesh is not"
                                  : "the mesh is empty, the octree is not");
  add_comparison(certificate,
                 {"volume", "mm3", voxels.volume_mm3, mesh.volume_mm3, std::abs(certificate.difference_mm3),
                  certificate.tolerance_mm3, "sum of the terms"});
  add_comparison(certificate, {"symmetric difference",
                               "mm3",
                               {},
                               {},
                               certificate.symmetric_difference_mm3,
                               certificate.symmetric_difference_tolerance_mm3,
                               "layers of voxels that may differ, and 3 sqrt of their number"});
  if (certificate.centroid_distance_mm && certificate.centroid_tolerance_mm)
    add_comparison(certificate, {"centroid",
                                 "mm",
                                 {},
                                 {},
                                 *certificate.centroid_distance_mm,
                                 certificate.centroid_tolerance_mm,
                                 "first moment of the terms / volume"});
}

}  // namespace

void add_comparison(Certificate& certificate, Comparison comparison) {
  // Written so that a difference that is no number fails.
  const auto within = [&](double allowed) { return comparison.difference <= allowed; };
  if (comparison.tolerance && !within(*comparison.tolerance)) {
    comparison.agreement = within(doubt * *comparison.tolerance) ? Agreement::Warn : Agreement::Fail;
    char text[200];
    std::snprintf(text, sizeof text, "%s differs by %.6g %s where theory allows %.6g",
                  comparison.quantity.c_str(), comparison.difference, comparison.unit.c_str(),
                  *comparison.tolerance);
    lower(certificate, comparison.agreement, text);
  }
  certificate.comparisons.push_back(std::move(comparison));
}

void lower(Certificate& certificate, Agreement agreement, const std::string& reason) {
  certificate.agreement = std::max(certificate.agreement, agreement);
  certificate.reasons.push_back(reason);
}

Certificate certify_bounded(const voxel::Octree& octree, const brep::Mesh& solid, const BoundInputs& inputs) {
  const auto start = std::chrono::steady_clock::now();
  const voxel::Lattice lattice = octree.universe().lattice();
  Evidence evidence;
  evidence.voxels = voxel::measure(octree);
  evidence.mesh = brep::measure(solid);
  evidence.voxel_mm = lattice.spacing_mm();
  evidence.voxel_mm3 = lattice.voxel_mm3();
  evidence.sample_mm = seen_spacing_mm(inputs.scan_spacing_mm, evidence.voxel_mm);
  const glm::dvec3 about_mm =
      evidence.mesh.centroid_mm.value_or(0.5 * (evidence.mesh.low_mm + evidence.mesh.high_mm));
  evidence.model = boundary_model(solid, {lattice, evidence.sample_mm, about_mm});
  evidence.border = border_of(solid, inputs, about_mm);
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
  const voxel::Octree digitised = convert::voxelise(octree.universe(), solid);
  const voxel::Octree either =
      voxel::combine(octree.universe(), voxel::Expression(octree) ^ voxel::Expression(digitised));
  certificate.symmetric_difference_mm3 = static_cast<double>(either.voxel_count()) * evidence.voxel_mm3;
  if (evidence.voxels.centroid_mm && evidence.mesh.centroid_mm)
    certificate.centroid_distance_mm = glm::length(*evidence.voxels.centroid_mm - *evidence.mesh.centroid_mm);
  judge_volume(certificate, evidence);
  if (!octree.is_empty() && evidence.mesh.area_mm2 > 0.0) {
    compare_surfaces(certificate, evidence, octree, solid);
    compare_inertia(certificate, evidence, solid);
    if (inputs.voxels_are_samples) compare_topology(certificate, octree, solid);
  }
  judge_extent(certificate, evidence);
  certificate.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return certificate;
}

double worst_share(const Certificate& certificate) {
  double worst = 0.0;
  for (const Comparison& comparison : certificate.comparisons) {
    if (!comparison.tolerance || comparison.difference == 0.0) continue;
    worst = std::max(worst, *comparison.tolerance > 0.0 ? comparison.difference / *comparison.tolerance
                                                        : std::numeric_limits<double>::infinity());
  }
  return worst;
}

bool is_worse(const Certificate& a, const Certificate& b) {
  const auto rank = [](const Certificate& c) {
    const bool unresolved = c.agreement == Agreement::BelowResolution;
    return std::pair(unresolved ? -1 : static_cast<int>(c.agreement), worst_share(c));
  };
  return rank(a) > rank(b);
}

void keep_worse(std::optional<Contested>& kept, const Contested& found) {
  if (!kept || is_worse(found.certificate, kept->certificate)) kept = found;
}

std::string to_string(Tier tier) {
  switch (tier) {
    case Tier::Exact:
      return "exact";
    case Tier::Bounded:
      return "bounded";
    case Tier::ClosedForm:
      return "closed_form";
  }
  return {};
}

std::string to_string(Agreement agreement) {
  switch (agreement) {
    case Agreement::Pass:
      return "PASS";
    case Agreement::Warn:
      return "WARN";
    case Agreement::Fail:
      return "FAIL";
    case Agreement::BelowResolution:
      return "BELOW_RESOLUTION";
  }
  return {};
}

}  // namespace octotomy::verify
