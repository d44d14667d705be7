// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/question/random_expression.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <stdexcept>

#include "verify/phantom/head_phantom.h"
#include "verify/phantom/implicit_solid.h"
#include "voxel/solid/combine.h"
#include "voxel/space/error.h"
#include "voxel/tree/build.h"

namespace octotomy::verify {
namespace {

/// Largest side of random noise, in voxels. The surface of noise grows as its volume does.
constexpr int largest_noise_side = 16;

/// Returns a tree of exactly `leaves` leaves, at most `depth` deep. Precondition: leaves <= 2^depth.
ExpressionTree tree_of(Random& random, int leaves, int depth, int names, int& xors) {
  assert(leaves >= 1 && names >= 1 && (depth > 20 || leaves <= 1 << depth));
  ExpressionTree tree;
  if (leaves == 1) {
    tree.leaf = random_int(random, 0, names - 1);
    if (depth > 0 && random_int(random, 0, 7) == 0) return {'~', 0, {tree}};
    return tree;
  }
  const int most = depth > 20 ? leaves - 1 : std::min(leaves - 1, 1 << (depth - 1));
  const int left = random_int(random, std::max(1, leaves - most), most);
  const int kind = random_int(random, 0, xors > 0 ? 6 : 5);
  tree.symbol = "&&||--^"[kind];
  if (tree.symbol == '^') --xors;
  tree.parts.push_back(tree_of(random, left, depth - 1, names, xors));
  tree.parts.push_back(tree_of(random, leaves - left, depth - 1, names, xors));
  return tree;
}

/// Returns the voxels below `side` along each axis for whose index `wanted` returns true.
template <typename Wanted>
voxel::Octree where(const voxel::Universe& universe, int side, const Wanted& wanted) {
  return voxel::octree_of_blocks(universe, [&](const glm::ivec3& block) {
    std::array<std::uint64_t, 64> words{};
    for (int i = 0; i < 4096; ++i) {
      const glm::ivec3 in_block(i & 15, (i >> 4) & 15, i >> 8);
      const glm::ivec3 v = 16 * block + in_block;
      if (glm::any(glm::greaterThanEqual(v, glm::ivec3(side))) || !wanted(v)) continue;
      const glm::ivec3 leaf = in_block / 4, bit = in_block % 4;
      words[static_cast<std::size_t>(voxel::child_index(leaf.x, leaf.y, leaf.z))] |=
          std::uint64_t{1} << voxel::child_index(bit.x, bit.y, bit.z);
    }
    return voxel::make_leaf_block(0, voxel::all_children, words.data());
  });
}

std::size_t index_in(const glm::ivec3& v, int side) {
  return static_cast<std::size_t>(v.x + side * (v.y + side * v.z));
}

voxel::Octree noise(Random& random, const voxel::Universe& universe, int side, int per_cent) {
  std::vector<bool> inside(static_cast<std::size_t>(side * side * side));
  for (std::size_t i = 0; i < inside.size(); ++i) inside[i] = random_int(random, 0, 99) < per_cent;
  return where(universe, side, [&](const glm::ivec3& v) { return inside[index_in(v, side)]; });
}

/// The places at which random values on a coarse lattice, interpolated linearly, exceed a level: smooth sets
/// of any topology.
voxel::Octree blobs(Random& random, const voxel::Universe& universe, int side, double above) {
  constexpr int knots = 6;
  std::array<double, knots * knots * knots> values;
  for (double& value : values) value = random_real(random, 0.0, 1.0);
  return where(universe, side, [&](const glm::ivec3& v) {
    const glm::dvec3 p = glm::dvec3(v) * ((knots - 1.001) / std::max(side - 1, 1));
    const glm::ivec3 low(p);
    const glm::dvec3 part = p - glm::dvec3(low);
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 step(corner & 1, (corner >> 1) & 1, corner >> 2);
      double weight = 1.0;
      for (int axis = 0; axis < 3; ++axis) weight *= step[axis] ? part[axis] : 1.0 - part[axis];
      sum += weight * values[index_in(low + step, knots)];
    }
    return sum > above;
  });
}

voxel::Octree solid(Random& random, const voxel::Universe& universe, int side, int kind) {
  const voxel::Lattice lattice = universe.lattice();
  const double edge_mm = lattice.spacing_mm().x;
  const auto place = [&] {
    return lattice.lps_mm({random_real(random, 0.2, 0.8) * side, random_real(random, 0.2, 0.8) * side,
                           random_real(random, 0.2, 0.8) * side});
  };
  const auto length = [&] { return random_real(random, 0.1, 0.45) * side * edge_mm; };
  const glm::dvec3 turn{random_real(random, 0, 90), random_real(random, 0, 90), random_real(random, 0, 90)};
  const glm::dmat3 axes = random_int(random, 0, 1) == 0 ? glm::dmat3(1.0) : turned(turn);
  const glm::dvec3 centre = place(), size{length(), length(), length()};
  switch (kind) {
    case 0:
      return voxel::combine(universe, voxel::Ellipsoid{centre, size, axes});
    case 1:
      return voxel::combine(universe, voxel::OrientedBox{centre, size, axes});
    case 2:
      return voxel::combine(universe, voxel::Torus{centre, axes[2], size.x, 0.4 * size.x});
    default:
      return voxel::combine(universe, voxel::Cylinder{centre, centre + axes * size, 0.5 * size.y});
  }
}

/// The bone of the head phantom in voxels of six millimetres; if `side` is smaller than the head, a random
/// part of it.
voxel::Octree head(Random& random, const voxel::Universe& universe, int side) {
  constexpr int head_side = largest_random_side;
  static const std::vector<bool> bone = [] {
    std::vector<bool> inside(head_side * head_side * head_side);
    const voxel::Box box = head_bounds();
    const glm::dvec3 middle = 0.5 * (box.low_mm + box.high_mm);
    for (int z = 0; z < head_side; ++z)
      for (int y = 0; y < head_side; ++y)
        for (int x = 0; x < head_side; ++x)
          inside[index_in({x, y, z}, head_side)] =
              head_contains(HeadPart::Bone, middle + (glm::dvec3(x, y, z) - 0.5 * (head_side - 1)) * 6.0);
    return inside;
  }();
  const int room = head_side - side;
  // Braces fix the order in which the random numbers are drawn.
  const glm::ivec3 from{random_int(random, 0, room), random_int(random, 0, room),
                        random_int(random, 0, room)};
  return where(universe, side, [&](const glm::ivec3& v) { return bone[index_in(v + from, head_side)]; });
}

}  // namespace

