// SPDX-License-Identifier: AGPL-3.0-or-later
// Compares both answers with each other, with their witness and with lines through the scan. The tolerances
// are derived in difference_bound.cpp.
#include "verify/certificate/certify_bounded.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

#include "brep/mesh/measure.h"
#include "brep/mesh/triangles.h"
#include "convert/voxel/voxelise.h"
#include "verify/certificate/boundary_model.h"
#include "verify/certificate/difference_bound.h"
#include "verify/certificate/necks.h"
#include "verify/certificate/places.h"
#include "verify/certificate/specks.h"
#include "verify/certificate/surface_distances.h"
#include "verify/certificate/topology.h"
#include "voxel/measure/measure.h"
#include "voxel/solid/combine.h"
#include "voxel/space/rounded.h"

namespace octotomy::verify {
namespace {

/// Least extent of a resolved object, in voxels. Most voxels of a smaller object lie on its boundary.
constexpr double resolved_voxels = 6.0;
/// A surface has no counterpart if the other surface is further away than this multiple of the distance that
/// digitisation explains. Parts thinner than a voxel may be lost over two or three voxels, so the verdict is
/// WARN, not FAIL.
constexpr double lost = 3.0;

/// Adds a comparison of totals. With a witness the verdict is WARN at worst, unless `totals_decide`. The
/// witness judges every place; if no place shows an error, resampling or flat triangles between samples cause
/// the difference.
void compare(Certificate& certificate, const Evidence& evidence, Comparison comparison,
             Verdict worst_verdict = Verdict::Fail) {
  add_comparison(certificate, std::move(comparison),
                 evidence.witnessed && !evidence.totals_decide ? Verdict::Warn : worst_verdict);
}

/// The inertia tensor of the solid about a point for density 1, as a sum over the tetrahedra from the point
/// to each triangle.
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
      area_tolerance_mm2(evidence, thin_mm2),
      "0.03 S for ripple, 0.3 h M for edges, more for sharp ones, rims of flat parts, parts thinner than a "
      "voxel; both areas by the Crofton formula of 13 directions"};
}

void compare_inertia(Certificate& certificate, const Evidence& evidence, const brep::Solid& solid) {
  if (!evidence.voxels.inertia_mm5 || !(evidence.mesh.volume_mm3 > 0.0)) return;
  const glm::dmat3 inertia = inertia_about(solid.triangles(), *evidence.mesh.centroid_mm);
  double most = 0.0, largest = 0.0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      most = std::max(most, std::abs((*evidence.voxels.inertia_mm5)[i][j] - inertia[i][j]));
      largest = std::max(largest, std::abs(inertia[i][j]));
    }
  compare(certificate, evidence,
          {"inertia", "mm5", (*evidence.voxels.inertia_mm5)[0][0], inertia[0][0], most,
           inertia_tolerance_mm5(certificate, evidence, largest),
           "second moment of the terms, V times the centroid's tolerance squared, 64 eps",
           "The inertia tensors differ by up to % in a component"});
}

/// Adds the volume of the parts and cavities that hold no voxel's centre. Raises the detection limit to the largest
/// of them, because voxels do not show its loss. The witness judges their triangles like all others.
void add_specks(Certificate& certificate, const Specks& specks) {
  if (specks.count == 0) return;
  const double largest_mm3 = specks.largest->volume_mm3;
  if (certificate.limit) certificate.limit->volume_mm3 = std::max(certificate.limit->volume_mm3, largest_mm3);
  add_comparison(
      certificate,
      {.quantity = "parts and cavities between voxels' centres",
       .unit = "mm3",
       .difference = specks.volume_mm3,
       .tolerance = certificate.tolerance_mm3,
       .formula = "the volume's tolerance; the mesh has " + std::to_string(specks.count) +
                  ", the largest of " + voxel::rounded(largest_mm3) + " mm3 near " +
                  voxel::rounded(specks.largest->at_mm) + ", and distances leave them out",
       .statement =
           "The mesh has parts and cavities with a total volume of % that contain no voxel's centre"},
      Verdict::Warn);
  judge_evidence(certificate);
}

