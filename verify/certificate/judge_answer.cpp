// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certificate/judge_answer.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "brep/mesh/health.h"
#include "voxel/measure/distance_map.h"
#include "voxel/measure/measure.h"
#include "voxel/solid/combine.h"
#include "voxel/space/error.h"
#include "voxel/space/rounded.h"

namespace octotomy::verify {
namespace {

constexpr const char* of_others = "the answer to be judged";
constexpr const char* lacks_part = "the answer lacks a part there";
constexpr const char* has_more = "the answer has a part there that it must not have";

/// Bound of the rounding of coordinates in a file. Files hold 32-bit coordinates, whose unit in the last
/// place is 2^-23 of the coordinate. A program rounds once when it computes and once when it writes.
double rounding_mm(const brep::Solid& solid) {
  const brep::Size& size = solid.size();
  return 0x1p-22 * glm::length(glm::max(glm::abs(size.low_mm), glm::abs(size.high_mm)));
}

std::vector<glm::dvec3> corners_and_middles(const brep::Triangles& triangles) {
  std::vector<glm::dvec3> points_mm = triangles.points_mm;
  for (const auto& [a, b, c] : triangles.faces)
    points_mm.push_back((triangles.points_mm[a] + triangles.points_mm[b] + triangles.points_mm[c]) / 3.0);
  return points_mm;
}

Certificate against_solid(const brep::Solid& solid, const brep::Solid& answer, double shift_mm) {
  const brep::Measures &truth = solid.measures(), &given = answer.measures();
  Certificate certificate;
  certificate.tier = Tier::Bounded;
  certificate.voxel = {"the mesh kernel", truth.volume_mm3, truth.area_mm2, truth.centroid_mm};
  certificate.mesh = {of_others, given.volume_mm3, given.area_mm2, given.centroid_mm};
  certificate.difference_mm3 = truth.volume_mm3 - given.volume_mm3;
  if (solid.empty() || answer.empty()) {
    if (solid.empty() != answer.empty())
      lower(certificate, Verdict::Fail,
            solid.empty() ? "The answer must be empty but is not." : "The answer is empty but must not be.");
    return certificate;
  }
  const double near_mm = rounding_mm(solid) + shift_mm;
  certificate.terms = {{"rounding", "Coordinates are rounded to 32 bits, operands that touch are moved.",
                        "(2^-22 |p| + shift) S", near_mm * truth.area_mm2}};
  certificate.tolerance_mm3 = near_mm * truth.area_mm2;
  add_comparison(certificate, {.quantity = "volume",
                               .unit = "mm3",
                               .difference = std::abs(certificate.difference_mm3),
                               .tolerance = certificate.tolerance_mm3,
                               .formula = "(2^-22 |p| + shift) S",
                               .statement = "The answer's volume is " + voxel::rounded(given.volume_mm3) +
                                            " mm3, % from the mesh kernel's"});
  double farthest_mm = 0.0;
  const auto keep_farthest = [&](const brep::Solid& from, const brep::Solid& to, const char* what) {
    const std::vector<glm::dvec3> points_mm = corners_and_middles(from.triangles());
    const std::vector<double> distances_mm = to.tree().distances_mm(points_mm);
    const auto most = std::max_element(distances_mm.begin(), distances_mm.end());
    if (*most <= farthest_mm) return;
    farthest_mm = *most;
    const glm::dvec3 p_mm = points_mm[static_cast<std::size_t>(most - distances_mm.begin())];
    certificate.worst = {p_mm, farthest_mm, what};
  };
  keep_farthest(answer, solid, has_more);
  keep_farthest(solid, answer, lacks_part);
  certificate.hausdorff_mm = farthest_mm;
  add_comparison(certificate, {.quantity = "hausdorff",
                               .unit = "mm",
                               .difference = farthest_mm,
                               .tolerance = near_mm,
                               .formula = "2^-22 |p|, and the shift of an operand",
                               .statement = "The surfaces are up to % apart"});
  if (certificate.verdict != Verdict::Pass) certificate.reasons.push_back(text_of(*certificate.worst));
  return certificate;
}

Certificate named(Certificate certificate, const char* against) {
  certificate.operation = against;
  return certificate;
}

/// Centres of a set's voxels, except those so near the solid's surface that rounding decides their side.
std::vector<glm::dvec3> decided_centres(const voxel::Octree& set, const KernelAnswers& kernels) {
  std::vector<glm::dvec3> centres_mm;
  if (set.is_empty()) return centres_mm;
  const voxel::VoxelRange range = voxel::range_of(set);
  for (int z = range.low.z; z <= range.high.z; ++z)
    for (int y = range.low.y; y <= range.high.y; ++y)
      for (int x = range.low.x; x <= range.high.x; ++x)
        if (set.contains({x, y, z})) centres_mm.push_back(set.universe().lattice().lps_mm({x, y, z}));
  if (!kernels.solid || kernels.solid->empty()) return centres_mm;
  const std::vector<double> distances_mm = kernels.solid->tree().distances_mm(centres_mm);
  const double near_mm = rounding_mm(*kernels.solid) + kernels.shift_mm;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < centres_mm.size(); ++i)
    if (distances_mm[i] > near_mm) centres_mm[kept++] = centres_mm[i];
  centres_mm.resize(kept);
  return centres_mm;
}

Certificate no_solid() {
  Certificate certificate;
  lower(certificate, Verdict::Warn, "The mesh kernel has no answer to compare this one with.");
  return certificate;
}

}  // namespace

