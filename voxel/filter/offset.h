// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/solid/expression.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// The points within by_mm of a solid (its sum with a ball) or, for by_mm below 0, the points deeper than
/// -by_mm inside the solid, as a window of samples: each sample is the depth of a voxel's centre below the
/// offset surface, so that the window can be combined, moved and sampled between voxels. `octree` holds the
/// solid's voxels, and `solid` decides where its surface crosses the lines between neighbouring voxels'
/// centres. At the universe's border the solid ends unless `solid` continues beyond the border; the offset
/// solid always ends there.
///
/// Distances are Euclidean, to points of the surface: the crossings, the middles of the chords between two
/// crossings of a lattice square, and the middle of a cell's crossings where they form one ring. On a plane
/// every point of the surface is within D / sqrt(12) of one of these points, where D is a voxel's diagonal. A
/// distance d is therefore overstated by at most D^2 / (24 d), on average by a third of that. At a corner or
/// edge of the solid, which cells cut off, the distance may be overstated by up to 2/3 D. A part of the solid
/// that contains no voxel's centre is missed. Samples are rounded down to steps of a power of two below D /
/// 1024.
///
/// Throws std::invalid_argument if by_mm is 0 or not finite; Stopped. Parallel; same bits on any thread
/// count. Cost: grows with the surfaces of the solid and the offset solid, about log n for each voxel beside
/// the offset surface; memory: 2 bytes for each voxel in the blocks of 16 voxels a side that contain a part
/// of the offset surface.
Window offset(const Octree& octree, const Expression& solid, double by_mm, const Progress& progress = {});

/// The samples of offset() in the blocks of 16 voxels a side that contain a voxel of `region`; other blocks
/// are not computed. Voxels of other blocks are outside the window, even those within the offset solid. Along
/// the border of the computed blocks the window's surface is therefore not that of the offset solid.
Window offset_near(const Octree& octree, const Expression& solid, double by_mm, const Octree& region,
                   const Progress& progress = {});

}  // namespace octotomy::voxel
