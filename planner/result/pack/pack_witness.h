// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <map>
#include <string>

#include "planner/operation/table/object.h"
#include "voxel/space/lattice.h"

namespace octotomy::planner {

/// The arrays of an object from which others can recompute its numbers. Names and contents of .npy files:
/// - runs: a row for each run of voxels along x: z, y, x of its first voxel, and x after its last one;
///   ascending;
/// - points, LPS mm, and triangles, three indices of points each, of the surface within the universe, if the
///   object has one;
/// - samples, for a window alone (`window_of` is its scan, else nullptr): rows of 14 numbers, up to
///   `most_samples` of them: a voxel of the universe (x, y, z), the scan's cell that holds its centre (x, y,
///   z), and the cell's eight samples, x fastest. At most half of the voxels are neighbours along x on both
///   sides of the surface; the others are pseudo-random with a fixed seed. Cells with a sample that was not
///   measured are left out.
std::map<std::string, std::string> witness_arrays(const Object& object, const voxel::Universe& universe,
                                                  const voxel::Scene* window_of);

inline constexpr std::size_t most_samples = 4096;

}  // namespace octotomy::planner