std::vector<Certificate> judge_mesh(const KernelAnswers& kernels, const brep::Triangles& answer,
                                    const voxel::Progress& progress) {
  std::vector<Certificate> certificates(2);
  const brep::Health health = brep::health(answer);
  const bool solid = answer.faces.empty() ||
                     (health.closed && health.manifold && health.oriented && health.duplicate_faces == 0);
  if (solid) {
    const brep::Solid given =
        answer.faces.empty() ? brep::Solid() : brep::trusted_solid(answer, brep::Proof::Connection);
    certificates[0] = certify_at_centres(kernels.octree, given, kernels.shift_mm, kernels.findings);
    certificates[0].voxel.lineage = "the voxel kernel";
    certificates[0].mesh.lineage = of_others;
    progress.at(0.5);
    certificates[1] = kernels.solid ? against_solid(*kernels.solid, given, kernels.shift_mm) : no_solid();
  } else {
    for (Certificate& certificate : certificates)
      for (const std::string& finding : health.findings)
        lower(certificate, Verdict::Fail, "The answer is no solid: " + finding);
  }
  if (solid && health.self_intersections > 0)
    for (Certificate& certificate : certificates)
      lower(certificate, Verdict::Warn,
            "The answer meets itself: " + std::to_string(health.self_intersections) + " pairs of triangles.");
  progress.at(1.0);
  return {named(std::move(certificates[0]), "the answer against the voxel kernel"),
          named(std::move(certificates[1]), "the answer against the mesh kernel")};
}

std::vector<Certificate> judge_voxels(const KernelAnswers& kernels, const voxel::Octree& answer) {
  if (!(answer.universe() == kernels.octree.universe()))
    throw voxel::InvalidInput(
        "the answer must have the same universe of voxels as the voxel kernel's octree");
  const double voxel_mm3 = answer.universe().lattice().voxel_mm3();
  Certificate certificate;
  certificate.tier = Tier::Exact;
  certificate.voxel = {"the voxel kernel", static_cast<double>(kernels.octree.voxel_count()) * voxel_mm3, 0.0,
                       voxel::measure(kernels.octree).centroid_mm};
  certificate.mesh = {of_others, static_cast<double>(answer.voxel_count()) * voxel_mm3, 0.0,
                      voxel::measure(answer).centroid_mm};
  certificate.difference_mm3 = certificate.voxel.volume_mm3 - certificate.mesh.volume_mm3;
  const voxel::Octree differing =
      voxel::combine(answer.universe(), voxel::Expression(kernels.octree) ^ answer);
  certificate.symmetric_difference_mm3 = static_cast<double>(differing.voxel_count()) * voxel_mm3;
  const std::vector<glm::dvec3> wrong_mm = decided_centres(differing, kernels);
  if (!wrong_mm.empty()) {
    const glm::dvec3 at_mm = wrong_mm[wrong_mm.size() / 2];
    const glm::ivec3 voxel(glm::round(answer.universe().lattice().voxel(at_mm)));
    const double volume_mm3 = static_cast<double>(wrong_mm.size()) * voxel_mm3;
    certificate.worst = {at_mm, std::cbrt(volume_mm3), answer.contains(voxel) ? has_more : lacks_part,
                         volume_mm3};
    lower(certificate, Verdict::Fail,
          "Voxels with a total volume of " + voxel::rounded(volume_mm3) +
              " mm3 are inside for only one of the answer and the voxel kernel, for example near " +
              voxel::rounded(at_mm) + ": " + certificate.worst->what + ".");
  }
  Certificate by_mesh = no_solid();
  if (kernels.solid) {
    by_mesh = certify_at_centres(answer, *kernels.solid, kernels.shift_mm, kernels.findings);
    by_mesh.voxel.lineage = of_others;
    by_mesh.mesh.lineage = "the mesh kernel";
  }
  return {named(std::move(certificate), "the answer against the voxel kernel"),
          named(std::move(by_mesh), "the answer against the mesh kernel")};
}

}  // namespace octotomy::verify
