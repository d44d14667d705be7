// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/sets_as_given.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "brep/mesh/error.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/triangles.h"
#include "convert/surface/cuberille.h"
#include "convert/voxel/voxelise.h"
#include "verify/certify_operation.h"
#include "verify/exact_agreement.h"
#include "voxel/codes/cuberille_faces.h"
#include "voxel/solid/combine.h"
#include "voxel/space/rounded.h"

namespace octotomy::verify {
namespace {

/// Voxels of two units a side, so that a cuberille's corners and its half-way points are whole.
constexpr double units = 2.0;

voxel::Octree on_units(const voxel::Octree& set) {
  voxel::Universe universe = set.universe();
  universe.lps_from_voxel = glm::dmat4(units);
  universe.lps_from_voxel[3] = glm::dvec4(glm::dvec3(0.5 * units), 1.0);
  return {universe, voxel::Block::share(set.root())};
}

brep::Solid cuberille_of(const voxel::Octree& set, const voxel::Progress& progress) {
  const convert::LatticeSurface surface =
      convert::cuberille(set, convert::Touching::Apart, {progress.stop, {}});
  brep::Triangles triangles;
  triangles.faces = surface.faces;
  for (const glm::ivec3& p_half : surface.points_half) triangles.points_mm.emplace_back(p_half);
  return brep::trusted_solid(std::move(triangles), brep::Proof::Construction);
}

/// The farthest that corefinement moves an operand: three steps of 4e-6 of the extent (brep::Booleans).
double moved_units(int side) {
  return 3.0 * 4e-6 * std::sqrt(3.0) * units * side;
}

/// The corners rounded to whole units, and how far the farthest was from them.
std::pair<brep::Mesh, double> on_lattice(brep::Mesh mesh) {
  double farthest = 0.0;
  for (const auto v : mesh.vertices()) {
    brep::Mesh::Point p = mesh.point(v);
    for (unsigned axis = 0; axis < 3; ++axis) {
      farthest = std::max(farthest, std::abs(p[axis] - std::round(p[axis])));
      p[axis] = std::round(p[axis]);
    }
    mesh.set_point(v, p);
  }
  return {std::move(mesh), farthest};
}

/// From units to LPS millimetres.
brep::Solid in_patient(const brep::Solid& solid, const glm::dmat4& lps_from_voxel) {
  brep::Triangles triangles = solid.triangles();
  for (glm::dvec3& p : triangles.points_mm) p = lps_from_voxel * glm::dvec4(p / units - 0.5, 1.0);
  if (glm::determinant(glm::dmat3(lps_from_voxel)) < 0.0)
    for (auto& face : triangles.faces) std::swap(face[0], face[1]);
  return brep::trusted_solid(std::move(triangles), brep::Proof::Rounded);
}

voxel::Expression expression_of(const voxel::Octree& a, brep::Operation operation, const voxel::Octree& b) {
  if (operation == brep::Operation::Union) return voxel::Expression(a) | b;
  if (operation == brep::Operation::Intersection) return voxel::Expression(a) & b;
  return voxel::Expression(a) - b;
}

void compare(const voxel::Octree& octree, const brep::Solid& solid, double unit_mm3,
             Certificate& certificate) {
  const auto fail = [&](const std::string& reason) { lower(certificate, Verdict::Fail, reason); };
  const auto [whole, farthest] = on_lattice(solid.mesh());
  const int side = octree.universe().side();
  if (farthest > moved_units(side))
    fail("A corner of the mesh kernel's answer lies " + voxel::rounded(farthest / units) +
         " voxels off the lattice of both sets.");
  const std::optional<std::int64_t> volume = whole_volume({whole});
  const auto voxels = static_cast<std::int64_t>(octree.voxel_count());
  constexpr auto per_voxel = static_cast<std::int64_t>(units * units * units);
  certificate.mesh.volume_mm3 =
      (volume ? static_cast<double>(*volume) : brep::volume_mm3(whole)) / per_voxel * unit_mm3;
  certificate.mesh.area_mm2 = brep::measure(whole).area_mm2 / (units * units) * std::pow(unit_mm3, 2.0 / 3.0);
  if (!volume || *volume != per_voxel * voxels)
    fail("The mesh kernel's volume is " + voxel::rounded(certificate.mesh.volume_mm3 / unit_mm3) +
         " voxels, the voxel kernel's " + std::to_string(voxels) + ".");
  const voxel::Octree differing = voxel::combine(
      octree.universe(), voxel::Expression(octree) ^ convert::voxelise(octree.universe(), solid));
  certificate.symmetric_difference_mm3 = static_cast<double>(differing.voxel_count()) * unit_mm3;
  if (!differing.is_empty())
    fail("Voxels of " + voxel::rounded(certificate.symmetric_difference_mm3) +
         " mm3 are inside for one kernel only.");
}

}  // namespace

SetsAnswer certify_sets(const voxel::Octree& a, brep::Operation operation, const voxel::Octree& b,
                        const voxel::Progress& progress) {
  if (!(a.universe() == b.universe())) throw std::invalid_argument("both sets of voxels need one universe");
  const auto start = std::chrono::steady_clock::now();
  const double unit_mm3 = a.universe().lattice().voxel_mm3();
  const double face_mm2 = std::pow(unit_mm3, 2.0 / 3.0);
  SetsAnswer answer{voxel::combine(a.universe(), expression_of(a, operation, b)), {}, {}, {}};
  Certificate& certificate = answer.certificate;
  certificate.tier = Tier::Exact;
  certificate.operation = text_of(operation);
  certificate.voxel = {
      "Boolean of octrees on the sets as given", static_cast<double>(answer.octree.voxel_count()) * unit_mm3,
      static_cast<double>(voxel::cuberille_faces(answer.octree).face_count()) * face_mm2, std::nullopt};
  certificate.mesh = {"corefinement of the same sets' cuberilles", 0.0, 0.0, std::nullopt};
  progress.at(0.1);
  const voxel::Octree own = on_units(answer.octree);
  try {
    const brep::BooleanResult result = brep::boolean(cuberille_of(on_units(a), progress), operation,
                                                     cuberille_of(on_units(b), progress), progress.stop);
    progress.at(0.8);
    compare(own, result.solid, unit_mm3, certificate);
    answer.solid = in_patient(result.solid, a.universe().lps_from_voxel);
    answer.findings = result.findings;
  } catch (const brep::Stopped& stopped) {
    throw voxel::Stopped(stopped.what());
  } catch (const brep::Error& error) {
    lower(certificate, Verdict::Warn,
          std::string("The mesh kernel cannot represent this result on the sets as given: ") + error.what());
  }
  certificate.difference_mm3 = certificate.voxel.volume_mm3 - certificate.mesh.volume_mm3;
  certificate.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  progress.at(1.0);
  return answer;
}

}  // namespace octotomy::verify
