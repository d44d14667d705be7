// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/partial_octree.h"

#include <array>
#include <bit>
#include <cassert>
#include <stdexcept>
#include <string>

#include "voxel/space/error.h"
#include "voxel/tree/level_tally.h"
#include "voxel/tree/octant_order.h"
#include "voxel/tree/octree_node.h"

namespace octotomy::voxel {
namespace {

// Masks of a block's children: those wholly inside the solid, and those that it touches.
struct Masks {
  std::uint64_t full = 0;
  std::uint64_t some = 0;
};

std::uint64_t full_children(BlockRef block) {
  if (const Node* node = block.node()) return node->full;
  return block.is_full() ? all_children : 0;
}

std::uint64_t some_children(BlockRef block) {
  if (const Node* node = block.node()) return node->full | node->partial;
  return block.is_full() ? all_children : 0;
}

class LevelCounter {
 public:
  explicit LevelCounter(int depth) : tally_(depth) {}

  void count_block(BlockRef inside, BlockRef touching, int height, std::uint64_t within) {
    const Masks masks{full_children(inside), some_children(touching)};
    for (int octant = 0; octant < 8; ++octant) {
      const std::uint64_t mask = octant_mask(octant);
      if ((mask & within) == 0) continue;
      // If the universe is only one octant of its root block, this octant is the root, on level 0, and is not
      // counted.
      if (within == all_children && !count(2 * height - 1, masks, mask)) continue;
      for (std::uint64_t rest = mask & within; rest != 0; rest &= rest - 1) {
        const int child = std::countr_zero(rest);
        // If the universe is a single leaf, this leaf is the root and is not counted.
        if (within != 1 && !count(2 * height - 2, masks, rest & (~rest + 1))) continue;
        if (height > 2)
          count_block(inside.child(child), touching.child(child), height - 1, all_children);
        else
          count_leaf({inside.word(child), touching.word(child)});
      }
    }
  }

  std::vector<LevelCount> levels() const { return tally_.levels(); }

 private:
  void count_leaf(const Masks& words) {
    for (int octant = 0; octant < 8; ++octant) {
      const std::uint64_t mask = octant_mask(octant);
      if (count(1, words, mask)) tally_.count_voxels(words.some, mask);
    }
  }
  // Counts the node that consists of the children in `mask`. Returns whether the node is Partial.
  bool count(int side_log2, const Masks& masks, std::uint64_t mask) {
    return tally_.count(side_log2, (masks.full & mask) == mask, (masks.some & mask) == 0);
  }

