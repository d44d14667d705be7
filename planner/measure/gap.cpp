// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/measure/gap.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "brep/measure/gap.h"
#include "brep/mesh/distance.h"
#include "brep/mesh/triangles.h"
#include "voxel/measure/distance_map.h"
#include "voxel/solid/combine.h"
#include "voxel/tree/voxel_boundary.h"

namespace octotomy::planner {
namespace {

/// The two voxels, one of each, whose centres are nearest.
struct NearestVoxels {
  glm::ivec3 a{0}, b{0};
};

NearestVoxels nearest_voxels(const voxel::Octree& a, const voxel::Octree& b) {
  const voxel::DistanceMap to_b = voxel::distance_map(b, voxel::range_of(a));
  NearestVoxels nearest;
  float least = std::numeric_limits<float>::infinity();
  for (const voxel::VoxelFace& face : voxel::voxel_boundary(a))
    if (const float square = to_b.square_mm2[to_b.index(face.voxel)]; square < least) {
      least = square;
      nearest.a = face.voxel;
    }
  const glm::dvec3 spacing_mm = a.universe().lattice().spacing_mm();
  double least_of_b = std::numeric_limits<double>::infinity();
  for (const voxel::VoxelFace& face : voxel::voxel_boundary(b)) {
    const glm::dvec3 between_mm = glm::dvec3(face.voxel - nearest.a) * spacing_mm;
    if (const double square = glm::dot(between_mm, between_mm); square < least_of_b) {
      least_of_b = square;
      nearest.b = face.voxel;
    }
  }
  return nearest;
}

/// Whether a point of one is inside the other. Where their surfaces do not meet, one decides for all.
bool is_within(const brep::Triangles& one, const brep::Triangles& other) {
  return brep::is_inside(one.points_mm[one.faces.front()[0]], other);
}

/// 0 where one solid holds a part of the other.
double mesh_gap_mm(const brep::Mesh& a, const brep::Mesh& b) {
  const brep::Triangles surface_a = brep::triangles_of(a), surface_b = brep::triangles_of(b);
  if (is_within(surface_a, surface_b) || is_within(surface_b, surface_a)) return 0.0;
  return brep::gap(a, b).distance_mm;
}

}  // namespace

Gap gap_between(const voxel::Octree& a, const voxel::Octree& b, const brep::Mesh* mesh_a,
                const brep::Mesh* mesh_b) {
  const voxel::Lattice lattice = a.universe().lattice();
  Gap gap;
  gap.overlap_mm3 =
      static_cast<double>(
          voxel::combine(a.universe(), voxel::Expression(a) & voxel::Expression(b)).voxel_count()) *
      lattice.voxel_mm3();
  const NearestVoxels nearest = nearest_voxels(a, b);
  gap.from_mm = lattice.lps_mm(nearest.a);
  gap.to_mm = lattice.lps_mm(nearest.b);
  if (gap.overlap_mm3 == 0.0)
    gap.voxel_mm =
        glm::length(glm::dvec3(glm::max(glm::abs(nearest.b - nearest.a) - 1, 0)) * lattice.spacing_mm());
  if (mesh_a != nullptr && mesh_b != nullptr && mesh_a->n_faces() > 0 && mesh_b->n_faces() > 0)
    gap.mesh_mm = mesh_gap_mm(*mesh_a, *mesh_b);
  return gap;
}

}  // namespace octotomy::planner
