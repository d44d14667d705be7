// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/deck/filling.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "brep/mesh/components.h"
#include "brep/shape/decimate.h"
#include "convert/surface/fill_cavities.h"
#include "convert/tet/hinges.h"
#include "convert/tet/octree_tetrahedra.h"
#include "convert/tet/tetrahedralise.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/number_format.h"
#include "voxel/filter/components.h"

namespace octotomy::planner {
namespace {

/// Parts smaller than this share of the largest part's volume are left out.
constexpr double crumb() {
  return 0.01;
}

/// The mesh without its small fragments. Adds a finding on parts that are left out, and one if several bodies
/// remain.
brep::Solid bodies_of(const brep::Solid& solid, Filling& filling) {
  const auto parts = brep::components(solid);
  std::vector<std::uint32_t> faces;
  std::size_t bodies = 0;
  double left_out_mm3 = 0.0;
  for (const brep::Component& part : parts) {
    if (part.volume_mm3 >= crumb() * parts.front().volume_mm3) {
      faces.insert(faces.end(), part.faces.begin(), part.faces.end());
      ++bodies;
    } else {
      left_out_mm3 += part.volume_mm3;
    }
  }
  filling.bodies = bodies;
  if (bodies > 1)
    filling.findings.push_back("holds " + std::to_string(bodies) +
                               " bodies that do not touch: hold each of them, because a body that is not "
                               "held makes the stiffness matrix singular");
  if (bodies < parts.size())
    filling.findings.push_back(
        std::to_string(parts.size() - bodies) + " crumbs, " + grouped(left_out_mm3, 1) +
        " mm\u00b3 together, are left out: each has less than a hundredth of the largest body's volume");
  if (bodies == parts.size()) return solid;
  return brep::trusted_solid(brep::part_of(solid, faces), brep::proof_of_part(solid.proof()));
}

/// The mesh with all cavities smaller than a voxel filled, because they are noise at the threshold. Adds a
/// finding on their number and volume.
brep::Solid filled(const brep::Solid& solid, const voxel::Universe& universe, Filling& filling) {
  convert::FilledCavities made = convert::fill_cavities(solid, universe.lattice().voxel_mm3());
  if (made.cavities > 0)
    filling.findings.push_back(std::to_string(made.cavities) + " cavities smaller than a voxel, " +
                               grouped(made.volume_mm3, 3) + " mm\u00b3 together, are filled");
  return std::move(made.solid);
}

/// The allowed error of the simplified surface: a third of the voxel's shortest edge, which is below the
/// uncertainty of a sampled surface.
double simplification_mm(const voxel::Universe& universe) {
  const glm::dvec3 edge_mm = universe.lattice().spacing_mm();
  return std::min({edge_mm.x, edge_mm.y, edge_mm.z}) / 3.0;
}

/// Simplifies the surface to fewer, better shaped triangles, because tetrahedra cannot be better than the
/// triangles at their base. If this fails, returns the mesh unchanged, with a finding.
brep::Mesh simplified(const brep::Mesh& mesh, double error_mm, Filling& filling) {
  brep::DecimateOptions options;
  options.max_error_mm = error_mm;
  options.max_aspect = 5.0;
  try {
    brep::Mesh simple = brep::decimate(mesh, options);
    filling.findings.push_back("the surface was simplified from " +
                               grouped(static_cast<double>(mesh.n_faces()), 0) + " to " +
                               grouped(static_cast<double>(simple.n_faces()), 0) + " triangles, within " +
                               grouped(error_mm, 2) + " mm of the exact piece");
    return simple;
  } catch (const std::exception& error) {
    if (!is_no_answer(error)) throw;
    filling.findings.push_back(std::string("the surface was not simplified, because this failed: ") +
                               error.what());
  }
  return mesh;
}

/// The elements of the object's voxels. Small fragments are left out, as with meshes.
Filling fallback_of(const Object& object, const std::string& why, const voxel::Progress& progress) {
  Filling filling;
  const auto parts = voxel::components(object.voxel.octree).voxel_counts;
  const auto least = static_cast<std::uint64_t>(std::ceil(crumb() * static_cast<double>(parts.front())));
  const voxel::Octree bodies = voxel::components_of_at_least(object.voxel.octree, least);
  filling.tetrahedra = convert::tetrahedra_of(bodies, convert::BoundaryCells::Nodes, progress);
  filling.bodies = static_cast<std::size_t>(
      std::count_if(parts.begin(), parts.end(), [&](std::uint64_t voxels) { return voxels >= least; }));
  filling.fallback = true;
  filling.findings.push_back(
      "fallback: " + why +
      "; the elements are the object's voxels, whose surface has steps: do not read stresses at the surface");
  if (bodies.voxel_count() < object.voxel.octree.voxel_count())
    filling.findings.push_back(
        grouped(static_cast<double>(parts.size() - filling.bodies), 0) +
        " crumbs are left out: each has less than a hundredth of the largest body's volume");
  return filling;
}

Filling by_meshers(const Object& object, const FillingOptions& wanted) {
  Filling filling;
  const voxel::Universe& universe = object.voxel.octree.universe();
  const brep::Solid bodies = filled(bodies_of(*object.mesh.within, filling), universe, filling);
  convert::TetOptions options;
  options.mesher = convert::Mesher::Best;
  options.progress = wanted.progress;
  options.finer = wanted.finer;
  // Several times longer than a bone of 50 000 triangles takes.
  options.time_limit = std::chrono::minutes(2);
  filling.tetrahedra =
      convert::tetrahedralise(simplified(bodies, simplification_mm(universe), filling), options);
  for (const std::string& finding : filling.tetrahedra.findings) filling.findings.push_back(finding);
  return filling;
}

/// The elements made by a mesher, or the reason why all meshers failed.
std::variant<Filling, std::string> tried(const Object& object, const FillingOptions& options) {
  if (!object.mesh.within) return "it has no mesh";
  if (object.mesh.within->empty()) return "its mesh is empty";
  try {
    return by_meshers(object, options);
  } catch (const std::exception& error) {
    if (fault_of(error) == Fault::Cancelled)
      throw voxel::Stopped("stopped while " + object.id + " was filled");
    if (!is_no_answer(error)) throw;
    return error.what();
  }
}

}  // namespace

namespace {

std::variant<Filling, std::string> filling_or_fallback(const Object& object, const FillingOptions& options) {
  std::variant<Filling, std::string> made = tried(object, options);
  const bool has_fallback = options.fallback && !object.voxel.octree.is_empty();
  std::optional<std::string> why;
  if (auto* filling = std::get_if<Filling>(&made)) {
    why = convert::fault_in_shape(filling->tetrahedra);
    if (why && !has_fallback)
      filling->findings.push_back(*why + "; \"fallback\": true fills it with its voxels instead");
  } else {
    why = std::get<std::string>(made);
    if (!has_fallback)
      return *why + (options.fallback ? "; and it has no voxels for the fallback"
                                      : "; \"fallback\": true fills it with its voxels instead");
  }
  if (!why || !has_fallback) return made;
  Filling voxels = fallback_of(object, *why, options.progress);
  if (const auto* filling = std::get_if<Filling>(&made))
    for (const std::string& finding : filling->tetrahedra.findings)
      voxels.findings.push_back("before: " + finding);
  return voxels;
}

}  // namespace

std::variant<Filling, std::string> filling_of(const Object& object, const FillingOptions& options) {
  std::variant<Filling, std::string> made = filling_or_fallback(object, options);
  if (auto* filling = std::get_if<Filling>(&made))
    if (std::optional<std::string> hinge = convert::hinge_in(filling->tetrahedra))
      filling->findings.push_back(*std::move(hinge));
  return made;
}

std::vector<std::string> quality_notes(const convert::TetQuality& quality) {
  std::string table = "elements by smallest dihedral angle:";
  const auto& steps = convert::dihedral_steps_deg;
  for (std::size_t i = 0; i < quality.by_dihedral.size(); ++i)
    table += (i == 0             ? " under " + grouped(steps[0], 0)
              : i < steps.size() ? "; " + grouped(steps[i - 1], 0) + " to " + grouped(steps[i], 0)
                                 : "; from " + grouped(steps.back(), 0)) +
             " degrees " + grouped(static_cast<double>(quality.by_dihedral.at(i)), 0);
  return {"dihedral angles " + grouped(quality.min_dihedral_deg, 2) + " to " +
              grouped(quality.max_dihedral_deg, 2) + " degrees; radius-edge ratio up to " +
              grouped(quality.max_radius_edge, 2) + "; volume " + grouped(quality.volume_mm3, 3) + " mm3",
          table};
}

nlohmann::ordered_json quality_json(const convert::TetQuality& quality) {
  return {{"min_dihedral_deg", quality.min_dihedral_deg},      {"max_dihedral_deg", quality.max_dihedral_deg},
          {"max_radius_edge", quality.max_radius_edge},        {"min_volume_mm3", quality.min_volume_mm3},
          {"dihedral_steps_deg", convert::dihedral_steps_deg}, {"by_dihedral", quality.by_dihedral}};
}

}  // namespace octotomy::planner
