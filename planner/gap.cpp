// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/gap.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "brep/distance.h"
#include "brep/triangles.h"
#include "verify/voxel_boundary.h"
#include "voxel/combine.h"
#include "voxel/distance_map.h"

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
  for (const verify::VoxelFace& face : verify::voxel_boundary(a))
    if (const float square = to_b.square_mm2[to_b.index(face.voxel)]; square < least) {
      least = square;
      nearest.a = face.voxel;
    }
  const glm::dvec3 spacing_mm = a.universe().lattice().spacing_mm();
  double least_of_b = std::numeric_limits<double>::infinity();
  for (const verify::VoxelFace& face : verify::voxel_boundary(b)) {
    const glm::dvec3 between_mm = glm::dvec3(face.voxel - nearest.a) * spacing_mm;
    if (const double square = glm::dot(between_mm, between_mm); square < least_of_b) {
      least_of_b = square;
      nearest.b = face.voxel;
    }
  }
  return nearest;
}

/// From the vertices of one to the triangles of the other; 0 where one of them is inside.
double one_way_mm(const brep::Triangles& from, const brep::Triangles& to) {
  const brep::SurfaceTree tree(to);
  const std::vector<std::uint8_t> inside = tree.inside(from.points_mm);
  if (std::find(inside.begin(), inside.end(), 1) != inside.end()) return 0.0;
  const std::vector<double> distances_mm = tree.distances_mm(from.points_mm);
  return *std::min_element(distances_mm.begin(), distances_mm.end());
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
  if (mesh_a != nullptr && mesh_b != nullptr && mesh_a->n_faces() > 0 && mesh_b->n_faces() > 0) {
    const brep::Triangles of_a = brep::triangles_of(*mesh_a), of_b = brep::triangles_of(*mesh_b);
    gap.mesh_mm = std::min(one_way_mm(of_a, of_b), one_way_mm(of_b, of_a));
  }
  return gap;
}

}  // namespace octotomy::planner
