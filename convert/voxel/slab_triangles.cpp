// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/voxel/slab_triangles.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <tbb/parallel_for.h>

#include "voxel/space/error.h"
#include "voxel/tree/build.h"

namespace octotomy::convert {
namespace {

/// Converts LPS millimetres to a universe's index space.
class VoxelFromLps {
 public:
  explicit VoxelFromLps(const voxel::Universe& universe)
      : voxel_from_lps_(glm::inverse(glm::dmat3(universe.lps_from_voxel))),
        first_mm_(universe.lps_from_voxel[3]) {}
  glm::dvec3 operator()(const glm::dvec3& p_mm) const { return voxel_from_lps_ * (p_mm - first_mm_); }

 private:
  glm::dmat3 voxel_from_lps_;
  glm::dvec3 first_mm_;
};

std::vector<glm::dvec3> points_in_index_space(const voxel::Universe& universe,
                                              const std::vector<glm::dvec3>& points_mm) {
  const VoxelFromLps voxel_from_lps(universe);
  std::vector<glm::dvec3> points(points_mm.size());
  tbb::parallel_for(std::size_t{0}, points.size(),
                    [&](std::size_t v) { points[v] = voxel_from_lps(points_mm[v]); });
  for (std::size_t v = 0; v < points.size(); ++v)
    if (!std::isfinite(points[v].x + points[v].y + points[v].z))
      throw voxel::Error(voxel::ErrorCode::Geometry,
                         "voxelise: vertex " + std::to_string(v) + " has a coordinate that is not finite");
  return points;
}

}  // namespace

std::vector<Corners> triangles_in_index_space(const voxel::Universe& universe, const brep::Triangles& mesh) {
  const std::vector<glm::dvec3> points = points_in_index_space(universe, mesh.points_mm);
  std::vector<Corners> triangles(mesh.faces.size());
  tbb::parallel_for(std::size_t{0}, triangles.size(), [&](std::size_t f) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t point = mesh.faces[f][i];
      if (point >= points.size())
        throw voxel::Error(voxel::ErrorCode::Geometry, "voxelise: triangle " + std::to_string(f) +
                                                           " names point " + std::to_string(point) +
                                                           ", there are " + std::to_string(points.size()));
      triangles[f][i] = points[point];
    }
  });
  return triangles;
}

SlabLists sort_into_slabs(const std::vector<Corners>& triangles, int side,
                          const std::function<std::pair<int, int>(const Corners&)>& layers_of) {
  const int slab_count = (side + slab_layers - 1) / slab_layers;
  std::vector<std::pair<int, int>> slabs(triangles.size());
  tbb::parallel_for(std::size_t{0}, triangles.size(), [&](std::size_t t) {
    const auto [first, end] = layers_of(triangles[t]);
    if (first < end) slabs[t] = {first / slab_layers, (end - 1) / slab_layers + 1};
  });
  SlabLists lists;
  lists.first.assign(static_cast<std::size_t>(slab_count) + 1, 0);
  for (auto [slab, end] : slabs)
    for (; slab < end; ++slab) ++lists.first[static_cast<std::size_t>(slab) + 1];
  for (std::size_t slab = 1; slab < lists.first.size(); ++slab) lists.first[slab] += lists.first[slab - 1];
  lists.triangles.resize(lists.first.back());
  std::vector<std::size_t> next(lists.first.begin(), lists.first.end() - 1);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (auto [slab, end] = slabs[t]; slab < end; ++slab)
      lists.triangles[next[static_cast<std::size_t>(slab)]++] = static_cast<std::uint32_t>(t);
  return lists;
}

int first_not_below(double v, int low, int high) {
  return static_cast<int>(std::clamp(std::ceil(v), static_cast<double>(low), static_cast<double>(high)));
}

std::pair<int, int> layers_cut(const Corners& corners, int side) {
  const auto [low, high] = std::minmax({corners[0].z, corners[1].z, corners[2].z});
  return {first_not_below(low, 0, side), first_not_below(high, 0, side)};
}

LayerCut cut_by_layer(const Corners& corners, int z) {
  const auto point = [z](const glm::dvec3& low, const glm::dvec3& high) {
    const double t = (z - low.z) / (high.z - low.z);
    return glm::dvec2(low) + t * (glm::dvec2(high) - glm::dvec2(low));
  };
  assert(std::min({corners[0].z, corners[1].z, corners[2].z}) <= z &&
         z < std::max({corners[0].z, corners[1].z, corners[2].z}));
  glm::dvec2 upward(0.0);
  glm::dvec2 downward(0.0);
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3& a = corners[i];
    const glm::dvec3& b = corners[(i + 1) % 3];
    if (a.z <= z && b.z > z) upward = point(a, b);
    if (b.z <= z && a.z > z) downward = point(b, a);
  }
  if (upward.y <= downward.y) return {upward, downward, true};
  return {downward, upward, false};
}

BlockGrid::BlockGrid(const voxel::Universe& universe)
    : universe_(universe),
      side_(std::max(universe.side() / slab_layers, 1)),
      blocks_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_) *
              static_cast<std::size_t>(side_)) {}

voxel::Block& BlockGrid::at(const glm::ivec3& block) {
  assert(glm::all(glm::greaterThanEqual(block, glm::ivec3(0))) &&
         glm::all(glm::lessThan(block, glm::ivec3(side_))));
  const auto n = static_cast<std::size_t>(side_);
  return blocks_[(static_cast<std::size_t>(block.z) * n + static_cast<std::size_t>(block.y)) * n +
                 static_cast<std::size_t>(block.x)];
}

voxel::Octree BlockGrid::take_octree() {
  return voxel::octree_of_blocks(universe_, [&](const glm::ivec3& block) { return std::move(at(block)); });
}

voxel::Block leaf_block_of_rows(const std::array<std::uint16_t, 256>& row) {
  std::array<std::uint64_t, 64> words{};
  for (int z = 0; z < 16; ++z)
    for (int y = 0; y < 16; ++y) {
      const std::uint64_t sixteen = row[static_cast<std::size_t>(y + 16 * z)];
      const int shift = voxel::child_index(0, y % 4, z % 4);
      for (int x = 0; x < 4; ++x)
        words[static_cast<std::size_t>(voxel::child_index(x, y / 4, z / 4))] |= ((sixteen >> (4 * x)) & 15)
                                                                                << shift;
    }
  return voxel::make_leaf_block(0, voxel::all_children, words.data());
}

}  // namespace octotomy::convert
