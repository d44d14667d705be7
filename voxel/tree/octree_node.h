// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <atomic>
#include <bit>
#include <cassert>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <utility>

// The physical octree, for the kernel's own sources: two logical levels to a node.
//
// A block of height h is a cube of 4^h voxels a side. A block of height 1 is a leaf: 4 x 4 x 4 voxels as one
// 64-bit word. A block of height h > 1 is Empty, Full, or a Node whose 64 children are blocks of height h
// - 1. Bit and child number x + 4y + 16z is the voxel or child at (x, y, z) of its block.
//
// Nodes never change after they were made, and trees share them by counted references. They are canonical: no
// child is a node whose voxels are all Full or all Empty, so that equal sets of voxels have equal structures.

namespace octotomy::voxel {

/// Whether none, all or some of the voxels of a node, a block or a box are in the object.
enum class Status : std::uint8_t { Empty, Full, Partial };

/// The common status of the children or voxels in `mask`. Those in `full` are Full, those outside `some` are
/// Empty.
constexpr Status status_of(std::uint64_t mask, std::uint64_t full, std::uint64_t some) {
  if ((full & mask) == mask) return Status::Full;
  return (some & mask) == 0 ? Status::Empty : Status::Partial;
}

constexpr int child_index(int x, int y, int z) {
  return x + 4 * y + 16 * z;
}

/// The position (x, y, z), 0..3 along each axis, of the child with the given number.
inline glm::ivec3 child_place(int child) {
  return {child & 3, (child >> 2) & 3, child >> 4};
}

/// The height of the root block of a universe of 2^depth voxels a side: the least height, from 2 on, at which
/// a block covers the universe.
constexpr int root_height(int depth) {
  return depth <= 4 ? 2 : (depth + 1) / 2;
}

inline constexpr std::uint64_t all_children = ~std::uint64_t{0};
/// A mask of the 2 x 2 x 2 children of the logical octant (0, 0, 0). Shifted left by child_index(2x, 2y, 2z),
/// the mask of octant (x, y, z).
inline constexpr std::uint64_t octant_children = 0x0000000000330033ULL;

/// A mask of the children of a root block that lie inside a universe of 2^depth voxels a side; other children
/// are always Empty.
std::uint64_t universe_children(int depth);

struct Node {
  mutable std::atomic<std::uint32_t> references{1};
  std::int32_t height = 2;
  std::uint64_t voxel_count = 0;  ///< number of voxels of the object in this block
  std::uint64_t full = 0;         ///< children that are Full
  /// Children that are Partial; their payloads are stored in ascending child number.
  std::uint64_t partial = 0;

  /// The index of a child in the payload. Precondition: the child's bit of `partial` is set.
  int rank(int child) const {
    assert((partial >> child) & 1);
    return std::popcount(partial & ((std::uint64_t{1} << child) - 1));
  }
  int payload_count() const { return std::popcount(partial); }

  /// The payload of a node of height 2: the words of its leaves that are neither Full nor Empty.
  const std::uint64_t* words() const { return reinterpret_cast<const std::uint64_t*>(this + 1); }
  std::uint64_t* words() { return reinterpret_cast<std::uint64_t*>(this + 1); }
  /// The payload of a node of height 3 or more: its Partial children.
  const Node* const* nodes() const { return reinterpret_cast<const Node* const*>(this + 1); }
  const Node** nodes() { return reinterpret_cast<const Node**>(this + 1); }
};

/// A block without ownership, as walks pass it: Empty (nullptr), Full, or a node.
class BlockRef {
 public:
  constexpr BlockRef() = default;
  static BlockRef full() { return BlockRef(1); }
  static BlockRef of(const Node* node) { return BlockRef(reinterpret_cast<std::uintptr_t>(node)); }

  bool is_empty() const { return bits_ == 0; }
  bool is_full() const { return bits_ == 1; }
  // One word represents every case, because node addresses are never 0 or 1.
  // NOLINTNEXTLINE(performance-no-int-to-ptr)
  const Node* node() const { return bits_ > 1 ? reinterpret_cast<const Node*>(bits_) : nullptr; }
  Status status() const { return is_empty() ? Status::Empty : is_full() ? Status::Full : Status::Partial; }
  /// The child of a block of height 3 or more. If the block is homogeneous, so is the child: the block is
  /// returned.
  BlockRef child(int index) const {
    assert(index >= 0 && index < 64);
    const Node* parent = node();
    if (parent == nullptr) return *this;
    if ((parent->partial >> index) & 1) return of(parent->nodes()[parent->rank(index)]);
    return ((parent->full >> index) & 1) ? full() : BlockRef();
  }
  /// The word of a leaf of a block of height 2; all zeros or all ones if the leaf is Empty or Full.
  std::uint64_t word(int index) const {
    assert(index >= 0 && index < 64);
    const Node* parent = node();
    if (parent == nullptr) return is_full() ? all_children : 0;
    if ((parent->partial >> index) & 1) return parent->words()[parent->rank(index)];
    return ((parent->full >> index) & 1) ? all_children : 0;
  }
  bool operator==(const BlockRef&) const = default;

 private:
  constexpr explicit BlockRef(std::uintptr_t bits) : bits_(bits) {}
  std::uintptr_t bits_ = 0;
};

/// Prefetches a node's reference count before retain() or release(). Atomic operations wait for memory one
/// after the other, whereas prefetches overlap.
inline void prefetch_references(const Node* node) {
  __builtin_prefetch(&node->references, 1);
}

/// retain() adds a reference to a block's node; release() removes one. If it was the last reference, the node
/// is freed and its children are released.
void retain(BlockRef block);
void release(BlockRef block);

/// An owned block.
class Block {
 public:
  Block() = default;
  /// Becomes the owner of a reference that the caller owned.
  static Block adopt(BlockRef block) { return Block(block); }
  static Block share(BlockRef block) {
    retain(block);
    return Block(block);
  }
  Block(const Block& other) : ref_(other.ref_) { retain(ref_); }
  Block(Block&& other) noexcept : ref_(std::exchange(other.ref_, BlockRef())) {}
  Block& operator=(Block other) noexcept {
    std::swap(ref_, other.ref_);
    return *this;
  }
  ~Block() { release(ref_); }

  BlockRef ref() const { return ref_; }
  /// Makes the caller the owner of the reference, and becomes Empty.
  BlockRef detach() { return std::exchange(ref_, BlockRef()); }

 private:
  explicit Block(BlockRef ref) : ref_(ref) {}
  BlockRef ref_;
};

/// The block of height 2 whose leaves in `partial` have the given words, in ascending child number. Words
/// that are all ones or all zeros are condensed to Full or Empty leaves, and the block becomes Full or Empty
/// if all its leaves are.
Block make_leaf_block(std::uint64_t full, std::uint64_t partial, const std::uint64_t* words);

/// Makes a block of height 3 or more. `children` has one block per bit of `undecided`, in ascending child
/// number; the new block becomes the owner of their references. The result is condensed.
Block make_block(int height, std::uint64_t full, std::uint64_t undecided, std::span<BlockRef> children);

/// The number of voxels of the object in a block of the given height.
std::uint64_t voxel_count(BlockRef block, int height);

}  // namespace octotomy::voxel
