// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <chrono>
#include <functional>
#include <stop_token>
#include <vector>

#include "convert/finer.h"
#include "convert/tetrahedra.h"
#include "voxel/octree.h"

namespace octotomy::convert {

struct RegionMeshOptions {
  double size_mm = 2.0;                          ///< of elements, about; two voxels at least show no steps
  std::vector<Finer> finer{};                    ///< where elements are smaller
  double min_dihedral_deg = 8.0;                 ///< what is aimed at, 0..30
  std::chrono::milliseconds time_limit{300000};  ///< by the clock on the wall
  std::uint64_t memory_limit_bytes = 4ull << 30;
  std::stop_token stop;  ///< ends the run; then std::runtime_error says so
  /// Called now and then while a mesher runs, with the share of its time limit that is gone.
  std::function<void(double)> report{};
};

/// Quality tetrahedra of several regions of one universe with smooth surfaces, which share the nodes of their
/// interfaces; in LPS millimetres. By CGAL's Mesh_3, run in a process of its own, over the image of the
/// regions' labels: where two regions meet is where their trilinear shares are equal, half-way between voxels
/// and smooth across their steps. A voxel in several regions belongs to the first; `region_of_tet` numbers
/// them in the order given; boundary nodes are those of the outside alone. Flat elements are mended by moving
/// nodes, those of surfaces by no more than a tenth of the size. Guaranteed: all volumes positive, and
/// each region's that of its voxels within what its surface may be off, a quarter of a voxel; `findings` has
/// both. Throws std::invalid_argument where there is no region or there are over 255, one is empty, universes
/// differ or an option is out of range; std::runtime_error where the mesher fails, with how and what to try,
/// and where a region is lost or far from its voxels: parts thinner than the size may be; tetrahedra_of()
/// (octree_tetrahedra.h) always has them.
/// Deterministic. Memory: a byte a voxel of the regions' box, besides the mesher's.
Tetrahedra smooth_tetrahedra_of(const std::vector<voxel::Octree>& regions,
                                const RegionMeshOptions& options = {});

}  // namespace octotomy::convert