/// Compares areas and distances. For a resolved object with a witness and without lost voxels, mean and
/// percentile come from a sample of the surfaces' points. If a bound is exceeded, searches for parts thinner
/// than a voxel. A resolved object that differs only by such parts becomes unresolved, and the certificate
/// states the share of their area. Mean and percentile leave out surfaces beside `lost_voxels`, which the
/// certificate lists as lost by resampling. With a witness, if a bound is exceeded, they also leave out parts
/// of the mesh that `digitised`, the voxels of the mesh, does not represent: the witness judges the triangles
/// there and every voxel in which the kernels differ.
void compare_surfaces(Certificate& certificate, const Evidence& evidence, const voxel::Octree& octree,
                      const brep::Solid& solid, const voxel::Octree& digitised,
                      const std::vector<glm::ivec3>& lost_voxels) {
  const Specks specks = evidence.witnessed ? specks_of(solid, octree.universe().lattice()) : Specks();
  add_specks(certificate, specks);
  const bool is_strict = evidence.witnessed && certificate.resolved();
  const brep::Triangles& measured = specks.others.faces.empty() ? solid.triangles() : specks.others;
  SurfaceDistances distances(octree, solid, measured, is_strict && lost_voxels.empty());
  certificate.hausdorff_mm = distances.largest_mm();
  certificate.hausdorff95_mm = distances.percentile95_mm();
  if (!certificate.worst) certificate.worst = distances.worst();
  const DistanceBounds bounds = distance_bounds(evidence);
  const double far_mm = lost * 0.5 * (glm::length(evidence.voxel_mm) + glm::length(evidence.sample_mm));
  Comparison area = area_of(evidence, 0.0);
  const bool loses_area = evidence.witnessed && *area.mesh - *area.voxel > *area.tolerance;
  const std::string lost_share = voxel::rounded(100.0 * (1.0 - *area.voxel / *area.mesh));
  const auto are_within = [&] {
    return area.difference <= *area.tolerance && distances.percentile95_mm() <= bounds.percentile95_mm &&
           distances.mean_mm() <= bounds.mean_mm && (is_strict || distances.largest_mm() <= far_mm);
  };
  if (!lost_voxels.empty()) distances.leave_out_beside(lost_voxels);
  if (!are_within()) {
    double thin_mm2 = distances.leave_out_thin();
    if (evidence.witnessed) thin_mm2 += distances.leave_out_unheld(digitised, bounds.percentile95_mm);
    area = area_of(evidence, thin_mm2);
    const std::string thin = voxel::rounded(100.0 * thin_mm2 / evidence.mesh.area_mm2) +
                             " % of its surface bounds walls and gaps that are thinner than a voxel";
    if (is_strict && are_within())
      certificate.unresolved = {std::nullopt, thin};
    else if (evidence.witnessed && certificate.unresolved)
      certificate.unresolved->reason += ", and " + thin;
    else if (is_strict && loses_area)
      certificate.reasons.push_back("At this voxel size " + lost_share +
                                    " % of the surface is lost, on walls and gaps that are thinner than a "
                                    "voxel.");
  }
  if (loses_area && certificate.unresolved)
    certificate.unresolved->reason += ", and " + lost_share + " % of its surface is lost";
  if (is_strict && certificate.unresolved) certificate.unresolved->reason += ": take smaller voxels";
  // Sheets thinner than a voxel lose much area and little volume, so the verdict is WARN at worst.
  compare(certificate, evidence, std::move(area), Verdict::Warn);
  compare(certificate, evidence,
          {.quantity = "hausdorff95",
           .unit = "mm",
           .difference = distances.percentile95_mm(),
           .tolerance = bounds.percentile95_mm,
           .formula = "half a voxel's diagonal + 0.1 s; if exceeded, without parts thinner than a voxel",
           .statement = "Five per cent of one surface lies % or more from the other surface"});
  compare(certificate, evidence,
          {.quantity = "mean distance",
           .unit = "mm",
           .difference = distances.mean_mm(),
           .tolerance = bounds.mean_mm,
           .formula = "h/4 on curved boundary + displacement of flats + 0.1 s; if exceeded, without parts "
                      "thinner than a voxel",
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
                  .formula = "0: no voxel may be on a side that the scan and the plan exclude for its kernel",
                  .statement = "Voxels with a total volume of % contradict the scan"},
                 most);
  add_comparison(certificate,
                 {.quantity = "stray surface",
                  .unit = "mm2",
                  .difference = places.stray_mm2,
                  .tolerance = 0.0,
                  .formula = "0: a triangle must lie where the scan and the plan have a surface",
                  .statement = "Triangles with a total area of % lie where the scan has no surface"},
                 most);
}

