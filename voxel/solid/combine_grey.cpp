// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/combine_grey.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "voxel/solid/combine.h"
#include "voxel/solid/operand_frame.h"
#include "voxel/solid/term_walk.h"
#include "voxel/tree/octree_node.h"

// Passes: 1 compute the expression's voxels as an octree; 2 collect its leaves by brick; 3 fill the bricks'
// samples, testing the windows in their order for each voxel.

namespace octotomy::voxel {
namespace {

// A window as a source of samples.
struct Source {
  const Window* window = nullptr;
  glm::dmat4 source_from_target{1.0};
  std::optional<glm::ivec3> offset;  ///< if source_from_target is a translation by whole voxels
  bool positive = true;              ///< under an even number of complements
};

// The windows of an expression in reading order, each with its position in the target and its sign.
std::vector<Source> sources_of(const Universe& target, const Expression& expression) {
  std::vector<Source> found;
  std::vector<glm::dmat4> motions{glm::dmat4(1.0)};
  bool positive = true;
  for_each_term(expression, [&](const MetTerm& met) {
    using Kind = Expression::Kind;
    const Expression::Term& term = met.term;
    const bool turns = met.subtracted != (term.kind == Kind::Not);
    if (met.before) {
      if (turns) positive = !positive;
      if (term.kind == Kind::Moved) motions.push_back(motions.back() * term.moved_from_still);
      if (const auto* window = term.leaf ? std::get_if<Window>(&*term.leaf) : nullptr) {
        const glm::dmat4 source_from_target = glm::inverse(window->grey.universe().lps_from_voxel) *
                                              glm::inverse(motions.back()) * target.lps_from_voxel;
        found.push_back({window, source_from_target, whole_voxel_offset(source_from_target), positive});
      }
    } else if (term.kind == Kind::Moved) {
      motions.pop_back();
    }
    // A leaf is visited once, the other terms before and after their operands.
    if (turns && (!met.before || term.kind == Kind::Leaf)) positive = !positive;
  });
  return found;
}

std::int16_t rounded(double value) {
  constexpr double low = std::numeric_limits<std::int16_t>::min();
  constexpr double high = std::numeric_limits<std::int16_t>::max();
  return static_cast<std::int16_t>(std::clamp(std::floor(value + 0.5), low, high));
}

class Sampler {
 public:
  // `filled`: sample of the voxels that no source fills, in steps.
  Sampler(std::vector<Source> sources, const GreyResult& options, std::int16_t filled)
      : sources_(std::move(sources)), options_(options), filled_(filled) {}

  // Returns the sample of a voxel that the expression contains.
  std::int16_t operator()(const glm::ivec3& voxel) const {
    const double nothing = std::numeric_limits<double>::quiet_NaN();
    double complement = nothing;
    for (const Source& source : sources_) {
      const auto [value, scanned] = value_at(source, voxel);
      const bool holds = scanned && value >= source.window->low && value <= source.window->high;
      if (source.positive && holds) return rounded(value);
      if (!source.positive && !holds && std::isnan(complement)) complement = value;
    }
    return std::isnan(complement) ? filled_ : rounded(complement);
  }

 private:
  struct Value {
    double value = 0.0;
    bool scanned = false;  ///< the nearest sample belongs to the scan
  };
  Value value_at(const Source& source, const glm::ivec3& voxel) const {
    const GreyOctree& grey = source.window->grey;
    if (source.offset) {
      const glm::ivec3 at = voxel + *source.offset;
      return {static_cast<double>(grey.sample(at)), grey.scan().contains(at)};
    }
    const glm::dvec3 p(source.source_from_target * glm::dvec4(glm::dvec3(voxel), 1.0));
    const Interpolation how = options_.resampling.samples;
    return {how == Interpolation::Linear ? interpolate_scan(grey, p) : interpolate(grey, p, how),
            grey.scan().contains(glm::ivec3(glm::floor(p + 0.5)))};
  }

  std::vector<Source> sources_;
  const GreyResult& options_;
  std::int16_t filled_;
};

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
  const int side = 1 << (2 * (height - 3));  // of a child, in blocks
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

  std::vector<Source> sources = sources_of(universe, expression);
  const double step = sources.empty() ? 1.0 : sources.front().window->grey.step();
  for (const Source& source : sources)
    if (source.window->grey.step() != step)
      throw std::invalid_argument("grey octrees whose samples count in steps of " + std::to_string(step) +
                                  " and " + std::to_string(source.window->grey.step()) +
                                  " cannot be one: make both of whole numbers");
  const std::int16_t background = rounded(options.background / step);
  const Sampler sample(std::move(sources), options, rounded(options.filled / step));
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
