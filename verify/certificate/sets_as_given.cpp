// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certificate/sets_as_given.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/triangles.h"
#include "convert/surface/cuberille.h"
#include "convert/voxel/voxelise.h"
#include "verify/certificate/certify_operation.h"
#include "verify/certificate/exact_agreement.h"
#include "verify/question/expression_on_meshes.h"
#include "voxel/codes/cuberille_faces.h"
#include "voxel/solid/combine.h"
#include "voxel/space/error.h"
#include "voxel/space/rounded.h"

namespace octotomy::verify {
namespace {

/// Units per voxel edge. With two, the coordinates of a cuberille's corners and half-way points are integers.
constexpr double units = 2.0;

voxel::Octree on_units(const voxel::Octree& set) {
  voxel::Universe universe = set.universe();
  universe.lps_from_voxel = glm::dmat4(units);
  universe.lps_from_voxel[3] = glm::dvec4(glm::dvec3(0.5 * units), 1.0);
  return {universe, voxel::Block::share(set.root())};
}

/// Distance, in units, by which each of two touching sheets of one set is moved: more than the rounding of
/// points, less than the shift of an operand in corefinement.
double parted_units(int side) {
  return 1e-6 * units * side;
}

/// Moves apart the sheets of the surface that touch. It moves corners that coincide with other corners, and
/// points that are no corners of voxels, because these lie on an edge of another sheet. Each point moves
/// along the mean normal of its own sheet: inward if the voxel behind the point is in the set, otherwise
/// outward.
void part_sheets(const voxel::Octree& set, double by, brep::Triangles& surface) {
  std::vector<std::size_t> order(surface.points_mm.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto place = [&](std::size_t i) {
    const glm::dvec3& p = surface.points_mm[i];
    return std::tie(p.x, p.y, p.z);
  };
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return place(i) < place(j); });
  std::vector<bool> shares(order.size());
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const glm::dvec3 corner = units * glm::round(surface.points_mm[i] / units);
    shares[i] = surface.points_mm[i] != corner;
  }
  for (std::size_t k = 1; k < order.size(); ++k)
    if (place(order[k - 1]) == place(order[k])) shares[order[k - 1]] = shares[order[k]] = true;
  if (std::find(shares.begin(), shares.end(), true) == shares.end()) return;
  std::vector<glm::dvec3> normals(order.size());
  for (const auto& face : surface.faces) {
    const glm::dvec3& p = surface.points_mm[face[0]];
    const glm::dvec3 normal = glm::cross(surface.points_mm[face[1]] - p, surface.points_mm[face[2]] - p);
    for (const auto corner : face) normals[corner] += normal;
  }
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (!shares[i] || normals[i] == glm::dvec3(0.0)) continue;
    const glm::dvec3 outward = glm::normalize(normals[i]);
    const glm::ivec3 behind(glm::floor((surface.points_mm[i] - outward) / units));
    const bool is_solid = glm::all(glm::greaterThanEqual(behind, glm::ivec3(0))) &&
                          glm::all(glm::lessThan(behind, glm::ivec3(set.universe().side()))) &&
                          set.contains(behind);
    surface.points_mm[i] += (is_solid ? -by : by) * outward;
  }
  if (brep::health(surface).self_intersections > 0)
    throw brep::Error(
        brep::ErrorCode::Geometry,
        "voxels of a set touch at an edge or corner where the sheets of its surface cannot be moved apart");
}

brep::Solid cuberille_of(const voxel::Octree& set, const voxel::Progress& progress) {
  const convert::LatticeSurface surface =
      convert::cuberille(set, convert::Touching::Apart, {progress.stop, {}});
  brep::Triangles triangles;
  triangles.faces = surface.faces;
  for (const glm::ivec3& p_half : surface.points_half) triangles.points_mm.emplace_back(p_half);
  part_sheets(set, parted_units(set.universe().side()), triangles);
  return brep::trusted_solid(std::move(triangles), brep::Proof::Construction);
}

/// Rounds coordinates to integers if they are within `near` of them. The other coordinates belong to points
/// in the middle of a face or side, on which the volume does not depend. Also returns the largest distance of
/// a triangle from the nearest plane between voxels. Lengths are in units.
std::pair<brep::Mesh, double> on_lattice(brep::Mesh mesh, double near) {
  double farthest = 0.0;
  for (const auto face : mesh.faces()) {
    glm::dvec3 low(1e300), high(-1e300);
    for (const auto v : face.vertices()) {
      const brep::Mesh::Point& p = mesh.point(v);
      low = glm::min(low, glm::dvec3(p[0], p[1], p[2]));
      high = glm::max(high, glm::dvec3(p[0], p[1], p[2]));
    }
    const glm::dvec3 planes = units * glm::round(0.5 * (low + high) / units);
    const glm::dvec3 off = glm::max(glm::abs(low - planes), glm::abs(high - planes));
    farthest = std::max(farthest, std::min({off.x, off.y, off.z}));
  }
  for (const auto v : mesh.vertices()) {
    brep::Mesh::Point p = mesh.point(v);
    for (unsigned axis = 0; axis < 3; ++axis)
      if (std::abs(p[axis] - std::round(p[axis])) <= near) p[axis] = std::round(p[axis]);
    mesh.set_point(v, p);
  }
  return {std::move(mesh), farthest};
}

