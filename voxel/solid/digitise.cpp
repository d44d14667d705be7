// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/digitise.h"

#include <bit>
#include <cassert>
#include <cmath>
#include <stdexcept>
#include <tbb/concurrent_unordered_map.h>
#include <tbb/parallel_for.h>

#include "voxel/solid/combine.h"
#include "voxel/solid/target_expression.h"
#include "voxel/space/error.h"

// The walk of combine() decides blocks by cubes that contain the whole voxels. Leaves that remain undecided
// are decided here:
//   1 eight cubes of 2 x 2 x 2 voxels are tested, and the voxels of undecided cubes are resolved;
//   2 fractions are computed for voxels that are neither wholly inside nor outside.
// A partial octree takes two walks over the same leaves; the second reads the words that the first computed.

namespace octotomy::voxel {
namespace {

struct Leaf {
  std::uint64_t inside = 0;
  std::uint64_t touching = 0;
};

// The cube of side^3 voxels whose lowest voxel is `first`.
Cube cube_at(const glm::ivec3& first, int side) {
  return {glm::dvec3(first) + 0.5 * (side - 1), 0.5 * side};
}

Leaf leaf_at(const TargetExpression& solid, const glm::ivec3& origin) {
  assert(glm::all(glm::equal(origin & 3, glm::ivec3(0))));
  Leaf leaf;
  for (int octant = 0; octant < 8; ++octant) {
    const glm::ivec3 corner = 2 * glm::ivec3(octant & 1, (octant >> 1) & 1, octant >> 2);
    const std::uint64_t bits = octant_children << child_index(corner.x, corner.y, corner.z);
    const Meets all = solid.meets(cube_at(origin + corner, 2));
    if (!all.out) leaf.inside |= bits;
    if (!all.in || !all.out) continue;
    for (std::uint64_t rest = bits; rest != 0; rest &= rest - 1) {
      const Meets own = solid.resolve(cube_at(origin + child_place(std::countr_zero(rest)), 1));
      const std::uint64_t bit = rest & (~rest + 1);
      if (own.in) leaf.touching |= bit;
      if (!own.out) leaf.inside |= bit;
    }
  }
  leaf.touching |= leaf.inside;
  return leaf;
}

std::uint64_t half_at(const TargetExpression& solid, const glm::ivec3& origin) {
  const Leaf leaf = leaf_at(solid, origin);
  std::uint64_t word = leaf.inside;
  for (std::uint64_t rest = leaf.touching & ~leaf.inside; rest != 0; rest &= rest - 1)
    if (solid.fraction(cube_at(origin + child_place(std::countr_zero(rest)), 1)) >= 0.5)
      word |= rest & (~rest + 1);
  return word;
}

TargetExpression target_of(const Universe& universe, const Expression& solid) {
  TargetExpression target(postfix_of(solid, universe), universe);
  for (const PostfixExpression::Operand& operand : target.postfix().operands)
    if (std::holds_alternative<Window>(*operand.leaf))
      throw InvalidInput(
          "a window of samples has no shape within a voxel: apply combine() to it, then digitise the result");
  return target;
}

}  // namespace

Octree digitise(const Universe& universe, const Expression& solid, Digitisation digitisation) {
  if (digitisation == Digitisation::Centre) return combine(universe, solid);
  const TargetExpression target = target_of(universe, solid);
  LeafRule rule;
  rule.word = [&](const glm::ivec3& origin) {
    if (digitisation == Digitisation::Half) return half_at(target, origin);
    const Leaf leaf = leaf_at(target, origin);
    return digitisation == Digitisation::Inside ? leaf.inside : leaf.touching;
  };
  return walk(universe, target, &rule);
}

PartialOctree digitise_partial(const Universe& universe, const Expression& solid) {
  const TargetExpression target = target_of(universe, solid);
  const auto key = [](const glm::ivec3& origin) {
    return (std::uint64_t(origin.z) << 40) | (std::uint64_t(origin.y) << 20) | std::uint64_t(origin.x);
  };
  tbb::concurrent_unordered_map<std::uint64_t, std::uint64_t> inside_words;
  LeafRule rule;
  rule.word = [&](const glm::ivec3& origin) {
    const Leaf leaf = leaf_at(target, origin);
    inside_words.emplace(key(origin), leaf.inside);
    return leaf.touching;
  };
  const Octree touching = walk(universe, target, &rule);
  rule.word = [&](const glm::ivec3& origin) { return inside_words.at(key(origin)); };
  const Octree inside = walk(universe, target, &rule);

  PartialOctree partial{inside, touching, {}};
  partial.fractions.resize(touching.voxel_count() - inside.voxel_count());
  std::vector<glm::ivec3> boundary;
  boundary.reserve(partial.fractions.size());
  for_each_boundary_voxel(partial,
                          [&](const glm::ivec3& voxel, std::uint16_t) { boundary.push_back(voxel); });
  tbb::parallel_for(std::size_t{0}, boundary.size(), [&](std::size_t i) {
    const double share = target.fraction(cube_at(boundary[i], 1));
    partial.fractions[i] = static_cast<std::uint16_t>(std::lround(share * PartialOctree::whole));
  });
  return partial;
}

}  // namespace octotomy::voxel
