// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 Faces in the order of their plane, then row by row.
// 2 Faces beside each other in a row, and in rows beside each other, are joined (union-find).
// 3 Parts larger than a curved surface's count.
#include "voxel/measure/flat_parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>
#include <vector>

#include "voxel/tree/voxel_boundary.h"

namespace octotomy::voxel {
namespace {

int along(const VoxelFace& face, int by) {
  return face.voxel[(face.axis + by) % 3];
}
auto place_of(const VoxelFace& face) {
  return std::tuple(face.axis, face.side, along(face, 0), along(face, 2), along(face, 1));
}

std::size_t root_of(std::vector<std::size_t>& part, std::size_t i) {
  while (part[i] != i) i = part[i] = part[part[i]];
  return i;
}

}  // namespace

glm::dvec3 flat_parts_mm2(const Octree& octree) {
  std::vector<VoxelFace> faces = voxel_boundary(octree);
  const auto before = [](const VoxelFace& a, const VoxelFace& b) { return place_of(a) < place_of(b); };
  std::sort(faces.begin(), faces.end(), before);
  std::vector<std::size_t> part(faces.size());
  std::iota(part.begin(), part.end(), std::size_t{0});
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (const int by : {1, 2}) {
      VoxelFace beside = faces[i];
      --beside.voxel[(beside.axis + by) % 3];
      const auto found = std::lower_bound(faces.begin(), faces.end(), beside, before);
      if (found == faces.end() || place_of(*found) != place_of(beside)) continue;
      part[root_of(part, i)] = root_of(part, static_cast<std::size_t>(found - faces.begin()));
    }
  const glm::dvec3 spacing_mm = octree.universe().lattice().spacing_mm();
  const glm::dvec3 face_mm2(spacing_mm.y * spacing_mm.z, spacing_mm.z * spacing_mm.x,
                            spacing_mm.x * spacing_mm.y);
  std::vector<double> area_mm2(faces.size(), 0.0);
  double all_mm2 = 0.0;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    area_mm2[root_of(part, i)] += face_mm2[faces[i].axis];
    all_mm2 += face_mm2[faces[i].axis];
  }
  glm::dvec3 flat_mm2(0.0);
  for (std::size_t i = 0; i < faces.size(); ++i)
    if (area_mm2[i] > 2.0 * spacing_mm[faces[i].axis] * std::sqrt(std::numbers::pi * all_mm2))
      flat_mm2[faces[i].axis] += area_mm2[i];
  return flat_mm2;
}

}  // namespace octotomy::voxel
