// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/digitise.h"

#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <tbb/parallel_for.h>
#include <utility>

#include "voxel/solid/shape_classifier.h"
#include "voxel/tree/octree_node.h"

// The walk goes down the blocks of the universe. A block that the shape holds, or misses, as a whole is made
// at once; the 64 children of any other are looked at each, in parallel, and their results joined in order.
// Voxels are met only in leaves that the boundary runs through.

namespace octotomy::voxel {
namespace {

// A block by both certain digitisations, and the fractions between them. Of the others only `touching` is
// made.
struct Built {
  Block inside;
  Block touching;
  std::vector<std::uint16_t> fractions;
};

struct Leaf {
  std::uint64_t inside = 0;
  std::uint64_t touching = 0;
};

// Cube of the voxels of a block.
Cube cube_at(const glm::ivec3& origin, int side) {
  return {glm::dvec3(origin) + 0.5 * (side - 1), 0.5 * side};
}

class Walk {
 public:
  /// None: partial.
  Walk(const ShapeClassifier& shape, std::optional<Digitisation> digitisation)
      : shape_(shape), digitisation_(digitisation) {}

  // `within` are the children that lie in the universe.
  Built block(const glm::ivec3& origin, int height, std::uint64_t within) const {
    const int child_side = 1 << (2 * height - 2);
    std::uint64_t full = 0;
    std::uint64_t undecided = 0;
    for (std::uint64_t rest = within; rest != 0; rest &= rest - 1) {
      const int child = std::countr_zero(rest);
      const Meets meets = shape_.meets(cube_at(origin + child_place(child) * child_side, child_side));
      const std::uint64_t bit = rest & (~rest + 1);
      if (!meets.out) full |= bit;
      if (meets.in && meets.out) undecided |= bit;
    }
    return height == 2 ? leaf_block(origin, full, undecided) : node_block(origin, height, full, undecided);
  }

 private:
  Built node_block(const glm::ivec3& origin, int height, std::uint64_t full, std::uint64_t undecided) const {
    const int child_side = 1 << (2 * height - 2);
    const int count = std::popcount(undecided);
    std::array<int, 64> child_numbers;
    int next = 0;
    for (std::uint64_t rest = undecided; rest != 0; rest &= rest - 1)
      child_numbers[static_cast<std::size_t>(next++)] = std::countr_zero(rest);
    std::vector<Built> children(static_cast<std::size_t>(count));
    tbb::parallel_for(0, count, [&](int i) {
      const glm::ivec3 at = origin + child_place(child_numbers[static_cast<std::size_t>(i)]) * child_side;
      children[static_cast<std::size_t>(i)] = block(at, height - 1, all_children);
    });
    Built built;
    std::array<BlockRef, 64> inside;
    std::array<BlockRef, 64> touching;
    for (std::size_t i = 0; i < children.size(); ++i) {
      inside[i] = children[i].inside.detach();
      touching[i] = children[i].touching.detach();
      built.fractions.insert(built.fractions.end(), children[i].fractions.begin(),
                             children[i].fractions.end());
    }
    built.inside = make_block(height, full, undecided, {inside.data(), children.size()});
    built.touching = make_block(height, full, undecided, {touching.data(), children.size()});
    return built;
  }

  Built leaf_block(const glm::ivec3& origin, std::uint64_t full, std::uint64_t undecided) const {
    Built built;
    std::array<std::uint64_t, 64> inside;
    std::array<std::uint64_t, 64> touching;
    std::size_t count = 0;
    for (std::uint64_t rest = undecided; rest != 0; rest &= rest - 1) {
      const Leaf words = leaf(origin + child_place(std::countr_zero(rest)) * 4, built.fractions);
      inside[count] = words.inside;
      touching[count++] = words.touching;
    }
    built.inside = make_leaf_block(full, undecided, inside.data());
    built.touching = make_leaf_block(full, undecided, touching.data());
    return built;
  }

  Leaf leaf(const glm::ivec3& origin, std::vector<std::uint16_t>& fractions) const {
    Leaf leaf;
    for (int octant = 0; octant < 8; ++octant) {
      const glm::ivec3 corner = 2 * glm::ivec3(octant & 1, (octant >> 1) & 1, octant >> 2);
      const std::uint64_t bits = octant_children << child_index(corner.x, corner.y, corner.z);
      const Meets meets = shape_.meets(cube_at(origin + corner, 2));
      if (!meets.out) leaf.inside |= bits;
      if (meets.in && meets.out) mixed_voxels(origin, bits, leaf);
    }
    leaf.touching |= leaf.inside;
    if (!digitisation_)
      for (std::uint64_t rest = leaf.touching & ~leaf.inside; rest != 0; rest &= rest - 1)
        fractions.push_back(fraction(origin + child_place(std::countr_zero(rest))));
    return leaf;
  }

  // The voxels of a leaf's bits, one by one.
  void mixed_voxels(const glm::ivec3& origin, std::uint64_t bits, Leaf& leaf) const {
    for (std::uint64_t rest = bits; rest != 0; rest &= rest - 1) {
      const glm::ivec3 voxel = origin + child_place(std::countr_zero(rest));
      const std::uint64_t bit = rest & (~rest + 1);
      bool in = false;
      bool out = true;
      if (digitisation_ == Digitisation::Centre) {
        in = shape_.contains(glm::dvec3(voxel));
      } else {
        const Meets meets = shape_.resolve(cube_at(voxel, 1));
        in = meets.in;
        out = meets.out;
        if (digitisation_ == Digitisation::Inside) in = !out;
        if (digitisation_ == Digitisation::Half && in && out) in = shape_.fraction(cube_at(voxel, 1)) >= 0.5;
      }
      if (in) leaf.touching |= bit;
      if (!out) leaf.inside |= bit;
    }
  }

  std::uint16_t fraction(const glm::ivec3& voxel) const {
    return static_cast<std::uint16_t>(
        std::lround(shape_.fraction(cube_at(voxel, 1)) * static_cast<double>(PartialOctree::whole)));
  }

  const ShapeClassifier& shape_;
  std::optional<Digitisation> digitisation_;
};

Built walk(const Universe& universe, const Shape& shape, std::optional<Digitisation> digitisation) {
  const ShapeClassifier cut(shape, universe.lps_from_voxel);
  return Walk(cut, digitisation)
      .block(glm::ivec3(0), root_height(universe.depth), universe_children(universe.depth));
}

}  // namespace

Octree digitise(const Universe& universe, const Shape& shape, Digitisation digitisation) {
  return {universe, walk(universe, shape, digitisation).touching};
}

PartialOctree digitise_partial(const Universe& universe, const Shape& shape) {
  Built built = walk(universe, shape, std::nullopt);
  return {Octree(universe, std::move(built.inside)), Octree(universe, std::move(built.touching)),
          std::move(built.fractions)};
}

}  // namespace octotomy::voxel
