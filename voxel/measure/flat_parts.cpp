// 1 Sort the faces by plane, then row by row, as 64-bit numbers.
// 2 Join faces beside each other in a row, and in neighbouring rows (union-find).
// 3 Sum the areas of the parts that are too large for a curved surface.
#include "voxel/measure/flat_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <tbb/parallel_sort.h>
#include <vector>

#include "voxel/tree/voxel_boundary.h"

namespace octotomy::voxel {
namespace {

constexpr int bits = 20;  // number of bits for a coordinate; a universe needs fewer
constexpr std::uint64_t one_row = 1u << bits;

/// Ascends by axis, side, plane, row and column.
std::uint64_t key_of(const VoxelFace& face) {
  const auto along = [&](int by) { return static_cast<std::uint64_t>(face.voxel[(face.axis + by) % 3]); };
  return ((static_cast<std::uint64_t>(2 * face.axis + (face.side > 0)) << bits | along(0)) << bits | along(2))
             << bits |
         along(1);
}
int axis_of(std::uint64_t key) {
  return static_cast<int>(key >> (3 * bits)) / 2;
}

std::size_t root_of(std::vector<std::size_t>& part, std::size_t i) {
  while (part[i] != i) i = part[i] = part[part[i]];
  return i;
}

}  // namespace

glm::dvec3 flat_parts_mm2(const Octree& octree) {
  std::vector<std::uint64_t> faces;
  for (const VoxelFace& face : voxel_boundary(octree)) faces.push_back(key_of(face));
  tbb::parallel_sort(faces.begin(), faces.end());
  std::vector<std::size_t> part(faces.size());
  std::iota(part.begin(), part.end(), std::size_t{0});
  // Index of the first face not sorted before the neighbour of face i in the preceding row.
  std::size_t row_before = 0;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    // Faces in the first column or row have no preceding neighbour; for them, the number below belongs to
    // another row or plane.
    if ((faces[i] & (one_row - 1)) != 0 && i > 0 && faces[i - 1] == faces[i] - 1)
      part[root_of(part, i)] = root_of(part, i - 1);
    if ((faces[i] >> bits & (one_row - 1)) == 0) continue;
    while (faces[row_before] < faces[i] - one_row) ++row_before;
    if (faces[row_before] == faces[i] - one_row) part[root_of(part, i)] = root_of(part, row_before);
  }
  const glm::dvec3 spacing_mm = octree.universe().lattice().spacing_mm();
  const glm::dvec3 face_mm2(spacing_mm.y * spacing_mm.z, spacing_mm.z * spacing_mm.x,
                            spacing_mm.x * spacing_mm.y);
  std::vector<double> area_mm2(faces.size(), 0.0);
  double all_mm2 = 0.0;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    area_mm2[root_of(part, i)] += face_mm2[axis_of(faces[i])];
    all_mm2 += face_mm2[axis_of(faces[i])];
  }
  glm::dvec3 flat_mm2(0.0);
  for (std::size_t i = 0; i < faces.size(); ++i)
    if (area_mm2[i] > 2.0 * spacing_mm[axis_of(faces[i])] * std::sqrt(std::numbers::pi * all_mm2))
      flat_mm2[axis_of(faces[i])] += area_mm2[i];
  return flat_mm2;
}

}  // namespace octotomy::voxel
