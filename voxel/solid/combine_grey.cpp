// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/combine_grey.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <vector>

#include "voxel/solid/combine.h"
#include "voxel/solid/grey_owner.h"
#include "voxel/space/error.h"
#include "voxel/tree/octree_node.h"

// Passes: 1 compute the expression's voxels as an octree; 2 collect the octree's leaves by brick; 3 fill the
// bricks with the samples of the voxels' owners.

namespace octotomy::voxel {
namespace {

std::int16_t rounded(double value) {
  constexpr double low = std::numeric_limits<std::int16_t>::min();
  constexpr double high = std::numeric_limits<std::int16_t>::max();
  return static_cast<std::int16_t>(std::clamp(std::floor(value + 0.5), low, high));
}

// Leaf words of one block of height 2.
struct BlockWords {
  glm::ivec3 block{0};
  BlockRef words;
};

void collect(BlockRef block, int height, const glm::ivec3& at, int limit, std::vector<BlockWords>& into) {
  if (block.is_empty() || glm::any(glm::greaterThanEqual(at, glm::ivec3(limit)))) return;
  if (height == 2) {
    into.push_back({at, block});
    return;
  }
  const int side = 1 << (2 * (height - 3));  // edge length of a child, in blocks
  for (int child = 0; child < 64; ++child)
    collect(block.child(child), height - 1, at + side * child_place(child), limit, into);
}

}  // namespace

GreyOctree combine_grey(const Universe& universe, const Expression& expression, const GreyResult& options) {
  const Octree voxels = combine(universe, expression, options.resampling);
  std::vector<BlockWords> held;
  collect(voxels.root(), voxels.root_height(), glm::ivec3(0), (universe.side() + 15) / 16, held);
  std::vector<glm::ivec3> blocks;
  blocks.reserve(held.size());
  for (const BlockWords& block : held) blocks.push_back(block.block);

  const GreyOwners owners(universe, {SampleSource{expression}}, options.resampling);
  const std::vector<Window> windows = owners.windows();
  const double step = windows.empty() ? 1.0 : windows.front().grey.step();
  for (const Window& window : windows)
    if (window.grey.step() != step)
      throw InvalidInput("grey octrees whose samples have steps of " + std::to_string(step) + " and " +
                         std::to_string(window.grey.step()) +
                         " cannot be combined: make both octrees of integer samples");
  const std::int16_t background = rounded(options.background / step);
  const std::int16_t filled = rounded(options.filled / step);
  const auto sample = [&](const glm::ivec3& voxel) {
    const std::optional<OwnedSample> owned = owners.at(voxel, glm::dvec3(voxel));
    return owned ? rounded(owned->in_steps) : filled;
  };
  const auto fill = [&](std::size_t i, GreyBrick& brick) {
    for (int leaf = 0; leaf < 64; ++leaf) {
      const glm::ivec3 origin = 16 * held[i].block + 4 * child_place(leaf);
      const std::uint64_t word = held[i].words.word(leaf);
      for (int bit = 0; bit < 64; ++bit)
        brick.samples[static_cast<std::size_t>(leaf)][static_cast<std::size_t>(bit)] =
            (word >> bit) & 1 ? sample(origin + child_place(bit)) : background;
    }
  };
  return grey_octree_of_bricks(universe, background, blocks, fill, voxels, step);
}

}  // namespace octotomy::voxel
