// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certificate/certify_operation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "brep/mesh/error.h"
#include "convert/voxel/voxelise.h"
#include "voxel/measure/distance_map.h"
#include "voxel/measure/measure.h"
#include "voxel/solid/combine.h"
#include "voxel/space/rounded.h"

namespace octotomy::verify {
namespace {

/// The distance from a surface within which the side of a voxel's centre is uncertain: a few units in the
/// last place of the largest coordinate, plus the distance by which corefinement moved an operand.
double undecided_mm(double reach_mm, double shift_mm) {
  return shift_mm + 64.0 * std::numeric_limits<double>::epsilon() * reach_mm;
}

/// Counts the voxel centres at which the kernels differ and that are farther than `within_mm` from the
/// result's surface. `farthest_mm` is the farthest one of all differing centres.
struct DifferingCentres {
  std::size_t count = 0;
  glm::dvec3 farthest_mm{0.0};
  double distance_mm = 0.0;  ///< of the farthest
};

DifferingCentres differing_centres(const voxel::Octree& differing, const brep::Solid& result,
                                   double within_mm) {
  const voxel::Lattice lattice = differing.universe().lattice();
  std::vector<glm::dvec3> centres_mm;
  const voxel::VoxelRange range = voxel::range_of(differing);
  for (int z = range.low.z; z <= range.high.z; ++z)
    for (int y = range.low.y; y <= range.high.y; ++y)
      for (int x = range.low.x; x <= range.high.x; ++x)
        if (differing.contains({x, y, z})) centres_mm.push_back(lattice.lps_mm({x, y, z}));
  if (centres_mm.empty()) return {};
  if (result.empty()) {
    const glm::ivec3 dims = range.dims();
    return {centres_mm.size(), centres_mm[centres_mm.size() / 2],
            lattice.spacing_mm().x * std::max({dims.x, dims.y, dims.z})};
  }
  const std::vector<double> distances_mm = result.tree().distances_mm(centres_mm);
  const auto farthest = std::max_element(distances_mm.begin(), distances_mm.end());
  return {
      static_cast<std::size_t>(std::count_if(distances_mm.begin(), distances_mm.end(),
                                             [&](double distance_mm) { return distance_mm > within_mm; })),
      centres_mm[static_cast<std::size_t>(farthest - distances_mm.begin())], *farthest};
}

voxel::Expression expression_of(const voxel::Octree& a, brep::Operation operation, const voxel::Octree& b) {
  switch (operation) {
    case brep::Operation::Union:
      return voxel::Expression(a) | b;
    case brep::Operation::Intersection:
      return voxel::Expression(a) & b;
    case brep::Operation::Difference:
      break;
  }
  return voxel::Expression(a) - b;
}

/// A part without a voxel's centre is not detected. A ball of more than this volume contains a voxel's centre
/// at any position, because its radius exceeds half a voxel's diagonal.
double unseen_ball_mm3(const voxel::Lattice& lattice) {
  const double radius_mm = 0.5 * glm::length(lattice.spacing_mm());
  return 4.0 / 3.0 * std::numbers::pi * radius_mm * radius_mm * radius_mm;
}

/// Sets `unresolved` for two empty answers if a part of more than evident_share of the smaller operand could
/// be missed.
void judge_operands(const brep::Solid& a, const brep::Solid& b, Certificate& certificate) {
  const double smaller_mm3 = std::min(a.size().volume_mm3, b.size().volume_mm3);
  if (certificate.unseen_mm3() <= evident_share * smaller_mm3) return;
  certificate.unresolved = {std::nullopt, "both answers are empty and a part of " +
                                              voxel::rounded(certificate.unseen_mm3()) +
                                              " mm3 could be missed; the smaller operand has " +
                                              voxel::rounded(smaller_mm3) + " mm3: take smaller voxels"};
}

}  // namespace

std::string text_of(brep::Operation operation) {
  return operation == brep::Operation::Union          ? "a | b"
         : operation == brep::Operation::Intersection ? "a & b"
                                                      : "a - b";
}

Certificate certify_at_centres(const voxel::Octree& octree, const brep::Solid& solid, double shift_mm,
                               const std::vector<std::string>& findings) {
  const voxel::Measures voxels = voxel::measure(octree);
  const brep::Measures& triangles = solid.measures();
  const voxel::Lattice lattice = octree.universe().lattice();
  Certificate certificate;
  certificate.tier = Tier::Bounded;
  certificate.voxel = {"both meshes voxelised at voxels' centres, Boolean of octrees", voxels.volume_mm3,
                       voxels.area_crofton13_mm2, voxels.centroid_mm};
  certificate.mesh = {"corefinement of both meshes", triangles.volume_mm3, triangles.area_mm2,
                      triangles.centroid_mm};
  certificate.difference_mm3 = voxels.volume_mm3 - triangles.volume_mm3;
  // A plane along the voxels errs coherently, and a mesh may have such planes.
  const double coherent_mm3 = glm::dot(voxels.exposed_mm2, 0.5 * lattice.spacing_mm());
  certificate.terms = {
      {"sampling", "Voxels are sampled at their centres.", "h/2 * area of exposed voxel faces", coherent_mm3},
      {"voxel", "One voxel more or less.", "h^3", lattice.voxel_mm3()}};
  certificate.tolerance_mm3 = coherent_mm3 + lattice.voxel_mm3();
  add_comparison(certificate,
                 {"volume", "mm3", voxels.volume_mm3, triangles.volume_mm3,
                  std::abs(certificate.difference_mm3), certificate.tolerance_mm3, "sum of the terms"});

  const voxel::Octree differing = voxel::combine(
      octree.universe(), voxel::Expression(octree) ^ convert::voxelise(octree.universe(), solid.linked()));
  certificate.symmetric_difference_mm3 = static_cast<double>(differing.voxel_count()) * lattice.voxel_mm3();
  const double reach_mm = glm::length(glm::max(glm::abs(triangles.low_mm), glm::abs(triangles.high_mm)));
  const DifferingCentres beyond = differing_centres(differing, solid, undecided_mm(reach_mm, shift_mm));
  add_comparison(
      certificate,
      {.quantity = "centres of voxels on different sides",
       .unit = "",
       .difference = static_cast<double>(beyond.count),
       .tolerance = 0.0,
       .formula = "0: no such centre farther from the surface than coordinates are rounded or moved",
       .statement = "Centres of % voxels are inside for one kernel only"});
  if (beyond.count > 0) {
    const glm::dvec3 p_voxel = glm::inverse(lattice.lps_from_voxel) * glm::dvec4(beyond.farthest_mm, 1.0);
    certificate.worst = {
        beyond.farthest_mm, beyond.distance_mm,
        octree.contains(glm::ivec3(glm::round(p_voxel))) ? part_of_voxels_only : part_of_mesh_only};
    certificate.reasons.push_back(text_of(*certificate.worst));
  }
  certificate.limit = DetectionLimit{unseen_ball_mm3(lattice), std::nullopt};
  judge_evidence(certificate);
  for (const std::string& finding : findings) certificate.reasons.push_back(finding);
  return certificate;
}

OperationAnswers certify_operation(const brep::Solid& a, brep::Operation operation, const brep::Solid& b,
                                   const MeshOperationOptions& options) {
  const brep::Size &of_a = a.size(), &of_b = b.size();
  voxel::Box box{glm::min(of_a.low_mm, of_b.low_mm), glm::max(of_a.high_mm, of_b.high_mm)};
  const glm::dvec3 extent_mm = box.high_mm - box.low_mm;
  const double voxel_mm =
      options.voxel_mm.value_or(std::max({extent_mm.x, extent_mm.y, extent_mm.z}) / 128.0);
  box = {box.low_mm - voxel_mm, box.high_mm + voxel_mm};
  const voxel::Universe universe = options.universe.value_or(voxel::universe_around(box, voxel_mm));
  OperationAnswers answers;
  const voxel::Progress& progress = options.progress;
  progress.at(0.0);
  const voxel::Octree voxels_of_a = convert::voxelise(universe, a.linked());
  progress.at(0.15);
  const voxel::Octree voxels_of_b = convert::voxelise(universe, b.linked());
  answers.octree = voxel::combine(universe, expression_of(voxels_of_a, operation, voxels_of_b));
  progress.at(0.3);
  brep::BooleanResult result;
  try {
    result = brep::boolean(a, operation, b, progress.stop);
  } catch (const brep::Stopped& stopped) {
    throw voxel::Stopped(stopped.what());
  }
  answers.solid = std::move(result.solid);
  progress.at(0.7);
  answers.shift_mm = result.shift_mm;
  answers.findings = std::move(result.findings);
  answers.certificate =
      certify_at_centres(*answers.octree, answers.solid, answers.shift_mm, answers.findings);
  if (answers.certificate.larger_mm3() == 0.0) judge_operands(a, b, answers.certificate);
  answers.certificate.operation = text_of(operation);
  progress.at(1.0);
  return answers;
}

}  // namespace octotomy::verify