/// Adds the places of bridges: thin necks that one kernel kept and the other cut, so that one kernel alone
/// has the part beyond. A part larger than the limit lowers the verdict to WARN. Smaller parts are only
/// listed: the certificate already states that a part of the limit's size could be wrong anywhere, and the
/// comparisons of volumes and surfaces judge their sum. Precondition: `places.open` has the largest part
/// first.
void judge_bridges(Certificate& certificate, const Places& places) {
  constexpr std::size_t most_told = 3;
  for (const OpenPart& part : places.open) certificate.bridges.push_back(part.bridge);
  if (certificate.bridges.empty()) return;
  const auto first_small =
      std::find_if(certificate.bridges.begin(), certificate.bridges.end(),
                   [&](const WorstPlace& bridge) { return bridge.volume_mm3 <= places.limit.volume_mm3; });
  const auto large = static_cast<std::size_t>(first_small - certificate.bridges.begin());
  add_comparison(certificate, {.quantity = "parts beyond thin necks",
                               .unit = "mm3",
                               .difference = certificate.bridges.front().volume_mm3,
                               .formula = "no verdict up to the limit; the largest of " +
                                          std::to_string(certificate.bridges.size()) +
                                          " parts that are connected by necks which one kernel cuts"});
  for (std::size_t i = 0; i < std::min(large, most_told); ++i) {
    const WorstPlace& bridge = certificate.bridges[i];
    lower(certificate, Verdict::Warn,
          "An ambiguous bridge near " + voxel::rounded(bridge.at_mm) + ": " + bridge.what + ", " +
              voxel::rounded(bridge.volume_mm3) +
              " mm3, that the other kernel cuts off. The neck is thinner than " + thin_neck +
              ": decide it by 'keep_bridges_mm' or 'cut_bridges_mm' of the step that chooses parts, "
              "or take smaller voxels.");
  }
  if (large > most_told)
    certificate.reasons.push_back(std::to_string(large - most_told) +
                                  " more parts are connected by ambiguous bridges.");
  if (!certificate.worst) certificate.worst = certificate.bridges.front();
}

/// Share of an object that resampling may lose before the verdict is WARN. A smaller share is only stated.
constexpr double stated_share = 0.002;

/// Adds the volume of the parts that resampling lost, as WARN if it is more than stated_share of the object. The
/// witness agrees with the mesh at each of these places, so the mesh is right and the voxels are too large.
void judge_lost(Certificate& certificate, const Evidence& evidence, const Places& places) {
  if (!places.worst_lost) return;
  const std::string near = voxel::rounded(places.worst_lost->at_mm);
  add_comparison(
      certificate,
      {.quantity = "lost by resampling",
       .unit = "mm3",
       .difference = static_cast<double>(places.lost.size()) * evidence.voxel_mm3,
       .tolerance = stated_share * certificate.larger_mm3(),
       .formula = "0.002 V; voxels that lack or fill walls or gaps thinner than a voxel, most near " + near,
       .statement = "At this voxel size resampling loses walls or gaps thinner than a voxel: voxels with a "
                    "total volume of % differ from this step's result, most of them near " +
                    near + ". The scan confirms the mesh there: take smaller voxels"},
      Verdict::Warn);
  if (!certificate.worst) certificate.worst = places.worst_lost;
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
          lost_by_voxels ? "The voxel kernel's object is empty, but the mesh kernel's is not."
                         : "The mesh kernel's object is empty, but the voxel kernel's is not.");
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
           .statement = "Voxels with a total volume of % are inside for one kernel only"});
  if (certificate.centroid_distance_mm && certificate.centroid_tolerance_mm)
    compare(certificate, evidence,
            {.quantity = "centroid",
             .unit = "mm",
             .difference = *certificate.centroid_distance_mm,
             .tolerance = certificate.centroid_tolerance_mm,
             .formula = "first moment of the terms / volume",
             .statement = "The centroids are % apart"});
}

/// Compares the mesh's volume with the number of voxel centres inside it. Parts that the mesh contains several times
/// count once among the centres. In walls thinner than a voxel, centres do not measure volume: where `third` confirms
/// the mesh's volume, the verdict is WARN at worst.
void compare_counted(Certificate& certificate, const Evidence& evidence, const voxel::Octree& digitised) {
  // A part that is repeated or inside out moves the mesh's volume away from the lines' volume by at least as
  // much as from the counted one.
  constexpr double confirmed_share = 0.2;
  const double counted_mm3 = static_cast<double>(digitised.voxel_count()) * evidence.voxel_mm3;
  const double difference_mm3 = std::abs(counted_mm3 - evidence.mesh.volume_mm3);
  const bool confirmed =
      certificate.third &&
      std::abs(evidence.mesh.volume_mm3 - certificate.third->volume_mm3) <= confirmed_share * difference_mm3;
  add_comparison(
      certificate,
      {"volume counted inside of the mesh", "mm3", counted_mm3, evidence.mesh.volume_mm3, difference_mm3,
       certificate.tolerance_mm3 + evidence.voxel_mm3, "the volume's tolerance, and a voxel",
       confirmed
           ? "The mesh's volume and the volume of the voxels with their centres in the mesh are % apart. "
             "Lines through the scan confirm the mesh's volume: walls are thinner than a voxel"
           : "The mesh's volume and the volume of the voxels with their centres in the mesh are % apart, "
             "for example because the mesh contains a part several times"},
      confirmed ? Verdict::Warn : Verdict::Fail);
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

/// Adds the total area of triangles that the mesh repeats with the same winding; a set of voxels cannot show
/// them. Equal triangles are found by a hash of their corners. The probability that two different triangles
/// among a million have the same hash is 2^-24.
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
                               .formula = "0: no triangle may occur twice",
                               .statement = "Triangles with a total area of % are repeated in the mesh"});
}

