// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/object/provenance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "convert/voxel/voxelise.h"
#include "planner/operation/measure/counted_window.h"
#include "planner/operation/table/deformation.h"
#include "verify/witness/witness.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/grey_owner.h"

namespace octotomy::planner {
namespace {

/// The distance that rounding may put between a plane and a vertex on it, after motions of coordinates up to
/// `reach_mm`: a few roundings of a dot product with three terms.
double on_plane_mm(double reach_mm) {
  return 64.0 * std::numeric_limits<double>::epsilon() * reach_mm;
}

/// The planes after a map. A map that scales or shears transforms normals by its inverse transpose. It may
/// also increase the distance of parallel planes by a factor, by which the error of a cut between them grows.
std::vector<CutPlane> moved_planes(std::vector<CutPlane> planes, const glm::dmat4& moved_from_still) {
  const bool is_deforming = !keeps_lengths(moved_from_still);
  const glm::dmat3 of_normals = is_deforming ? glm::inverse(glm::transpose(glm::dmat3(moved_from_still)))
                                             : glm::dmat3(moved_from_still);
  for (CutPlane& plane : planes) {
    const glm::dvec3 point = glm::dvec3(moved_from_still * glm::dvec4(plane.normal * plane.offset_mm, 1.0));
    plane.normal = of_normals * plane.normal;
    if (is_deforming) {
      const double closer = glm::length(plane.normal);
      plane.normal /= closer;
      plane.voxels *= std::max(1.0, 1.0 / closer);
    }
    plane.offset_mm = glm::dot(plane.normal, point);
  }
  return planes;
}

/// Whether a mesh lies within a box, except for the rounding of its points.
bool is_within(const brep::Solid& mesh, const voxel::Box& box) {
  if (mesh.empty()) return true;
  const brep::Size& size = mesh.size();
  const glm::dvec3 rounding_mm(on_plane_mm(glm::length(size.low_mm) + glm::length(size.high_mm)));
  return glm::all(glm::greaterThanEqual(size.low_mm, box.low_mm - rounding_mm)) &&
         glm::all(glm::lessThanEqual(size.high_mm, box.high_mm + rounding_mm));
}

/// The unmoved object of which `made` is an image, and the motion from that object to `made`, in LPS. A later
/// motion of `made` starts from the unmoved object, because `made` lacks the part that left the universe.
Object::Image image_of(const Object& still, const glm::dmat4& moved_from_still, const BoundBench& bench,
                       const Object& made) {
  const Object& first = still_of(bench.objects, still);
  Object::Image image{first.id, moved_from_still};
  if (still.image) image.image_from_object *= still.image->image_from_object;
  const voxel::Box universe = voxel::bounds(bench.universe.lattice());
  image.is_whole = (!first.mesh.whole || is_within(*first.mesh.whole, universe)) &&
                   (made.mesh.whole ? is_within(*made.mesh.whole, universe)
                                    : outside_mm3(first.voxel.octree, image.image_from_object) == 0.0);
  return image;
}

constexpr const char* voxelised_lineage = "the mesh kernel's answer, voxelised";

}  // namespace

bool is_voxelised(const Object& object) {
  return object.voxel.lineage == voxelised_lineage && object.mesh.whole;
}

void voxelise(const brep::Solid& mesh, const voxel::Universe& universe, VoxelSide& made,
              const voxel::Progress& progress) {
  made.octree = convert::voxelise(universe, mesh.linked(), progress);
  made.symbol = voxel::Expression(made.octree);
  made.lineage = voxelised_lineage;
}

bool is_whole_voxels(const VoxelSide& side) {
  if (!side.symbol) return true;
  const voxel::Expression::Term* term = &side.symbol->term();
  while (term->kind == voxel::Expression::Kind::Moved) term = term->left.get();
  term = &voxel::before_samples(*term);
  return term->leaf && std::holds_alternative<voxel::Octree>(*term->leaf);
}

std::vector<CutPlane> ends_of(const voxel::Box& scan, const glm::dvec3& sample_mm,
                              const glm::dvec3& voxel_mm) {
  std::vector<CutPlane> planes;
  for (int axis = 0; axis < 3; ++axis)
    for (const double at_mm : {scan.low_mm[axis], scan.high_mm[axis]}) {
      glm::dvec3 normal(0.0);
      normal[axis] = 1.0;
      planes.push_back({axis, normal, at_mm, sample_mm[axis] / voxel_mm[axis]});
    }
  return planes;
}

bool on_samples(const voxel::Lattice& scan, const voxel::Lattice& universe) {
  const glm::dvec3 first = scan.voxel(universe.lps_mm(glm::dvec3(0.0)));
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 step(0.0);
    step[axis] = 1.0;
    const glm::dvec3 next = scan.voxel(universe.lps_mm(step)) - first;
    // The rounding of a dot product with three terms, in voxels of the largest universe.
    constexpr double rounding = 4096.0 * 64.0 * std::numeric_limits<double>::epsilon();
    if (glm::distance(next, step) > rounding / 4096.0) return false;
    if (std::abs(first[axis] - std::round(first[axis])) > rounding) return false;
  }
  return true;
}

