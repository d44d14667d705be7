// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "brep/mesh/triangles.h"
#include "voxel/space/lattice.h"
#include "voxel/tree/octree.h"
#include "voxel/tree/octree_node.h"

namespace octotomy::convert {

// Shared by the sources that turn triangles into voxels. They work through a universe in slabs of 16 layers.

inline constexpr int slab_layers = 16;

/// Corners in a universe's index space, where voxel centres are integers.
using Corners = std::array<glm::dvec3, 3>;

/// Throws voxel::Error (Geometry) if a point is not finite or does not exist. Parallel.
std::vector<Corners> triangles_in_index_space(const voxel::Universe& universe,
                                              const brep::Triangles& triangles);

/// The numbers of the triangles that each slab needs, slab after slab and ascending within a slab. Those of
/// slab s are at first[s] .. first[s + 1] - 1.
struct SlabLists {
  std::vector<std::size_t> first;
  std::vector<std::uint32_t> triangles;
};
/// Lists the triangles that each slab needs. `layers_of` returns the layers that a triangle needs, as the
/// first one and the one after the last, within 0..side.
SlabLists sort_into_slabs(const std::vector<Corners>& triangles, int side,
                          const std::function<std::pair<int, int>(const Corners&)>& layers_of);

/// The first integer not below v, within low..high.
int first_not_below(double v, int low, int high);

/// Layers whose plane of centres z cuts a triangle by the half-open rule: at or above its lowest corner,
/// below its highest.
std::pair<int, int> layers_cut(const Corners& corners, int side);

/// The segment in which a layer of centres cuts a triangle, as x and y, the end of lower y first.
struct LayerCut {
  glm::dvec2 from{0.0}, to{0.0};
  /// Whether a ray along +x enters the solid here, in a right-handed index space. Decided by the same rule as
  /// the cut, so the entries and exits of a row cancel on a closed surface.
  bool entering = false;
};
/// The segment in which the plane of centres of layer z cuts a triangle. An edge is cut if one end is at or
/// below z and the other above. Points are interpolated from the lower end, so that both triangles on an edge
/// get the same bits. Precondition: z is within layers_cut().
LayerCut cut_by_layer(const Corners& corners, int z);

/// Blocks of 16^3 voxels of a universe, empty at first.
class BlockGrid {
 public:
  explicit BlockGrid(const voxel::Universe& universe);
  /// Blocks along each axis.
  int side() const { return side_; }
  voxel::Block& at(const glm::ivec3& block);
  /// The octree of the blocks, which are moved out.
  voxel::Octree take_octree();

 private:
  const voxel::Universe& universe_;
  int side_;
  std::vector<voxel::Block> blocks_;
};

/// The block of height 2 whose row (y, z) has the bits row[y + 16 z], x from the lowest bit on.
voxel::Block leaf_block_of_rows(const std::array<std::uint16_t, 256>& row);

}  // namespace octotomy::convert
