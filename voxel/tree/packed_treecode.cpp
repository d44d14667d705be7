// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Source: treecode, Oliver and Wiseman 1983 (thesis 3.4.3), with two bits a node gathered by parent. Blocks
// are coded 64 children at a time: in octant order (octant_order.h) each octant of a mask is a byte.
#include "voxel/tree/packed_treecode.h"

#include <array>
#include <bit>
#include <stdexcept>
#include <string>

#include "voxel/space/error.h"
#include "voxel/tree/logical_build.h"

namespace octotomy::voxel {
namespace {

constexpr std::uint8_t byte_of(std::uint64_t word, int number) {
  return static_cast<std::uint8_t>(word >> (8 * number));
}

// Two masks with a bit for each byte of a 64-bit word: bytes that are 0xff, and bytes that are neither 0xff
// nor 0.
struct Eight {
  std::uint8_t full = 0;
  std::uint8_t partial = 0;
};
Eight eight_of(std::uint64_t full, std::uint64_t inside) {
  Eight eight;
  for (int k = 0; k < 8; ++k) {
    const bool is_full = byte_of(full, k) == 0xff;
    eight.full |= static_cast<std::uint8_t>(is_full << k);
    eight.partial |= static_cast<std::uint8_t>((!is_full && byte_of(inside, k) != 0) << k);
  }
  return eight;
}

class Encoder {
 public:
  std::vector<std::uint8_t> code;

  void block(BlockRef ref, int height) {
    const Node& node = *ref.node();
    const std::uint64_t full = octant_ordered(node.full);
    const Eight octants = eight_of(full, full | octant_ordered(node.partial));
    put(octants);
    for (int k = 0; k < 8; ++k)
      if ((octants.partial >> k) & 1) octant(ref, height, k);
  }
  void octant(BlockRef ref, int height, int number) {
    const Node& node = *ref.node();
    const std::uint8_t partial = byte_of(octant_ordered(node.partial), number);
    put({byte_of(octant_ordered(node.full), number), partial});
    for (int k = 0; k < 8; ++k) {
      if (((partial >> k) & 1) == 0) continue;
      const int index = 2 * octant_child(number) + octant_child(k);
      if (height == 2)
        word(node.words()[node.rank(index)]);
      else
        block(ref.child(index), height - 1);
    }
  }
  void word(std::uint64_t voxels) {
    const std::uint64_t ordered = octant_ordered(voxels);
    const Eight octants = eight_of(ordered, ordered);
    put(octants);
    for (int k = 0; k < 8; ++k)
      if ((octants.partial >> k) & 1) code.push_back(byte_of(ordered, k));
  }

 private:
  void put(Eight eight) {
    code.push_back(eight.full);
    code.push_back(eight.partial);
  }
};

class Decoder {
 public:
  explicit Decoder(std::span<const std::uint8_t> code) : code_(code) {}

  std::uint8_t next() {
    if (position_ == code_.size()) refuse("the code ends here, within a node");
    return code_[position_++];
  }
  void expect_end() {
    if (position_ != code_.size()) refuse("the code continues after the last node");
  }
  [[noreturn]] void refuse(const std::string& why) const {
    throw InvalidInput("treecode, byte " + std::to_string(position_) + ": " + why);
  }

  Block block(int height) {
    Children children;
    const Eight octants = eight();
    children.full = octants_full(octants.full);
    for (int k = 0; k < 8; ++k)
      if ((octants.partial >> k) & 1) octant(height, k, children);
    return joined(height, children);
  }
  Block block_of_first_octant(int height) {
    Children children;
    octant(height, 0, children);
    return joined(height, children);
  }
  std::uint64_t word() {
    const Eight octants = eight();
    std::uint64_t ordered = 0;
    for (int k = 0; k < 8; ++k) {
      std::uint64_t voxels = ((octants.full >> k) & 1) != 0 ? 0xff : 0;
      if ((octants.partial >> k) & 1) {
        voxels = next();
        if (voxels == 0 || voxels == 0xff) refuse("a Partial node's eight voxels are all Full or all Empty");
      }
      ordered |= voxels << (8 * k);
    }
    return child_ordered(ordered);
  }

