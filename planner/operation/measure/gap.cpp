// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/measure/gap.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "brep/measure/gap.h"
#include "voxel/measure/distance_map.h"
#include "voxel/solid/combine.h"
#include "voxel/tree/voxel_boundary.h"

namespace octotomy::planner {
namespace {

/// The nearest two voxel centres, one in each object.
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

/// Whether one solid lies inside the other, tested at one point of its surface. Precondition: the surfaces do
/// not meet, so one point decides.
bool is_within(const brep::Triangles& one, const brep::Triangles& other) {
  return brep::is_inside(one.points_mm[one.faces.front()[0]], other);
}

/// The least distance between two solids in mm; 0 if one contains a part of the other.
double mesh_gap_mm(const brep::Solid& a, const brep::Solid& b) {
  if (is_within(a.triangles(), b.triangles()) || is_within(b.triangles(), a.triangles())) return 0.0;
  return brep::gap(a.triangles(), b.triangles()).distance_mm;
}

}  // namespace

Gap gap_between(const voxel::Octree& a, const voxel::Octree& b, const std::optional<brep::Solid>& solid_a,
                const std::optional<brep::Solid>& solid_b) {
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
  if (solid_a && solid_b && !solid_a->empty() && !solid_b->empty())
    gap.mesh_mm = mesh_gap_mm(*solid_a, *solid_b);
  return gap;
}

}  // namespace octotomy::planner
