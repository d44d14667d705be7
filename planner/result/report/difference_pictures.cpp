// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/difference_pictures.h"

#include <algorithm>
#include <cmath>

#include "brep/mesh/distance.h"
#include "voxel/tree/voxel_boundary.h"
#include "voxel/view/surface_scalar.h"

namespace octotomy::planner {
namespace {

constexpr int difference_picture_px = 420;

/// The signed distance to a solid at all voxels that shading at the boundary may use; 0 elsewhere.
voxel::SurfaceScalar distances_to(const brep::Solid& solid, const voxel::Octree& octree) {
  voxel::SurfaceScalar scalar{octree.universe(), voxel::grown(voxel::range_of(octree), 2), {}, 1.0};
  const glm::ivec3 dims = scalar.range.dims();
  const auto index = [&](const glm::ivec3& v) {
    const glm::ivec3 at = v - scalar.range.low;
    return static_cast<std::size_t>(at.x) +
           static_cast<std::size_t>(dims.x) *
               (static_cast<std::size_t>(at.y) +
                static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(at.z));
  };
  scalar.values.assign(
      static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(dims.z),
      0.0f);
  std::vector<bool> wanted(scalar.values.size(), false);
  const std::vector<voxel::VoxelFace> boundary = voxel::voxel_boundary(octree);
  for (const voxel::VoxelFace& face : boundary)
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) wanted[index(face.voxel + glm::ivec3(x, y, z))] = true;
  const voxel::Lattice lattice = octree.universe().lattice();
  std::vector<glm::dvec3> points_mm;
  std::vector<std::size_t> places;
  glm::ivec3 v;
  for (v.z = scalar.range.low.z; v.z <= scalar.range.high.z; ++v.z)
    for (v.y = scalar.range.low.y; v.y <= scalar.range.high.y; ++v.y)
      for (v.x = scalar.range.low.x; v.x <= scalar.range.high.x; ++v.x)
        if (wanted[index(v)]) {
          places.push_back(index(v));
          points_mm.push_back(lattice.lps_mm(v));
        }
  const brep::SurfaceTree& tree = solid.tree();
  const std::vector<double> distances_mm = tree.distances_mm(points_mm);
  const std::vector<std::uint8_t> inside = tree.inside(points_mm);
  for (std::size_t i = 0; i < places.size(); ++i)
    scalar.values[places[i]] = static_cast<float>(inside[i] ? -distances_mm[i] : distances_mm[i]);
  scalar.most = 0.5 * glm::length(lattice.spacing_mm());
  for (const voxel::VoxelFace& face : boundary)
    scalar.most = std::max(scalar.most, std::abs(static_cast<double>(scalar.values[index(face.voxel)])));
  return scalar;
}

}  // namespace

DifferencePictures difference_pictures(const verify::Contested& contested) {
  voxel::SurfaceScalar scalar = distances_to(*contested.solid, contested.octree);
  DifferencePictures pictures;
  pictures.most_mm = scalar.most;
  pictures.group.name = "difference";
  pictures.group.title = "Where the kernels differ most";
  voxel::DrawnObject drawn{contested.certificate.operation, contested.octree};
  drawn.scalar = std::make_shared<const voxel::SurfaceScalar>(std::move(scalar));
  pictures.group.objects.push_back(std::move(drawn));
  draw(pictures.group, {"35,20", "-145,20", "superior", "inferior"}, pictures.group.objects,
       difference_picture_px);
  return pictures;
}

}  // namespace octotomy::planner
