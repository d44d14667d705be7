// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "brep/mesh/solid.h"
#include "voxel/tree/octree.h"

namespace octotomy::planner {

/// A place where one surface comes near another one.
struct Contact {
  glm::dvec3 at_mm{0.0};           ///< of the first surface, where it is nearest or deepest
  glm::dvec3 normal{0.0, 0, 1};    ///< of the first surface there, outward
  double nearest_mm = 0.0;         ///< the least signed distance, negative where it overlaps
  std::optional<double> area_mm2;  ///< of the first surface within the distance; none by voxels alone
  std::optional<double>
      voxel_nearest_mm;  ///< the voxel kernel's answer about that place; none if it has none
};

struct Contacts {
  std::vector<Contact> contacts;  ///< nearest first
  glm::dvec3 nearest_at_mm{0.0};  ///< of all of the first surface
  double nearest_mm = 0.0;        ///< there
  double voxel_nearest_mm = 0.0;  ///< of the voxel kernel
  bool by_mesh = false;           ///< the mesh kernel answered
};

struct ContactOptions {
  double within_mm = 0.5;  ///< what is nearer is a contact
  double apart_mm = 2.0;   ///< places nearer are one; at least half a voxel, of voxels alone a whole one
};

/// Where one object comes near another one: by the triangles of both where both solids are given, else by
/// voxels. Distances are signed, negative inside the other, at points half a voxel apart or nearer. Areas are
/// of triangles, those that the distance passes through in part. Preconditions: neither octree is empty, both
/// are of one universe; distances are positive. The same bits on any number of threads. Cost: a search in the
/// other's tree for every vertex; a distance map over the first one's extents, 12 bytes a voxel.
Contacts contacts_between(const voxel::Octree& one, const voxel::Octree& other,
                          const std::optional<brep::Solid>& solid_one,
                          const std::optional<brep::Solid>& solid_other, const ContactOptions& options);

/// Signed distances of points to a solid, negative inside.
std::vector<double> signed_distances_mm(const brep::Solid& solid, const std::vector<glm::dvec3>& points_mm);

/// The least signed distance of one surface to another one, at points no farther apart than the spacing
/// where they are near.
double least_distance_mm(const brep::Solid& one, const brep::Solid& other, double spacing_mm);

/// A point of one surface that may come nearest to another one.
struct NearPoint {
  glm::dvec3 p_mm{0.0};
  glm::dvec3 away{0.0};      ///< unit, along which its distance grows fastest
  double distance_mm = 0.0;  ///< signed
  double area_mm2 = 0.0;     ///< of the surface that it stands for, seen along `away`
};
/// The nearest points of a surface to another one, those of each place, and all that overlap; a place is as
/// wide as the spacing or, where there are more than some hundred, wider. Preconditions: neither is empty.
std::vector<NearPoint> near_points(const brep::Solid& one, const brep::Solid& other, double spacing_mm);

/// Points of a surface within a radius about a place, no farther apart than the spacing, corners included.
std::vector<glm::dvec3> points_about(const brep::Solid& solid, const glm::dvec3& place_mm, double radius_mm,
                                     double spacing_mm);

}  // namespace octotomy::planner
