// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <random>
#include <string>

#include "verify/question/expression_tree.h"
#include "voxel/tree/octree.h"

// Random questions for two kernels: Boolean expressions and sets of voxels. The same seed yields the same
// question on any machine: the C++ standard fixes the generator, and the library's distributions are not
// used.
namespace octotomy::verify {

using Random = std::mt19937_64;

/// A random integer in low..high, both included.
int random_int(Random& random, int low, int high);
/// A random number in low..high, one of 2^53 equally likely ones.
double random_real(Random& random, double low, double high);

struct RandomTreeOptions {
  int depth = 6;   ///< largest number of operators from the root to a leaf
  int leaves = 7;  ///< largest number of leaves in the tree
  int names = 7;   ///< a leaf is numbered 0..names-1; a number may occur several times
  int xors = 2;    ///< at most
};
/// Returns a random tree. Precondition: `leaves` and `names` are at least one.
ExpressionTree random_tree(Random& random, const RandomTreeOptions& options = {});

/// A set of voxels, and its kind and parameters in words.
struct RandomSet {
  voxel::Octree octree;
  std::string recipe;
};
inline constexpr int largest_random_side = 48;
/// Returns a random set of one kind: white noise, blobs, ellipsoids, boxes, rings, rods or the bone of the
/// head phantom. It lies in the voxels of the universe below `side` along each axis, and is never empty.
/// Noise is drawn only up to 16 voxels a side, because its surface grows as its volume does. Throws
/// std::invalid_argument if the side is larger than the universe's or than largest_random_side.
RandomSet random_set(Random& random, const voxel::Universe& universe, int side);

}  // namespace octotomy::verify
