// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cassert>
#include <cstdint>
#include <glm/glm.hpp>

#include "voxel/tree/grey_octree.h"
#include "voxel/tree/octree.h"
#include "voxel/tree/window_bits.h"

namespace octotomy::voxel {

/// A copy of the leaf words in a small box of an octree: side^3 leaves, x fastest; the lowest has the number
/// `first` along each axis. Leaves outside the universe are empty.
class LeafWords {
 public:
  static constexpr int side = 8;

  /// Reads the leaves of the box first..last, both included; all other leaves of the array become empty.
  /// Precondition: at most `side` leaves along each axis.
  void read(const Octree& octree, const glm::ivec3& first, const glm::ivec3& last);
  /// Reads the leaves of the object whose voxels' samples lie in the window. Samples outside the universe are
  /// the background.
  void read(const GreyOctree& grey, Window16 window, const glm::ivec3& first, const glm::ivec3& last);

  /// Stores in `words` the words of 4 x 4 x 4 leaves, x fastest. The first of these leaves begins `shift`
  /// voxels behind the box's first voxel; `shift` is 0..3 along each axis. Precondition: the box that was
  /// read has 5 leaves along axes with a shift above 0, and 4 along the others.
  void shifted(const glm::ivec3& shift, std::uint64_t* words) const;

  std::uint64_t word(int x, int y, int z) const {
    assert(x >= 0 && y >= 0 && z >= 0 && x < side && y < side && z < side);
    return words_[static_cast<std::size_t>(x + side * (y + side * z))];
  }
  const std::uint64_t* words() const { return words_.data(); }
  /// any() returns the bits that are set in at least one word of the box, every() those that are set in all
  /// words. The box is empty if any() is 0, and full if every() has all bits set.
  std::uint64_t any() const { return any_; }
  std::uint64_t every() const { return every_; }

 private:
  template <typename Words>
  void fill(const glm::ivec3& first, const glm::ivec3& last, const Words& words_of);

  std::array<std::uint64_t, side * side * side> words_;
  std::uint64_t any_ = 0;
  std::uint64_t every_ = 0;
};

}  // namespace octotomy::voxel
