// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/octree_cells.h"

#include <array>

#include "voxel/tree/octant_order.h"

namespace octotomy::convert {
namespace {

/// (x, y, z) of an octant's number x + 2y + 4z.
glm::ivec3 octant_place(int number) {
  return voxel::child_place(voxel::octant_child(number));
}

/// The voxels of a word that touch a neighbouring word. `beside` is the neighbour's direction: -1, 0 or 1
/// along each axis.
std::uint64_t touching(const glm::ivec3& beside) {
  std::uint64_t mask = 0;
  for (int child = 0; child < 64; ++child) {
    const glm::ivec3 place = voxel::child_place(child);
    bool touches = true;
    for (int axis = 0; axis < 3; ++axis)
      touches = touches && (beside[axis] == 0 || place[axis] == (beside[axis] < 0 ? 0 : 3));
    if (touches) mask |= std::uint64_t{1} << child;
  }
  return mask;
}

}  // namespace

OctreeCells::OctreeCells(const voxel::Universe& universe) {
  levels_.reserve(static_cast<std::size_t>(universe.depth) + 1);
  for (int level = 0; level <= universe.depth; ++level)
    levels_.emplace_back(((universe.side() >> level) + 3) / 4);
}

void OctreeCells::add_nodes(const voxel::Octree& octree) {
  add_block(octree.root(), octree.root_height(), glm::ivec3(0));
}

void OctreeCells::add_voxels(const voxel::Octree& octree) {
  add_voxels_of(octree.root(), octree.root_height(), glm::ivec3(0));
}

void OctreeCells::add_block(voxel::BlockRef block, int height, const glm::ivec3& first) {
  if (block.is_empty()) return;
  if (block.is_full()) return set(2 * height, first >> (2 * height));
  const voxel::Node& node = *block.node();
  const int child_log2 = 2 * (height - 1);
  std::uint64_t full = node.full;
  for (int octant = 0; octant < 8; ++octant) {
    const std::uint64_t mask = voxel::octant_mask(octant);
    if ((full & mask) != mask) continue;
    full &= ~mask;
    set(child_log2 + 1, (first >> (child_log2 + 1)) + octant_place(octant));
  }
  for (; full != 0; full &= full - 1)
    set(child_log2, (first >> child_log2) + voxel::child_place(std::countr_zero(full)));
  for (std::uint64_t partial = node.partial; partial != 0; partial &= partial - 1) {
    const int child = std::countr_zero(partial);
    const glm::ivec3 child_first = first + (voxel::child_place(child) << child_log2);
    if (height > 2)
      add_block(block.child(child), height - 1, child_first);
    else
      add_leaf(block.word(child), child_first);
  }
}

void OctreeCells::add_leaf(std::uint64_t word, const glm::ivec3& first) {
  for (int octant = 0; octant < 8; ++octant) {
    const std::uint64_t mask = voxel::octant_mask(octant);
    if ((word & mask) != mask) continue;
    word &= ~mask;
    set(1, (first >> 1) + octant_place(octant));
  }
  if (word != 0) levels_[0].at(first >> 2) |= word;
}

void OctreeCells::add_voxels_of(voxel::BlockRef block, int height, const glm::ivec3& first) {
  if (block.is_empty()) return;
  for (int child = 0; child < 64; ++child) {
    const glm::ivec3 child_first = first + (voxel::child_place(child) << (2 * (height - 1)));
    if (height > 2)
      add_voxels_of(block.child(child), height - 1, child_first);
    else if (const std::uint64_t word = block.word(child); word != 0)
      levels_[0].at(child_first >> 2) |= word;
  }
}

// A word of cells of side s lies in a cube of side 4 s. If a cell of the word touches a neighbouring cube,
// that cube may not lie in a cell of side 4 s or more. Runs from the smallest cells upward, because dividing
// makes no cell smaller than those already visited.
void OctreeCells::balance(const voxel::Progress& progress) {
  std::array<std::uint64_t, 27> touching_beside{};
  for (int n = 0; n < 27; ++n)
    touching_beside[static_cast<std::size_t>(n)] = touching(glm::ivec3(n % 3, (n / 3) % 3, n / 9) - 1);
  for (int level = 0; level + 2 < static_cast<int>(levels_.size()); ++level) {
    const Words& words = levels_[static_cast<std::size_t>(level)];
    const int along = words.pages_along();
    for (int number = 0; number < along * along * along; ++number) {
      const glm::ivec3 page_place(number % along, (number / along) % along, number / (along * along));
      const Words::Page* page = words.page(page_place);
      if (page != nullptr) progress.at(0.0);
      for (int i = 0; page != nullptr && i < 64; ++i) {
        const std::uint64_t word = (*page)[static_cast<std::size_t>(i)];
        for (int n = 0; word != 0 && n < 27; ++n)
          if ((word & touching_beside[static_cast<std::size_t>(n)]) != 0)
            divide_down_to(level + 1, Words::page_side * page_place + voxel::child_place(i) +
                                          glm::ivec3(n % 3, (n / 3) % 3, n / 9) - 1);
      }
    }
  }
}

/// Divides the cell that holds a cube of side_log2 `level` + 1, if there is one, until the cube is eight
/// cells.
void OctreeCells::divide_down_to(int level, const glm::ivec3& place) {
  if (glm::any(glm::lessThan(place, glm::ivec3(0)))) return;
  int holder = level + 1;
  while (holder < static_cast<int>(levels_.size()) && !has(holder, place >> (holder - level - 1))) ++holder;
  if (holder == static_cast<int>(levels_.size())) return;
  for (; holder > level; --holder) {
    const glm::ivec3 whole = place >> (holder - level - 1);
    reset(holder, whole);
    for (int octant = 0; octant < 8; ++octant) set(holder - 1, 2 * whole + octant_place(octant));
  }
}

std::uint64_t OctreeCells::count() const {
  std::uint64_t cells = 0;
  for (const Words& words : levels_)
    for (const Words::Page& page : words.pages())
      for (const std::uint64_t word : page) cells += static_cast<std::uint64_t>(std::popcount(word));
  return cells;
}

std::uint64_t OctreeCells::halves_about(const OctreeCell& cell) const {
  if (cell.side_log2 == 0) return 0;
  const Words& words = levels_[static_cast<std::size_t>(cell.side_log2) - 1];
  const glm::ivec3 first = 2 * (cell.first >> cell.side_log2) - 1;
  std::array<std::uint64_t, 8> eight{};
  std::uint64_t any = 0;
  for (int i = 0; i < 8; ++i)
    any |= eight[static_cast<std::size_t>(i)] = words.get((first >> 2) + octant_place(i));
  if (any == 0) return 0;
  std::uint64_t about = 0;
  for (int child = 0; child < 64; ++child) {
    const glm::ivec3 at = (first & 3) + voxel::child_place(child);
    const int word = at.x / 4 + 2 * (at.y / 4) + 4 * (at.z / 4);
    const int bit = voxel::child_index(at.x & 3, at.y & 3, at.z & 3);
    about |= ((eight[static_cast<std::size_t>(word)] >> bit) & 1) << child;
  }
  return about;
}

bool OctreeCells::has_equal_or_twice(const OctreeCell& cell, int axis, bool upper) const {
  glm::ivec3 beyond = cell.first >> cell.side_log2;
  beyond[axis] += upper ? 1 : -1;
  return has(cell.side_log2, beyond) ||
         (cell.side_log2 + 1 < static_cast<int>(levels_.size()) && has(cell.side_log2 + 1, beyond >> 1));
}

bool OctreeCells::has(int level, const glm::ivec3& place) const {
  return ((levels_[static_cast<std::size_t>(level)].get(place >> 2) >>
           voxel::child_index(place.x & 3, place.y & 3, place.z & 3)) &
          1) != 0;
}

void OctreeCells::set(int level, const glm::ivec3& place) {
  levels_[static_cast<std::size_t>(level)].at(place >> 2) |=
      std::uint64_t{1} << voxel::child_index(place.x & 3, place.y & 3, place.z & 3);
}

void OctreeCells::reset(int level, const glm::ivec3& place) {
  levels_[static_cast<std::size_t>(level)].at(place >> 2) &=
      ~(std::uint64_t{1} << voxel::child_index(place.x & 3, place.y & 3, place.z & 3));
}

}  // namespace octotomy::convert
