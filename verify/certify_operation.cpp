// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certify_operation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "brep/distance.h"
#include "brep/measure.h"
#include "convert/voxelise.h"
#include "voxel/combine.h"
#include "voxel/distance_map.h"
#include "voxel/measure.h"

namespace octotomy::verify {
namespace {

/// How near to a surface a voxel's centre may be for rounding to decide on which side it is: a few units in
/// the last place of coordinates of that reach, or what corefinement moved an operand by where it had to
/// (brep::Booleans: 4e-6 of the extent a step, up to three).
double undecided_mm(double reach_mm, bool shifted) {
  return shifted ? 3.0 * 0x1p-18 * 2.0 * reach_mm : 64.0 * std::numeric_limits<double>::epsilon() * reach_mm;
}

/// Centres of voxels on which the kernels differ although they are not within that distance of the result's
/// surface, counted.
std::size_t differing_centres(const voxel::Octree& differing, const brep::Mesh& result, double within_mm) {
  const voxel::Lattice lattice = differing.universe().lattice();
  std::vector<glm::dvec3> centres_mm;
  const voxel::VoxelRange range = voxel::range_of(differing);
  for (int z = range.low.z; z <= range.high.z; ++z)
    for (int y = range.low.y; y <= range.high.y; ++y)
      for (int x = range.low.x; x <= range.high.x; ++x)
        if (differing.contains({x, y, z})) centres_mm.push_back(lattice.lps_mm({x, y, z}));
  if (centres_mm.empty() || result.n_faces() == 0) return centres_mm.size();
  const std::vector<double> distances_mm = brep::SurfaceTree(result).distances_mm(centres_mm);
  return static_cast<std::size_t>(std::count_if(distances_mm.begin(), distances_mm.end(),
                                                [&](double distance_mm) { return distance_mm > within_mm; }));
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

Certificate compared(const voxel::Octree& octree, const brep::Mesh& mesh,
                     const std::vector<std::string>& findings) {
  const voxel::Measures voxels = voxel::measure(octree);
  const brep::Measures triangles = brep::measure(mesh);
  const voxel::Lattice lattice = octree.universe().lattice();
  const double h = lattice.spacing_mm().x;
  Certificate certificate;
  certificate.tier = Tier::Bounded;
  certificate.voxel = {"both meshes voxelised at voxels' centres, Boolean of octrees", voxels.volume_mm3,
                       voxels.area_crofton13_mm2, voxels.centroid_mm};
  certificate.mesh = {"corefinement of both meshes", triangles.volume_mm3, triangles.area_mm2,
                      triangles.centroid_mm};
  certificate.difference_mm3 = voxels.volume_mm3 - triangles.volume_mm3;
  // A plane along voxels errs coherently; nothing is known of a user's mesh that would rule it out.
  const double coherent_mm3 = glm::dot(voxels.exposed_mm2, glm::dvec3(0.5 * h));
  certificate.terms = {{"sampling", "h/2 * area of exposed voxel faces", coherent_mm3}};
  certificate.tolerance_mm3 = coherent_mm3 + lattice.voxel_mm3();
  certificate.terms.push_back({"voxel", "h^3", lattice.voxel_mm3()});
  add_comparison(certificate,
                 {"volume", "mm3", voxels.volume_mm3, triangles.volume_mm3,
                  std::abs(certificate.difference_mm3), certificate.tolerance_mm3, "sum of the terms"});

  const voxel::Octree differing = voxel::combine(
      octree.universe(), voxel::Expression(octree) ^ convert::voxelise(octree.universe(), mesh));
  certificate.symmetric_difference_mm3 = static_cast<double>(differing.voxel_count()) * lattice.voxel_mm3();
  const bool shifted = std::any_of(findings.begin(), findings.end(), [](const std::string& finding) {
    return finding.rfind("shifted", 0) == 0;
  });
  const double reach_mm = glm::length(glm::max(glm::abs(triangles.low_mm), glm::abs(triangles.high_mm)));
  const auto beyond =
      static_cast<double>(differing_centres(differing, mesh, undecided_mm(reach_mm, shifted)));
  add_comparison(certificate, {"centres of voxels on different sides",
                               "",
                               {},
                               {},
                               beyond,
                               0.0,
                               "none that is further from the surface than rounding"});
  for (const std::string& finding : findings) certificate.reasons.push_back(finding);
  return certificate;
}

}  // namespace

OperationAnswers certify_operation(const brep::Mesh& a, brep::Operation operation, const brep::Mesh& b,
                                   const MeshOperationOptions& options) {
  const brep::Measures of_a = brep::measure(a), of_b = brep::measure(b);
  voxel::Box box{glm::min(of_a.low_mm, of_b.low_mm), glm::max(of_a.high_mm, of_b.high_mm)};
  const glm::dvec3 extent_mm = box.high_mm - box.low_mm;
  const double voxel_mm =
      options.voxel_mm.value_or(std::max({extent_mm.x, extent_mm.y, extent_mm.z}) / 128.0);
  box = {box.low_mm - voxel_mm, box.high_mm + voxel_mm};
  const voxel::Universe universe = voxel::universe_around(box, voxel_mm);
  OperationAnswers answers;
  answers.octree = voxel::combine(
      universe, expression_of(convert::voxelise(universe, a), operation, convert::voxelise(universe, b)));
  brep::BooleanResult result = brep::boolean(a, operation, b);
  answers.mesh = std::move(result.mesh);
  answers.certificate = compared(*answers.octree, answers.mesh, result.findings);
  answers.certificate.operation = operation == brep::Operation::Union          ? "a | b"
                                  : operation == brep::Operation::Intersection ? "a & b"
                                                                               : "a - b";
  return answers;
}

}  // namespace octotomy::verify
