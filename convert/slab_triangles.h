// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "brep/triangles.h"
#include "voxel/lattice.h"
#include "voxel/octree_node.h"

namespace octotomy::convert {

// What the sources that turn triangles into voxels share: a universe is worked through in slabs of 16 layers.

inline constexpr int slab_layers = 16;

/// Corners in a universe's index space, where voxel centres are integers.
using Corners = std::array<glm::dvec3, 3>;

/// Faces marked as deleted become triangles without extent. Throws std::invalid_argument where a point is not
/// finite. Parallel.
std::vector<Corners> triangles_in_index_space(const voxel::Universe& universe, const brep::Mesh& mesh);
std::vector<Corners> triangles_in_index_space(const voxel::Universe& universe,
                                              const brep::Triangles& triangles);

/// The numbers of the triangles that each slab needs, slab after slab, ascending within one: those of slab s
/// stand at first[s] .. first[s + 1].
struct SlabLists {
  std::vector<std::size_t> first;
  std::vector<std::uint32_t> triangles;
};
/// `layers_of` gives the layers that a triangle needs, first and end, within 0..side.
SlabLists sort_into_slabs(const std::vector<Corners>& triangles, int side,
                          const std::function<std::pair<int, int>(const Corners&)>& layers_of);

/// The first integer not below v, within low..high.
int first_not_below(double v, int low, int high);

/// Layers whose plane of centres z cuts a triangle by the half-open rule: above its lowest corner or through
/// it, below its highest.
std::pair<int, int> layers_cut(const Corners& corners, int side);

/// Where a layer of centres cuts a triangle, as x and y, the end of lower y first.
struct LayerCut {
  glm::dvec2 from{0.0}, to{0.0};
  /// Whether a way along x enters what the triangle bounds, in a right-handed index space. By the same rule
  /// as the cut, so that along a closed surface entries and exits of a row cancel.
  bool entering = false;
};
/// An edge is cut where one end is at or below z and the other above, and from its lower end, so that the two
/// triangles on it get the same bits. Precondition: z is within layers_cut().
LayerCut cut_by_layer(const Corners& corners, int z);

/// The block of height 2 whose row (y, z) has the bits row[y + 16 z], x from the lowest bit on.
voxel::Block leaf_block_of_rows(const std::array<std::uint16_t, 256>& row);

}  // namespace octotomy::convert
