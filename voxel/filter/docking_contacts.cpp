// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 Find where edges between centres cross an object's surface, near the part.
// 2 The directions about a crossing that lead out of the object add up to a first normal.
// 3 A crossing is a contact if a step along that normal, no longer than the largest gap, ends in the part.
// 4 A plane through the crossings nearby that face the same way gives the normal. Crossings beyond the part
//   count, too: a plane through contacts alone leans at the part's rim.
#include "voxel/filter/docking_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <map>
#include <stdexcept>
#include <tbb/parallel_for.h>

#include "voxel/measure/distance_map.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/membership.h"
#include "voxel/space/error.h"
#include "voxel/tree/voxel_boundary.h"

namespace octotomy::voxel {
namespace {

/// Directions spread evenly over the unit sphere, along a spiral.
std::vector<glm::dvec3> spread_directions(int count) {
  std::vector<glm::dvec3> found;
  const double golden = glm::pi<double>() * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count, radius = std::sqrt(1.0 - z * z);
    found.emplace_back(radius * std::cos(golden * i), radius * std::sin(golden * i), z);
  }
  return found;
}

/// Where a solid's surface crosses edges between neighbouring voxels' centres, with estimates of its normals.
class Crossings {
 public:
  /// Examines only voxels within the box, LPS. First normals are those of the surface within `reach_mm`.
  Crossings(const PlacedSolid& of, const Box& near, double reach_mm)
      : lattice_(of.octree.universe().lattice()),
        contains_(of.octree.universe(), of.solid),
        reach_mm_(reach_mm) {
    const Octree part = combine(of.octree.universe(), Expression(of.octree) & Expression(near));
    const int side = of.octree.universe().side();
    for (const VoxelFace& face : voxel_boundary(part)) {
      glm::ivec3 beyond = face.voxel;
      beyond[face.axis] += face.side;
      // Faces that only the box or the universe cuts are not part of the solid's surface.
      if (beyond[face.axis] < 0 || beyond[face.axis] >= side || of.octree.contains(beyond)) continue;
      faces_.push_back(face);
    }
  }

  std::size_t size() const { return faces_.size(); }

  glm::dvec3 at(std::size_t i) const {
    const VoxelFace& face = faces_[i];
    glm::dvec3 step(0.0);
    step[face.axis] = face.side;
    double in = 0.0, out = 1.0;
    for (int halving = 0; halving < 8; ++halving) {
      const double middle = 0.5 * (in + out);
      (contains_(lattice_.lps_mm(glm::dvec3(face.voxel) + middle * step)) ? in : out) = middle;
    }
    return lattice_.lps_mm(glm::dvec3(face.voxel) + 0.5 * (in + out) * step);
  }

  /// The outward normal, accurate to some degrees; zero if all surroundings are inside or all are outside. By
  /// Gauss's theorem the area vectors of a surface within a ball add up to those of the part of the sphere that
  /// lies outside of the solid.
  glm::dvec3 first_normal(const glm::dvec3& p_mm) const {
    static const std::vector<glm::dvec3> directions = spread_directions(120);
    glm::dvec3 sum(0.0);
    for (const glm::dvec3& way : directions) sum += contains_(p_mm + reach_mm_ * way) ? -way : way;
    const double length = glm::length(sum);
    return length > 1e-6 ? sum / length : glm::dvec3(0.0);
  }

 private:
  Lattice lattice_;
  Membership contains_;
  double reach_mm_;
  std::vector<VoxelFace> faces_;
};

/// The normal of the plane fitted to points, near the normal `first`. If the points lie on a line, they do
/// not fix the plane; then `first` is only turned until it is perpendicular to the line.
glm::dvec3 plane_normal(const std::vector<glm::dvec3>& points, const glm::dvec3& first) {
  glm::dvec3 middle(0.0);
  for (const glm::dvec3& p : points) middle += p / static_cast<double>(points.size());
  glm::dmat3 spread(0.0);
  for (const glm::dvec3& p : points) spread += glm::outerProduct(p - middle, p - middle);
  const double size = spread[0][0] + spread[1][1] + spread[2][2];
  if (points.size() < 4 || !(size > 0.0)) return first;
  constexpr double share = 1e-3;
  const glm::dmat3 inverse = glm::inverse(spread + share * size * glm::dmat3(1.0));
  glm::dvec3 normal = first;
  for (int step = 0; step < 6; ++step) normal = glm::normalize(inverse * normal);
  return glm::dot(normal, first) < 0.0 ? -normal : normal;
}

/// A crossing with its first normal.
using Place = DockingContact;

/// Places, sorted into cubes with the edge `edge_mm`.
class PlaceGrid {
 public:
  PlaceGrid(const std::vector<Place>& places, double edge_mm) : places_(places), edge_mm_(edge_mm) {
    for (std::size_t i = 0; i < places.size(); ++i) cells_[cell_of(places[i].p_mm)].push_back(i);
  }
  /// The positions in mm of the places within edge_mm of `p_mm` whose first normals are within 37 degrees of
  /// `normal`.
  std::vector<glm::dvec3> alike(const glm::dvec3& p_mm, const glm::dvec3& normal) const {
    constexpr double least_alike = 0.8;
    std::vector<glm::dvec3> found;
    const Cell middle = cell_of(p_mm);
    for (int cell = 0; cell < 27; ++cell) {
      const auto places =
          cells_.find({middle[0] + cell % 3 - 1, middle[1] + cell / 3 % 3 - 1, middle[2] + cell / 9 - 1});
      if (places == cells_.end()) continue;
      for (const std::size_t i : places->second)
        if (glm::distance(places_[i].p_mm, p_mm) <= edge_mm_ &&
            glm::dot(places_[i].normal, normal) > least_alike)
          found.push_back(places_[i].p_mm);
    }
    return found;
  }

