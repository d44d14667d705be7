// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "brep/mesh/triangle_cluster.h"
#include "convert/voxel/slab_triangles.h"
#include "voxel/space/lattice.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::convert {

/// Share of the sphere about p that a triangle in LPS millimetres covers, positive seen from behind. Source:
/// Van Oosterom, Strackee, "The solid angle of a plane triangle", IEEE TBME 30(2), 1983.
double covered_share(const std::array<glm::dvec3, 3>& triangle_mm, const glm::dvec3& p_mm);

/// Voxels whose centres are origin .. origin + side - 1 along each axis.
struct Cube {
  glm::ivec3 origin{0};
  int side = slab_layers;
};

/// A voxel is inside if the surface's own winding number about the voxel's centre is more than 1/2. The surface
/// together with its cap has a whole winding number there. The threshold is the least such number with which
/// the voxel is inside: 1 away from holes. Cost of a cube: about log n for n triangles of the cap; n for a
/// voxel about which the winding number is 1/2.
class WindingThreshold {
 public:
  /// The cap is in LPS millimetres.
  WindingThreshold(const voxel::Universe& universe, std::vector<std::array<glm::dvec3, 3>> cap);

  /// The threshold of all voxels of a cube; none unless it is proven to be the same for all.
  std::optional<int> in_cube(const Cube& cube) const;

  /// Calls `decided(cube, number)` for cubes that together fill the given one, whose side is a power of 2.
  template <typename Decided>
  void divide(const Cube& cube, const Decided& decided) const {
    if (const std::optional<int> number = in_cube(cube)) return decided(cube, *number);
    const int side = cube.side / 2;
    for (int child = 0; child < 8; ++child)
      divide({cube.origin + side * glm::ivec3(child & 1, child >> 1 & 1, child >> 2), side}, decided);
  }

 private:
  /// A leaf holds `count` triangles from `first`; an inner node's children are the next node and node `first`.
  struct Cluster : brep::TriangleCluster {
    std::uint32_t first = 0, count = 0;
  };
  /// The cap's winding number about the points of a ball: `middle` + `slope` (p - centre), within `error`.
  struct Estimate {
    double middle = 0.0, error = 0.0;
    glm::dvec3 slope{0.0};  ///< per mm
  };

  Estimate estimate(const glm::dvec3& centre_mm, double reach_mm, double tolerance) const;
  void add(const Cluster& cluster, const glm::dvec3& centre_mm, Estimate& sum) const;

  voxel::Lattice lattice_;
  std::vector<std::array<glm::dvec3, 3>> cap_;  ///< in the order of the leaves
  std::vector<Cluster> clusters_;
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
