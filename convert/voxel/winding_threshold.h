// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "brep/mesh/triangles.h"
#include "convert/voxel/slab_triangles.h"
#include "voxel/space/lattice.h"
#include "voxel/space/progress.h"

namespace octotomy::convert {

/// Share of the sphere about p that a triangle in LPS millimetres covers, positive seen from behind. Source:
/// Van Oosterom, Strackee, "The solid angle of a plane triangle", IEEE TBME 30(2), 1983.
double covered_share(const std::array<glm::dvec3, 3>& triangle_mm, const glm::dvec3& p_mm);

/// The triangles that close a surface: a cone over each part of its rim. In LPS millimetres.
struct Cap {
  std::vector<std::array<glm::dvec3, 3>> triangles;
  std::vector<std::array<glm::dvec3, 2>> edges;  ///< of the rim
};
Cap cap_of(const voxel::Universe& universe, const brep::Triangles& surface);

/// Voxels whose centres are origin .. origin + side - 1 along each axis.
struct Cube {
  glm::ivec3 origin{0};
  int side = slab_layers;
};

/// A voxel is inside if the surface's own winding number about the voxel's centre is more than 1/2. The
/// surface together with its cap has a whole winding number there. The threshold is the least such number
/// with which the voxel is inside: 1 away from holes. Cost of a cube: the cap's triangles.
class WindingThreshold {
 public:
  WindingThreshold(const voxel::Universe& universe, const Cap& cap);

  /// The threshold of all voxels of a cube; none unless it is proven to be the same for all.
  std::optional<int> in_cube(const Cube& cube) const;

  /// Calls `decided(cube, number)` for cubes that together fill the given one, whose side is a power of 4.
  template <typename Decided>
  void divide(const Cube& cube, const Decided& decided) const {
    if (const std::optional<int> number = in_cube(cube)) return decided(cube, *number);
    const int side = cube.side / 4;
    for (int child = 0; child < 64; ++child)
      divide({cube.origin + side * voxel::child_place(child), side}, decided);
  }

 private:
  bool meets_cap(const Cube& cube) const;
  bool may_change(const Cube& cube, const glm::dvec3& middle_mm, double share) const;

  voxel::Lattice lattice_;
  const Cap& cap_;
  std::vector<Corners> in_voxels_;                         ///< the cap's triangles, voxel numbers
  std::vector<std::pair<glm::dvec3, glm::dvec3>> bounds_;  ///< lower and upper corners of their boxes
};

/// A universe's thresholds in cubes of 4^h voxels a side. A cube with different thresholds is divided, down
/// to a side of 16.
struct ThresholdNode {
  std::optional<int> number;                                ///< threshold of all voxels; none: they differ,
                                                            ///< see the children
  std::unique_ptr<std::array<ThresholdNode, 64>> children;  ///< none: one number, or a cube of 16 voxels a
                                                            ///< side
};
/// The node of the octree's root block. Parallel; throws voxel::Stopped.
ThresholdNode threshold_tree(const voxel::Universe& universe, const WindingThreshold& threshold,
                             const std::stop_token& stop);

}  // namespace octotomy::convert
