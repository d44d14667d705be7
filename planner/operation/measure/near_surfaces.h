// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "brep/mesh/solid.h"
#include "voxel/tree/octree.h"

namespace octotomy::planner {

/// A place at which one surface is near another.
struct Contact {
  glm::dvec3 at_mm{0.0};                   ///< the point of the first surface with the least distance
  glm::dvec3 normal{0.0, 0, 1};            ///< outward normal of the first surface there
  double nearest_mm = 0.0;                 ///< the least signed distance; negative if the objects overlap
  std::optional<double> area_mm2;          ///< area of the first surface within the distance limit; none if
                                           ///< only voxels were used
  std::optional<double> voxel_nearest_mm;  ///< least distance at this place by the voxel kernel; none if its
                                           ///< points are elsewhere
};

struct Contacts {
  std::vector<Contact> contacts;  ///< nearest first
  glm::dvec3 nearest_at_mm{0.0};  ///< the point of the whole first surface with the least distance
  double nearest_mm = 0.0;        ///< there
  double voxel_nearest_mm = 0.0;  ///< least distance by the voxel kernel over all places
  bool by_mesh = false;           ///< the mesh kernel answered
};

struct ContactOptions {
  double within_mm = 0.5;  ///< points with a smaller distance are contacts
  double apart_mm = 2.0;   ///< contacts nearer to each other than this are merged; at least half a voxel, or
                           ///< a whole voxel without meshes
};

/// The places at which one object is near another one: computed from triangles if both solids are given, else
/// from voxels. Distances are signed, negative inside the other object, and are computed at points at most
/// half a voxel apart. Areas are sums over triangles; a triangle across the distance limit counts in part.
/// Preconditions: neither octree is empty, both have the same universe, and the options are positive. The
/// same bits on any number of threads. Cost: a search in the other solid's tree for every vertex; a distance
/// map over the first object's extents, 12 bytes per voxel.
Contacts contacts_between(const voxel::Octree& one, const voxel::Octree& other,
                          const std::optional<brep::Solid>& solid_one,
                          const std::optional<brep::Solid>& solid_other, const ContactOptions& options);

/// Signed distances of points to a solid in mm, negative inside.
std::vector<double> signed_distances_mm(const brep::Solid& solid, const std::vector<glm::dvec3>& points_mm);

/// The smallest signed distance of one solid's surface to another solid in mm. Where the surfaces are near
/// each other, it is computed at points at most `spacing_mm` apart.
double least_distance_mm(const brep::Solid& one, const brep::Solid& other, double spacing_mm);

/// A point of one surface that may become the nearest to another surface after small motions.
struct NearPoint {
  glm::dvec3 p_mm{0.0};
  glm::dvec3 away{0.0};      ///< unit vector along which its distance grows fastest
  double distance_mm = 0.0;  ///< signed
  double area_mm2 = 0.0;     ///< area of the surface for which it stands, projected along `away`
};
/// Points of a surface that are near another surface: one for each cell of `spacing_mm`, and all points that
/// overlap. Cells are larger if there would be more than some hundred points. Precondition: neither solid is
/// empty.
std::vector<NearPoint> near_points(const brep::Solid& one, const brep::Solid& other, double spacing_mm);

/// Points of a surface within `radius_mm` of a position, at most `spacing_mm` apart, including corners of
/// triangles.
std::vector<glm::dvec3> points_about(const brep::Solid& solid, const glm::dvec3& place_mm, double radius_mm,
                                     double spacing_mm);

}  // namespace octotomy::planner