  LevelTally tally_;
};

// Visits the leaf words of the boundary voxels, touching - inside, in tree order.
template <typename Visit>
void for_each_boundary_leaf(BlockRef inside, BlockRef touching, int height, const glm::ivec3& origin,
                            const Visit& visit) {
  if (touching.is_empty() || inside.is_full() || inside == touching) return;
  const int child_side = 1 << (2 * height - 2);
  for (int child = 0; child < 64; ++child) {
    const glm::ivec3 at = origin + child_side * child_place(child);
    if (height > 2)
      for_each_boundary_leaf(inside.child(child), touching.child(child), height - 1, at, visit);
    else if (const std::uint64_t word = touching.word(child) & ~inside.word(child); word != 0)
      visit(at, word);
  }
}

// The voxels inside, and the boundary voxels that are at least half filled. Reads fractions in tree order,
// beginning at index `next`.
Block half_filled(BlockRef inside, BlockRef touching, int height, const std::uint16_t*& next) {
  assert(height >= 2);
  if (inside == touching) return Block::share(inside);
  std::array<std::uint64_t, 64> words{};
  std::array<BlockRef, 64> children;
  for (std::size_t child = 0; child < 64; ++child) {
    const int number = static_cast<int>(child);
    if (height > 2) {
      children[child] = half_filled(inside.child(number), touching.child(number), height - 1, next).detach();
      continue;
    }
    words[child] = inside.word(number);
    for (std::uint64_t rest = touching.word(number) & ~inside.word(number); rest != 0; rest &= rest - 1)
      if (2 * *next++ >= PartialOctree::whole) words[child] |= rest & (~rest + 1);
  }
  return height > 2 ? make_block(height, 0, all_children, children)
                    : make_leaf_block(0, all_children, words.data());
}

bool is_subset(BlockRef inside, BlockRef touching, int height) {
  if (inside.is_empty() || touching.is_full() || inside == touching) return true;
  if (inside.is_full() || touching.is_empty()) return false;
  for (int child = 0; child < 64; ++child) {
    const bool holds = height > 2 ? is_subset(inside.child(child), touching.child(child), height - 1)
                                  : (inside.word(child) & ~touching.word(child)) == 0;
    if (!holds) return false;
  }
  return true;
}

// A block of 16 x 16 x 16 voxels that the solid touches, and the index of the first fraction of its boundary
// voxels.
struct SharedBlock {
  glm::ivec3 block{0};
  BlockRef inside, touching;
  std::size_t first_fraction = 0;
};

void collect_shares(BlockRef inside, BlockRef touching, int height, const glm::ivec3& at, int limit,
                    std::size_t& fraction_count, std::vector<SharedBlock>& into) {
  if (touching.is_empty() || glm::any(glm::greaterThanEqual(at, glm::ivec3(limit)))) return;
  if (height > 2) {
    const int side = 1 << (2 * (height - 3));  // edge length of a child, in blocks
    for (int child = 0; child < 64; ++child)
      collect_shares(inside.child(child), touching.child(child), height - 1, at + side * child_place(child),
                     limit, fraction_count, into);
    return;
  }
  into.push_back({at, inside, touching, fraction_count});
  for (int leaf = 0; leaf < 64; ++leaf)
    fraction_count += static_cast<std::size_t>(std::popcount(touching.word(leaf) & ~inside.word(leaf)));
}

}  // namespace

void check(const PartialOctree& partial) {
  if (partial.inside.universe() != partial.touching.universe())
    throw InvalidInput("a partial octree's inside and touching voxels have different universes");
  if (!is_subset(partial.inside.root(), partial.touching.root(), partial.inside.root_height()))
    throw InvalidInput("a partial octree has an inside voxel that is not a touching voxel");
  const std::uint64_t boundary = partial.touching.voxel_count() - partial.inside.voxel_count();
  if (partial.fractions.size() != boundary)
    throw InvalidInput("a partial octree of " + std::to_string(boundary) + " boundary voxels has " +
                       std::to_string(partial.fractions.size()) + " fractions");
}

std::vector<LevelCount> level_counts(const PartialOctree& partial) {
  const int depth = partial.touching.universe().depth;
  LevelCounter counter(depth);
  const auto side = static_cast<std::uint64_t>(partial.touching.universe().side());
  if (!partial.touching.is_empty() && partial.inside.voxel_count() != side * side * side)
    counter.count_block(partial.inside.root(), partial.touching.root(), partial.touching.root_height(),
                        universe_children(depth));
  return counter.levels();
}

void for_each_boundary_voxel(
    const PartialOctree& partial,
    const std::function<void(const glm::ivec3& voxel, std::uint16_t fraction)>& visit) {
  std::size_t next = 0;
  for_each_boundary_leaf(partial.inside.root(), partial.touching.root(), partial.touching.root_height(),
                         glm::ivec3(0), [&](const glm::ivec3& origin, std::uint64_t word) {
                           for (; word != 0; word &= word - 1) {
                             const int bit = std::countr_zero(word);
                             visit(origin + glm::ivec3(bit & 3, (bit >> 2) & 3, bit >> 4),
                                   partial.fractions[next++]);
                           }
                         });
}

Octree at_least_half(const PartialOctree& partial) {
  assert(partial.inside.universe() == partial.touching.universe());
  const std::uint16_t* next = partial.fractions.data();
  return {partial.touching.universe(),
          half_filled(partial.inside.root(), partial.touching.root(), partial.touching.root_height(), next)};
}

GreyOctree share_samples(const PartialOctree& partial) {
  constexpr std::int64_t whole_share = 32767;
  const Universe& universe = partial.touching.universe();
  std::vector<SharedBlock> shared;
  std::size_t fraction_count = 0;
  collect_shares(partial.inside.root(), partial.touching.root(), partial.touching.root_height(),
                 glm::ivec3(0), (universe.side() + 15) / 16, fraction_count, shared);
  assert(fraction_count == partial.fractions.size());
  std::vector<glm::ivec3> blocks;
  blocks.reserve(shared.size());
  for (const SharedBlock& block : shared) blocks.push_back(block.block);
  const auto fill = [&](std::size_t number, GreyBrick& brick) {
    const SharedBlock& block = shared[number];
    const std::uint16_t* next = partial.fractions.data() + block.first_fraction;
    for (int leaf = 0; leaf < 64; ++leaf) {
      const std::uint64_t inside = block.inside.word(leaf), touching = block.touching.word(leaf);
      for (int bit = 0; bit < 64; ++bit) {
        std::int64_t share = 0;
        if ((inside >> bit) & 1)
          share = whole_share;
        else if ((touching >> bit) & 1)
          share = (2 * whole_share * *next++ + PartialOctree::whole) / (2 * PartialOctree::whole);
        brick.samples[static_cast<std::size_t>(leaf)][static_cast<std::size_t>(bit)] =
            static_cast<std::int16_t>(share);
      }
    }
  };
  return grey_octree_of_bricks(universe, 0, blocks, fill, Octree::full(universe),
                               1.0 / static_cast<double>(whole_share));
}

double volume_mm3(const PartialOctree& partial) {
  std::uint64_t sum = 0;
  for (const std::uint16_t fraction : partial.fractions) sum += fraction;
  const double voxels = static_cast<double>(partial.inside.voxel_count()) +
                        static_cast<double>(sum) / static_cast<double>(PartialOctree::whole);
  return voxels * partial.inside.universe().lattice().voxel_mm3();
}

std::uint64_t bytes_memory(const PartialOctree& partial) {
  return bytes_memory(partial.inside) + bytes_memory(partial.touching) +
         sizeof(std::uint16_t) * partial.fractions.size();
}

}  // namespace octotomy::voxel