bool on_both_sides(const voxel::Scene& scan, double low, double high) {
  if (!(high < std::numeric_limits<double>::infinity())) return false;
  const voxel::Range range = voxel::range(scan);
  return range.low < low && range.high > high;
}

std::vector<CutPlane> planes_of(const voxel::RegionMask& mask) {
  constexpr double rounding = 8.0 * std::numeric_limits<double>::epsilon();
  std::vector<CutPlane> planes;
  for (const voxel::Region& region : mask.regions)
    for (const auto& polygon : region.polygons_mm)
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        if (a == b) continue;
        const glm::dvec2 across = glm::normalize(glm::dvec2(a.y - b.y, b.x - a.x));
        const glm::dvec3 normal = across.x * region.view.right + across.y * region.view.up;
        for (int axis = 0; axis < 3; ++axis)
          if (std::abs(normal[axis]) >= 1.0 - rounding) planes.push_back({axis, normal, glm::dot(across, a)});
      }
  return planes;
}

void inherit(const Object& operand, Object& made) {
  made.walls.insert(made.walls.end(), operand.walls.begin(), operand.walls.end());
  const BoundTerms& from = operand.bound;
  BoundTerms& to = made.bound;
  to.planes.insert(to.planes.end(), from.planes.begin(), from.planes.end());
  to.spacing_mm = glm::max(to.spacing_mm, from.spacing_mm);
  to.shift_mm += from.shift_mm;
  to.windows.insert(to.windows.end(), from.windows.begin(), from.windows.end());
  to.reshaped.insert(to.reshaped.end(), from.reshaped.begin(), from.reshaped.end());
  to.measured_apart_mm = std::max(to.measured_apart_mm, from.measured_apart_mm);
  if (from.scan_box_mm) to.scan_box_mm = from.scan_box_mm;
}

namespace {

/// Whether an expression contains an object of whole voxels.
bool has_whole_voxels(const voxel::Expression& symbol) {
  std::vector<const voxel::Expression::Term*> left{&symbol.term()};
  while (!left.empty()) {
    const voxel::Expression::Term& term = *left.back();
    left.pop_back();
    if (term.leaf && std::holds_alternative<voxel::Octree>(*term.leaf)) return true;
    for (const auto* operand : {term.left.get(), term.right.get()})
      if (operand != nullptr) left.push_back(operand);
  }
  return false;
}

/// The witness of a moved object. If the object only has voxels that were digitised, as a smoothed or
/// decimated surface has, a motion reads the nearest of these, whose centre may be half a voxel's diagonal
/// away.
verify::Witness witness_of_moved(const Object& still, const glm::dmat4& moved_from_still) {
  verify::Witness moved = verify::carried(still.witness, moved_from_still);
  // A chain of motions reads the voxels of the first object only once.
  const bool is_digitised = !still.bound.reshaped.empty() && !still.moved && still.voxel.symbol &&
                            has_whole_voxels(*still.voxel.symbol);
  if (!is_digitised) return moved;
  const glm::dvec3 voxel_mm = still.voxel.octree.universe().lattice().spacing_mm();
  return verify::with_voxels_within(std::move(moved),
                                    stretch_of(moved_from_still) * 0.5 * glm::length(voxel_mm));
}

}  // namespace

void carry(const std::string& object, const glm::dmat4& moved_from_still, const BoundBench& bench,
           Object& made) {
  const Object& still = bench.objects.at(object);
  made.moved = Object::Moved{still.id, moved_from_still};
  made.image = image_of(still, moved_from_still, bench, made);
  made.witness = witness_of_moved(still, moved_from_still);
  made.walls = still.walls;
  for (CutWall& wall : made.walls) wall.moved_from_still = moved_from_still * wall.moved_from_still;
  made.shown = still.shown;
  if (made.shown) made.shown->moved_from_still = moved_from_still * made.shown->moved_from_still;
  // The scan's axes may already be rotated, so a stretch in any direction widens all spacings.
  const double stretch = stretch_of(moved_from_still);
  made.bound.spacing_mm = stretch * still.bound.spacing_mm;
  made.bound.planes = still.bound.planes;
  made.bound.windows = still.bound.windows;
  for (Shown& window : made.bound.windows)
    window.moved_from_still = moved_from_still * window.moved_from_still;
  made.bound.shift_mm = stretch * still.bound.shift_mm;
  made.bound.reshaped = still.bound.reshaped;
  made.bound.measured_apart_mm = stretch * still.bound.measured_apart_mm;
  if (still.bound.scan_box_mm) {
    const auto ends =
        ends_of(*still.bound.scan_box_mm, still.bound.spacing_mm, bench.universe.lattice().spacing_mm());
    made.bound.planes.insert(made.bound.planes.end(), ends.begin(), ends.end());
  }
  made.bound.planes = moved_planes(std::move(made.bound.planes), moved_from_still);
}

