// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "brep/mesh/solid.h"
#include "voxel/tree/octree.h"

namespace octotomy::planner {

/// A place at which one surface is near another one.
struct Contact {
  glm::dvec3 at_mm{0.0};                   ///< point of the first surface that is nearest or deepest
  glm::dvec3 normal{0.0, 0, 1};            ///< outward normal of the first surface there
  double nearest_mm = 0.0;                 ///< the least signed distance, negative if they overlap
  std::optional<double> area_mm2;          ///< of the first surface within the distance; none by voxels alone
  std::optional<double> voxel_nearest_mm;  ///< the voxel kernel's distance at that place; none if it has none
};

struct Contacts {
  std::vector<Contact> contacts;  ///< nearest first
  glm::dvec3 nearest_at_mm{0.0};  ///< nearest point of the whole first surface
  double nearest_mm = 0.0;        ///< there
  double voxel_nearest_mm = 0.0;  ///< least distance by the voxel kernel
  bool by_mesh = false;           ///< the mesh kernel answered
};

struct ContactOptions {
  double within_mm = 0.5;  ///< points nearer than this are contacts
  double apart_mm = 2.0;   ///< places nearer than this are merged; at least half a voxel, or a whole voxel
                           ///< without meshes
};

/// The places at which one object is near another one: by triangles if both solids are given, else by voxels.
/// Distances are signed, negative inside the other, at points at most half a voxel apart. Areas are those of
/// triangles, with partial areas where the distance limit crosses a triangle. Preconditions: neither octree
/// is empty, both are of one universe; distances are positive. The same bits on any number of threads. Cost:
/// a search in the other's tree for every vertex; a distance map over the first one's extents, 12 bytes per
/// voxel.
Contacts contacts_between(const voxel::Octree& one, const voxel::Octree& other,
                          const std::optional<brep::Solid>& solid_one,
                          const std::optional<brep::Solid>& solid_other, const ContactOptions& options);

/// Signed distances of points to a solid, negative inside.
std::vector<double> signed_distances_mm(const brep::Solid& solid, const std::vector<glm::dvec3>& points_mm);

/// The smallest signed distance of one surface to another one. Where the surfaces are near each other, it is
/// computed at points no farther apart than the spacing.
double least_distance_mm(const brep::Solid& one, const brep::Solid& other, double spacing_mm);

/// A point of one surface that may come nearest to another one.
struct NearPoint {
  glm::dvec3 p_mm{0.0};
  glm::dvec3 away{0.0};      ///< unit vector along which its distance grows fastest
  double distance_mm = 0.0;  ///< signed
  double area_mm2 = 0.0;     ///< area of the surface that it represents, seen along `away`
};
/// The points of a surface nearest to another one, one for each cell of the spacing, and all that overlap.
/// Cells are wider if there would be more than some hundred points. Preconditions: neither is empty.
std::vector<NearPoint> near_points(const brep::Solid& one, const brep::Solid& other, double spacing_mm);

/// Points of a surface within a radius around a position, no farther apart than the spacing, corners
/// included.
std::vector<glm::dvec3> points_about(const brep::Solid& solid, const glm::dvec3& place_mm, double radius_mm,
                                     double spacing_mm);

}  // namespace octotomy::planner