int random_int(Random& random, int low, int high) {
  assert(low <= high);
  return low + static_cast<int>(random() % static_cast<std::uint64_t>(high - low + 1));
}

double random_real(Random& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

ExpressionTree random_tree(Random& random, const RandomTreeOptions& options) {
  assert(options.leaves >= 1 && options.names >= 1);
  int xors = options.xors;
  const int most = std::min(options.leaves, 1 << std::min(options.depth, 20));
  return tree_of(random, random_int(random, std::min(2, most), most), options.depth, options.names, xors);
}

RandomSet random_set(Random& random, const voxel::Universe& universe, int side) {
  if (side < 1 || side > std::min(universe.side(), largest_random_side))
    throw voxel::InvalidInput("random set: a side of " + std::to_string(side) + " voxels is not within 1.." +
                              std::to_string(std::min(universe.side(), largest_random_side)));
  static constexpr std::array<const char*, 4> solids{"ellipsoid", "box", "ring", "rod"};
  while (true) {
    const int kind = random_int(random, 0, 9);
    RandomSet set{voxel::Octree::empty(universe), ""};
    if (kind < 4) {
      set = {solid(random, universe, side, kind), solids[static_cast<std::size_t>(kind)]};
      set.octree =
          voxel::combine(universe, voxel::Expression(set.octree) &
                                       where(universe, side, [](const glm::ivec3&) { return true; }));
    } else if (kind < 6 && side <= largest_noise_side) {
      const int per_cent = random_int(random, 2, 80);
      set = {noise(random, universe, side, per_cent), "noise of " + std::to_string(per_cent) + " %"};
    } else if (kind < 8) {
      const double above = random_real(random, 0.4, 0.65);
      set = {blobs(random, universe, side, above), "blobs"};
    } else {
      set = {head(random, universe, side), "head phantom"};
    }
    if (!set.octree.is_empty()) return set;
  }
}

}  // namespace octotomy::verify