double outside_mm3(const voxel::Octree& still, const glm::dmat4& image_from_still) {
  const voxel::Universe universe = still.universe();
  const voxel::Box box = voxel::bounds(universe.lattice());
  const glm::dmat3 turn = glm::transpose(glm::dmat3(image_from_still));
  // The sides of the universe in the frame of the still object. The normals are normalised, because
  // half-spaces need exact unit vectors. A typed matrix has only a few decimals, and a map that scales or
  // shears does not preserve lengths.
  voxel::Expression outside = voxel::Octree::empty(universe);
  for (int axis = 0; axis < 3; ++axis) {
    const double length = glm::length(turn[axis]), shift_mm = image_from_still[3][axis];
    const glm::dvec3 normal = turn[axis] / length;
    outside = outside |
              voxel::Expression(voxel::HalfSpace{-normal, -(box.high_mm[axis] - shift_mm) / length}) |
              voxel::Expression(voxel::HalfSpace{normal, (box.low_mm[axis] - shift_mm) / length});
  }
  return std::abs(glm::determinant(glm::dmat3(image_from_still))) * universe.lattice().voxel_mm3() *
         static_cast<double>(voxel::combine(universe, voxel::Expression(still) & outside).voxel_count());
}

std::optional<Shown> shown_in_common(const Objects& objects, const std::vector<std::string>& names) {
  const Shown* source = nullptr;
  for (const std::string& name : names) {
    const Object& operand = objects.at(name);
    if (operand.is_tool) continue;
    if (!operand.shown) return std::nullopt;
    const Shown& shown = *operand.shown;
    if (source != nullptr && (shown.threshold != source->threshold || shown.scan != source->scan ||
                              shown.moved_from_still != source->moved_from_still))
      return std::nullopt;
    source = &shown;
  }
  return source == nullptr ? std::nullopt : std::optional(*source);
}

std::optional<std::string> border_finding_of(const Object& object) {
  if (!object.bound.scan_box_mm) return std::nullopt;
  const voxel::Box& scan = *object.bound.scan_box_mm;
  if (object.mesh.within) {
    const glm::dvec3 cut_mm2 =
        area_on_planes(object.mesh.within->triangles(), ends_of(scan, glm::dvec3(1.0), glm::dvec3(1.0)));
    return cut_finding(cut_mm2.x + cut_mm2.y + cut_mm2.z, object.mesh.within->size().area_mm2);
  }
  const voxel::Universe universe = object.voxel.octree.universe();
  const glm::dvec3 voxel_mm = universe.lattice().spacing_mm();
  double cut_mm2 = 0.0;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool is_low : {true, false}) {
      // A layer that is as thick as a voxel contains the centres of one layer of voxels.
      voxel::Box layer = scan;
      (is_low ? layer.high_mm : layer.low_mm)[axis] =
          is_low ? scan.low_mm[axis] + voxel_mm[axis] : scan.high_mm[axis] - voxel_mm[axis];
      const voxel::Octree beside =
          voxel::combine(universe, voxel::Expression(object.voxel.octree) & voxel::Expression(layer));
      cut_mm2 += static_cast<double>(beside.voxel_count()) * universe.lattice().voxel_mm3() / voxel_mm[axis];
    }
  return cut_finding(cut_mm2, object.voxel.measures.area_crofton13_mm2);
}

glm::dvec3 area_on_planes(const brep::Triangles& triangles, const std::vector<CutPlane>& planes) {
  glm::dvec3 area_mm2(0.0);
  if (planes.empty()) return area_mm2;
  for (const auto& face : triangles.faces) {
    const glm::dvec3 &a = triangles.points_mm[face[1]], &b = triangles.points_mm[face[2]],
                     &c = triangles.points_mm[face[0]];
    const auto sum = [](const glm::dvec3& p) { return std::abs(p.x) + std::abs(p.y) + std::abs(p.z); };
    // An upper bound of the sum of lengths that needs no square root. It decides almost all triangles.
    const double surely_off_mm = on_plane_mm(sum(a) + sum(b) + sum(c));
    for (const CutPlane& plane : planes) {
      const auto is_off = [&](const glm::dvec3& p) {
        const double off_mm = std::abs(glm::dot(plane.normal, p) - plane.offset_mm);
        return off_mm > surely_off_mm ||
               off_mm > on_plane_mm(glm::length(a) + glm::length(b) + glm::length(c));
      };
      if (is_off(a) || is_off(b) || is_off(c)) continue;
      area_mm2[plane.axis] += plane.voxels * 0.5 * glm::length(glm::cross(a - c, b - c));
      break;
    }
  }
  return area_mm2;
}

}  // namespace octotomy::planner
