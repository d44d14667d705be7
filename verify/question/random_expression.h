// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <random>
#include <string>

#include "verify/question/expression_tree.h"
#include "voxel/tree/octree.h"

// Random questions for two kernels: Boolean expressions and sets of voxels. The same seed gives the same
// question on any machine: the standard fixes the generator, and the library's distributions are not used.
namespace octotomy::verify {

using Random = std::mt19937_64;

/// A whole number in low..high, both included.
int random_int(Random& random, int low, int high);
/// A number in low..high, of 2^53 equally likely ones.
double random_real(Random& random, double low, double high);

struct RandomTreeOptions {
  int depth = 6;   ///< operators from the root to the deepest leaf, at most
  int leaves = 7;  ///< occurrences, at most
  int names = 7;   ///< a leaf is numbered 0..names-1; a number may occur several times
  int xors = 2;    ///< at most
};
/// Precondition: one leaf and one name at least.
ExpressionTree random_tree(Random& random, const RandomTreeOptions& options = {});

/// A set of voxels and its recipe in words.
struct RandomSet {
  voxel::Octree octree;
  std::string recipe;
};
inline constexpr int largest_random_side = 48;
/// A random set of one kind: white noise, blobs, ellipsoids, boxes, rings, rods or the bone of the head
/// phantom, in voxels of the universe below `side` along each axis. Never empty. Noise is drawn only up to 16
/// voxels a side, because its surface is as large as its volume. Throws std::invalid_argument if the side is
/// larger than the universe's or largest_random_side.
RandomSet random_set(Random& random, const voxel::Universe& universe, int side);

}  // namespace octotomy::verify