 private:
  // The masks are in octant order, the payload is in the order of child numbers.
  struct Children {
    std::uint64_t full = 0;
    std::uint64_t partial = 0;
    std::array<std::uint64_t, 64> words;
    std::array<Block, 64> blocks;
  };

  static std::uint64_t octants_full(std::uint8_t full) {
    std::uint64_t mask = 0;
    for (int k = 0; k < 8; ++k)
      if ((full >> k) & 1) mask |= std::uint64_t{0xff} << (8 * k);
    return mask;
  }

  Eight eight() {
    Eight read;
    read.full = next();
    read.partial = next();
    if ((read.full & read.partial) != 0) refuse("a child is marked both Full and Partial");
    if (read.full == 0xff || (read.full | read.partial) == 0)
      refuse("a Partial node's eight children are all Full or all Empty");
    return read;
  }

  void octant(int height, int number, Children& children) {
    const Eight read = eight();
    children.full |= static_cast<std::uint64_t>(read.full) << (8 * number);
    children.partial |= static_cast<std::uint64_t>(read.partial) << (8 * number);
    for (int k = 0; k < 8; ++k) {
      if (((read.partial >> k) & 1) == 0) continue;
      const auto index = static_cast<std::size_t>(2 * octant_child(number) + octant_child(k));
      if (height == 2)
        children.words[index] = word();
      else
        children.blocks[index] = block(height - 1);
    }
  }

  static Block joined(int height, Children& children) {
    const std::uint64_t full = child_ordered(children.full);
    const std::uint64_t partial = child_ordered(children.partial);
    std::size_t count = 0;
    if (height == 2) {
      std::array<std::uint64_t, 64> words;
      for (std::uint64_t rest = partial; rest != 0; rest &= rest - 1)
        words[count++] = children.words[static_cast<std::size_t>(std::countr_zero(rest))];
      return make_leaf_block(full, partial, words.data());
    }
    std::array<BlockRef, 64> blocks;
    for (std::uint64_t rest = partial; rest != 0; rest &= rest - 1)
      blocks[count++] = children.blocks[static_cast<std::size_t>(std::countr_zero(rest))].detach();
    return make_block(height, full, partial, {blocks.data(), count});
  }

  std::span<const std::uint8_t> code_;
  std::size_t position_ = 0;
};

Block decoded_root(int depth, Decoder& decoder) {
  const int height = root_height(depth);
  if (depth % 2 == 1) return decoder.block_of_first_octant(height);
  if (depth > 2) return decoder.block(height);
  const std::uint64_t word = decoder.word();
  return make_leaf_block(0, 1, &word);
}

}  // namespace

std::vector<std::uint8_t> packed_treecode(const Octree& octree) {
  const int depth = octree.universe().depth;
  const Status status = LogicalNode::root(octree).status();
  Encoder encoder;
  encoder.code.push_back(static_cast<std::uint8_t>(status));
  if (status != Status::Partial) return encoder.code;
  if (depth == 2)
    encoder.word(octree.root().word(0));
  else if (depth % 2 == 1)
    encoder.octant(octree.root(), octree.root_height(), 0);
  else
    encoder.block(octree.root(), octree.root_height());
  return encoder.code;
}

Octree octree_of_packed_treecode(const Universe& universe, std::span<const std::uint8_t> code) {
  check_depth(universe.depth);
  Decoder decoder(code);
  const std::uint8_t status = decoder.next();
  if (status > 2) decoder.refuse("the root must be 0 (Empty), 1 (Full) or 2 (Partial)");
  Octree octree = status == 0   ? Octree::empty(universe)
                  : status == 1 ? Octree::full(universe)
                                : Octree(universe, decoded_root(universe.depth, decoder));
  decoder.expect_end();
  return octree;
}

}  // namespace octotomy::voxel