 private:
  using Cell = std::array<int, 3>;
  Cell cell_of(const glm::dvec3& p_mm) const {
    const glm::ivec3 at(glm::floor(p_mm / edge_mm_));
    return {at.x, at.y, at.z};
  }

  const std::vector<Place>& places_;
  double edge_mm_;
  std::map<Cell, std::vector<std::size_t>> cells_;
};

/// The box around a solid's voxels and a margin, LPS. Precondition: the octree is not empty.
Box box_about(const Octree& octree, double margin_mm) {
  const VoxelRange range = range_of(octree);
  const Lattice lattice = octree.universe().lattice();
  Box box{glm::dvec3(1e300), glm::dvec3(-1e300)};
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 at(corner & 1 ? range.high.x : range.low.x, corner & 2 ? range.high.y : range.low.y,
                        corner & 4 ? range.high.z : range.low.z);
    const glm::dvec3 p = lattice.lps_mm(at);
    box.low_mm = glm::min(box.low_mm, p);
    box.high_mm = glm::max(box.high_mm, p);
  }
  box.low_mm -= margin_mm;
  box.high_mm += margin_mm;
  return box;
}

}  // namespace

std::vector<DockingContact> docking_contacts(const PlacedSolid& part, const std::vector<PlacedSolid>& objects,
                                             const DockingContactsOptions& options) {
  if (!(options.within_mm > 0.0)) throw InvalidInput("the largest gap of a contact must be above 0 mm");
  if (part.octree.is_empty()) return {};
  const glm::dvec3 spacing_mm = part.octree.universe().lattice().spacing_mm();
  const double edge_mm = std::max({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  const Membership in_part(part.octree.universe(), part.solid);
  const double plane_mm = std::max(options.smooth_mm, 2.0 * edge_mm);
  const Box near = box_about(part.octree, options.within_mm + 2.0 * edge_mm + plane_mm);
  std::vector<DockingContact> contacts;
  for (const PlacedSolid& object : objects) {
    options.progress.at(0.5);
    const Crossings crossings(object, near, std::max(edge_mm, 0.5 * plane_mm));
    std::vector<Place> places(crossings.size());
    std::vector<char> bears(crossings.size(), 0);
    tbb::parallel_for(std::size_t{0}, crossings.size(), [&](std::size_t i) {
      places[i] = {crossings.at(i), {}};
      places[i].normal = crossings.first_normal(places[i].p_mm);
      constexpr int steps = 8;
      for (int step = 1; step <= steps && bears[i] == 0; ++step)
        if (in_part(places[i].p_mm + options.within_mm * step / steps * places[i].normal)) bears[i] = 1;
    });
    std::vector<std::size_t> borne;
    for (std::size_t i = 0; i < places.size(); ++i)
      if (bears[i] != 0 && places[i].normal != glm::dvec3(0.0)) borne.push_back(i);
    const PlaceGrid grid(places, plane_mm);
    const std::size_t before = contacts.size();
    contacts.resize(before + borne.size());
    tbb::parallel_for(std::size_t{0}, borne.size(), [&](std::size_t i) {
      const Place& place = places[borne[i]];
      glm::dvec3 normal = place.normal;
      // Beside an edge the first plane still counts crossings of the other side.
      for (int pass = 0; pass < 2; ++pass) normal = plane_normal(grid.alike(place.p_mm, normal), normal);
      contacts[before + i] = {place.p_mm, normal};
    });
  }
  options.progress.at(1.0);
  return contacts;
}

std::vector<glm::dvec3> pushed_surface(const PlacedSolid& part, const glm::dvec3& push) {
  if (part.octree.is_empty()) return {};
  constexpr double least_facing = 0.5;
  const glm::dvec3 spacing_mm = part.octree.universe().lattice().spacing_mm();
  const Crossings crossings(part, box_about(part.octree, glm::length(spacing_mm)),
                            std::max({spacing_mm.x, spacing_mm.y, spacing_mm.z}));
  std::vector<std::pair<bool, glm::dvec3>> found(crossings.size());
  tbb::parallel_for(std::size_t{0}, crossings.size(), [&](std::size_t i) {
    const glm::dvec3 p = crossings.at(i);
    found[i] = {glm::dot(crossings.first_normal(p), push) <= -least_facing, p};
  });
  std::vector<glm::dvec3> points;
  for (const auto& [is_pushed, p] : found)
    if (is_pushed) points.push_back(p);
  return points;
}

}  // namespace octotomy::voxel