/// Converts from units to LPS millimetres.
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

void compare(const voxel::Octree& octree, const brep::Solid& solid, double near, double unit_mm3,
             Certificate& certificate) {
  const auto fail = [&](const std::string& reason) { lower(certificate, Verdict::Fail, reason); };
  const auto [whole, farthest] = on_lattice(solid.mesh(), near);
  if (farthest > near)
    fail("A triangle of the mesh kernel's answer lies " + voxel::rounded(farthest / units) +
         " voxels off the planes between voxels.");
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
      octree.universe(), voxel::Expression(octree) ^ convert::voxelise(octree.universe(), solid.linked()));
  certificate.symmetric_difference_mm3 = static_cast<double>(differing.voxel_count()) * unit_mm3;
  if (!differing.is_empty())
    fail("Voxels with a total volume of " + voxel::rounded(certificate.symmetric_difference_mm3) +
         " mm3 are inside for one kernel only.");
}

/// The mesh kernel's answer in units, and the corefinements' findings.
struct Corefined {
  brep::Solid solid;
  double shift_units = 0.0;  ///< how far operands were moved
  std::vector<std::string> findings;
};

/// Certifies an octree against the solid that `corefine` returns.
SetsAnswer certified(voxel::Octree octree, const std::string& operation,
                     const std::function<Corefined()>& corefine, const voxel::Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const voxel::Universe& universe = octree.universe();
  const double unit_mm3 = universe.lattice().voxel_mm3();
  const double face_mm2 = std::pow(unit_mm3, 2.0 / 3.0);
  SetsAnswer answer{std::move(octree), {}, 0.0, {}, {}};
  Certificate& certificate = answer.certificate;
  certificate.tier = Tier::Exact;
  certificate.operation = operation;
  certificate.voxel = {
      "Boolean of octrees on the sets as given", static_cast<double>(answer.octree.voxel_count()) * unit_mm3,
      static_cast<double>(voxel::cuberille_faces(answer.octree).face_count()) * face_mm2, std::nullopt};
  certificate.mesh = {"corefinement of the same sets' cuberilles", 0.0, 0.0, std::nullopt};
  progress.at(0.1);
  try {
    Corefined corefined = corefine();
    progress.at(0.8);
    // Points are rounded to a few units in the last place of the largest coordinate.
    const double rounding = 64.0 * std::numeric_limits<double>::epsilon() * units * universe.side();
    const double near = corefined.shift_units + parted_units(universe.side()) + rounding;
    compare(on_units(answer.octree), corefined.solid, near, unit_mm3, certificate);
    answer.solid = in_patient(corefined.solid, universe.lps_from_voxel);
    answer.shift_mm = near / units * glm::length(universe.lattice().spacing_mm());
    answer.findings = std::move(corefined.findings);
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

}  // namespace

SetsAnswer certify_sets(const voxel::Octree& a, brep::Operation operation, const voxel::Octree& b,
                        const voxel::Progress& progress) {
  if (!(a.universe() == b.universe()))
    throw voxel::InvalidInput("both sets of voxels must have the same universe");
  const auto corefine = [&]() -> Corefined {
    brep::BooleanResult result = brep::boolean(cuberille_of(on_units(a), progress), operation,
                                               cuberille_of(on_units(b), progress), progress.stop);
    return {std::move(result.solid), result.shift_mm, std::move(result.findings)};
  };
  return certified(voxel::combine(a.universe(), expression_of(a, operation, b)), text_of(operation), corefine,
                   progress);
}

SetsAnswer certify_sets(std::string_view expression,
                        const std::function<voxel::Octree(std::string_view)>& set,
                        const voxel::Progress& progress) {
  std::map<std::string, voxel::Octree, std::less<>> sets;
  for (const std::string& name : voxel::names_in(expression)) {
    const auto& [found, added] = sets.emplace(name, set(name));
    if (!(found->second.universe() == sets.begin()->second.universe()))
      throw voxel::InvalidInput("all sets of voxels must have the same universe");
  }
  voxel::Names names;
  names.object = [&](std::string_view name) { return voxel::Expression(sets.find(name)->second); };
  const voxel::Expression parsed = voxel::parse_expression(expression, names);
  const voxel::Universe universe = sets.begin()->second.universe();
  const auto corefine = [&]() -> Corefined {
    MeshExpressions meshes(cuberille_of(on_units(voxel::Octree::full(universe)), progress));
    brep::Solid solid = meshes.evaluate(
        expression,
        [&](std::string_view name) { return cuberille_of(on_units(sets.find(name)->second), progress); },
        progress.stop);
    return {std::move(solid), meshes.shift_mm(), meshes.findings()};
  };
  return certified(voxel::combine(universe, parsed), std::string(expression), corefine, progress);
}

}  // namespace octotomy::verify
