// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "convert/tet/sparse_grid.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::convert {

/// A cube of voxels, by its first voxel: a multiple of its side along each axis.
struct OctreeCell {
  glm::ivec3 first{0};
  int side_log2 = 0;
};

/// Cells that do not overlap, stored as one sparse grid of bits for each length of side. Memory: about a byte
/// for each cell at the boundary, 512 bytes for a cell without others nearby, and 5 bytes for every 16 x 16 x
/// 16 voxels of the universe.
class OctreeCells {
 public:
  explicit OctreeCells(const voxel::Universe& universe);

  /// Adds the octree's Full nodes as cells. Precondition, also of add_voxels(): the octree is of the same
  /// universe, and no cell holds one of its voxels yet.
  void add_nodes(const voxel::Octree& octree);
  /// Adds each voxel as a cell.
  void add_voxels(const voxel::Octree& octree);

  /// Divides cells, no more than needed, until none has a neighbour across a face, edge or corner of less
  /// than half its side. Throws voxel::Stopped.
  void balance(const voxel::Progress& progress = {});

  std::uint64_t count() const;

  /// Calls `visit(const OctreeCell&)` for every cell: smaller cells first; cells of one size in the order of
  /// z, y, x.
  template <typename Visit>
  void for_each(const Visit& visit) const;

  /// Which of the 4 x 4 x 4 cubes of half the side that lie in and around a cell are cells themselves: bit
  /// x + 4y + 16z. The cell's own cubes are 1 and 2 along each axis.
  std::uint64_t halves_about(const OctreeCell& cell) const;
  /// Whether a cell of the same side, or one of twice the side, lies across a face.
  bool has_equal_or_twice(const OctreeCell& cell, int axis, bool upper) const;

 private:
  using Words = SparseGrid<std::uint64_t>;  ///< 4 x 4 x 4 cells a word

  void add_block(voxel::BlockRef block, int height, const glm::ivec3& first);
  void add_leaf(std::uint64_t word, const glm::ivec3& first);
  void add_voxels_of(voxel::BlockRef block, int height, const glm::ivec3& first);
  void divide_down_to(int level, const glm::ivec3& place);

  bool has(int level, const glm::ivec3& place) const;
  void set(int level, const glm::ivec3& place);
  void reset(int level, const glm::ivec3& place);

  std::vector<Words> levels_;  ///< by side_log2; places are in units of the side
};

template <typename Visit>
void OctreeCells::for_each(const Visit& visit) const {
  constexpr int side = 4 * Words::page_side;  // of a page, in cells
  struct Placed {
    glm::ivec2 xy;
    const Words::Page* page;
  };
  std::vector<Placed> layer;
  for (int level = 0; level < static_cast<int>(levels_.size()); ++level) {
    const Words& words = levels_[static_cast<std::size_t>(level)];
    const int along = words.pages_along();
    for (int page_z = 0; page_z < along; ++page_z) {
      layer.clear();
      for (int i = 0; i < along * along; ++i)
        if (const Words::Page* page = words.page({i % along, i / along, page_z}))
          layer.push_back({{i % along, i / along}, page});
      for (int z = 0; z < side; ++z)
        for (auto row = layer.begin(), end = row; row != layer.end(); row = end) {
          end = std::find_if(row, layer.end(), [row](const Placed& p) { return p.xy.y != row->xy.y; });
          for (int y = 0; y < side; ++y)
            for (auto placed = row; placed != end; ++placed)
              for (int x = 0; x < side; x += 4) {
                const std::uint64_t word =
                    (*placed->page)[static_cast<std::size_t>(voxel::child_index(x / 4, y / 4, z / 4))];
                for (std::uint64_t four = (word >> voxel::child_index(0, y % 4, z % 4)) & 15; four != 0;
                     four &= four - 1) {
                  const glm::ivec3 place(side * placed->xy.x + x + std::countr_zero(four),
                                         side * placed->xy.y + y, side * page_z + z);
                  visit(OctreeCell{place << level, level});
                }
              }
        }
    }
  }
}

}  // namespace octotomy::convert