/// Compares the volume measured along lines with both answers. If the answers agree with each other but not
/// with the lines, both are wrong.
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
                               "Lines through the scan measure " + voxel::rounded(third.volume_mm3) +
                                   " mm3; the nearer answer differs from this volume by %"});
  if (both_stray || std::abs(certificate.difference_mm3) <= certificate.tolerance_mm3) return;
  const bool voxels_stray = of_voxels > of_mesh;
  const double more_mm3 =
      (voxels_stray ? evidence.voxels.volume_mm3 : evidence.mesh.volume_mm3) - third.volume_mm3;
  const std::string loses = voxels_stray ? "at this voxel size resampling loses "
                                         : "the mesh, whose triangles are flat between samples, loses ",
                    adds = voxels_stray ? "at this voxel size resampling adds " : "the mesh adds ";
  certificate.reasons.push_back(
      "Measured along lines, the scan's own samples enclose " + voxel::rounded(third.volume_mm3) + " mm3: " +
      (more_mm3 > 0.0 ? adds + voxel::rounded(more_mm3) + " mm3."
                      : loses + voxel::rounded(-100.0 * more_mm3 / third.volume_mm3) + " % of this tissue."));
}

/// Lowers the verdict to WARN where an answer or both are empty, because no surfaces were compared.
void judge_emptiness(Certificate& certificate, const voxel::Octree& octree, const brep::Solid& solid,
                     double missed_mm3) {
  judge_emptiness(certificate, missed_mm3);
  if (octree.is_empty() == solid.empty()) return;
  lower(certificate, Verdict::Warn,
        octree.is_empty()
            ? "The object has no voxel, but its mesh encloses " +
                  voxel::rounded(certificate.mesh.volume_mm3) +
                  " mm3, so no surfaces were compared: take smaller voxels."
            : "The mesh is empty, but the voxels hold " + voxel::rounded(certificate.voxel.volume_mm3) +
                  " mm3, so no surfaces were compared.");
}

}  // namespace

Certificate certify_bounded(const voxel::Octree& octree, const brep::Solid& solid, const BoundInputs& inputs,
                            const voxel::Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const voxel::Lattice lattice = octree.universe().lattice();
  const Evidence evidence = evidence_of(octree, solid, inputs, progress);

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
  std::vector<glm::ivec3> lost_voxels;
  if (evidence.witnessed) {
    Places places = judge_places(octree, digitised, solid, inputs.witness, {progress.stop, {}});
    judge_by_witness(certificate, evidence, places);
    judge_bridges(certificate, places);
    judge_lost(certificate, evidence, places);
    lost_voxels = std::move(places.lost);
  }
  judge_volume(certificate, evidence);
  compare_with_lines(certificate, evidence, inputs.witness.lines(), voxel::bounds(lattice), progress);
  if (evidence.witnessed) compare_counted(certificate, evidence, digitised);
  compare_repeated(certificate, solid.triangles());
  progress.at(0.45);
  compare_topology(certificate, octree, digitised);
  judge_extent(certificate, evidence);
  judge_evidence(certificate);
  if (!octree.is_empty() && evidence.mesh.area_mm2 > 0.0) {
    progress.at(0.5);
    compare_surfaces(certificate, evidence, octree, solid, digitised, lost_voxels);
    progress.at(0.9);
    compare_inertia(certificate, evidence, solid);
    if (inputs.voxels_are_samples) compare_same_topology(certificate, octree, solid);
  }
  // The search for parts that both kernels lack samples one voxel in each block of two voxels a side, so it
  // may miss a part of up to eight voxels.
  if (!inputs.is_surely_empty)
    judge_emptiness(certificate, octree, solid, 8.0 * evidence.voxel_mm3);
  else if (!octree.is_empty() || !solid.empty())
    lower(certificate, Verdict::Fail, "The object must be empty, but one of the answers is not.");
  const auto has_place = [&](const std::string& reason) { return reason.rfind("The two surfaces", 0) == 0; };
  if (certificate.verdict != Verdict::Pass && certificate.worst && certificate.worst->size_mm > 0.0 &&
      std::none_of(certificate.reasons.begin(), certificate.reasons.end(), has_place))
    certificate.reasons.push_back(text_of(*certificate.worst));
  progress.at(1.0);
  certificate.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return certificate;
}

}  // namespace octotomy::verify
