// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/voxel/voxelise.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <tbb/parallel_for.h>
#include <utility>

#include "convert/voxel/slab_triangles.h"
#include "voxel/space/shared_progress.h"

// Parity along rays, with rows of voxels as rays. The passes:
//
// 1 Points to index space, where voxel centres are integers; triangles into slabs of 16 voxel layers.
// 2 A slab's triangles are scanned: every layer z cuts a triangle in at most one segment, every row y cuts
//   the segment in at most one point, and the row's bit at the first voxel not before that point flips.
// 3 A running exclusive-or along each row turns flips into voxels inside.
// 4 A slab's rows become 16 x 16 x 16 blocks.
// The half-open rule: layer z cuts an edge if one end is at or below z and the other above; row y cuts a
// segment if it begins at or below y and ends above. The cut of an edge is computed from its lower end, so
// both triangles on it get the same number to the last bit, and each row is crossed an even number of times
// whichever way the crossings are rounded. So a closed mesh never leaks, even with vertices and edges on
// voxel centres.

namespace octotomy::convert {
namespace {

void check_closed(const brep::Linked& solid) {
  const auto open = std::find(solid.opposite.begin(), solid.opposite.end(), brep::Linked::none);
  if (open == solid.opposite.end()) return;
  const glm::dvec3& p =
      solid.triangles.points_mm[solid.from(static_cast<std::uint32_t>(open - solid.opposite.begin()))];
  throw voxel::Error(voxel::ErrorCode::Geometry, "voxelise: the mesh is open at (" + std::to_string(p.x) +
                                                     ", " + std::to_string(p.y) + ", " + std::to_string(p.z) +
                                                     ") mm, so it has no inside: close its holes first");
}

/// Sixteen layers of voxels as rows of bits along x.
class Slab {
 public:
  Slab(int side, int first_z)
      : side_(side),
        first_z_(first_z),
        end_z_(std::min(first_z + slab_layers, side)),
        words_(static_cast<std::size_t>(std::max(side / 64, 1))),
        bits_(words_ * static_cast<std::size_t>(side) * slab_layers, 0),
        touched_(static_cast<std::size_t>(side) * slab_layers, 0) {}

  void flip_crossings_of(const Corners& corners) {
    const auto [first, end] = layers_cut(corners, side_);
    for (int z = std::max(first, first_z_); z < std::min(end, end_z_); ++z) {
      const LayerCut cut = cut_by_layer(corners, z);
      flip_along(cut.from, cut.to, z);
    }
  }

  void fill_rows() {
    for (std::size_t row = 0; row < touched_.size(); ++row) {
      if (touched_[row] == 0) continue;
      std::uint64_t carry = 0;
      for (std::size_t i = row * words_; i < (row + 1) * words_; ++i) {
        std::uint64_t word = bits_[i];
        for (int shift = 1; shift < 64; shift *= 2) word ^= word << shift;
        bits_[i] = word ^ carry;
        carry = std::uint64_t{0} - (bits_[i] >> 63);
      }
    }
    // A row of fewer than 64 voxels fills only a part of its word: clears the bits beyond it.
    if (side_ < 64)
      for (std::uint64_t& word : bits_) word &= (std::uint64_t{1} << side_) - 1;
  }

  bool touched(int block_y) const {
    const std::uint8_t* row = &touched_[row_number(block_y * slab_layers, 0)];
    return std::any_of(row, row + row_count() * slab_layers, [](std::uint8_t t) { return t != 0; });
  }

  voxel::Block block(int block_x, int block_y) const {
    // Sixteen voxels of each row: index y + 16 z.
    std::array<std::uint16_t, 256> row{};
    std::uint16_t any = 0;
    std::uint16_t all = 0xffff;
    const int rows = row_count();
    for (int y = 0; y < rows; ++y)
      for (int z = 0; z < slab_layers; ++z) {
        const std::uint64_t word =
            bits_[row_number(block_y * slab_layers + y, z) * words_ + static_cast<std::size_t>(block_x / 4)];
        const auto sixteen = static_cast<std::uint16_t>(word >> (slab_layers * (block_x % 4)));
        row[voxel_row(y, z)] = sixteen;
        any |= sixteen;
        all &= sixteen;
      }
    if (any == 0) return {};
    if (all == 0xffff && rows == slab_layers) return voxel::make_leaf_block(voxel::all_children, 0, nullptr);
    return leaf_block_of_rows(row);
  }

 private:
  /// Rows of a block that exist: universes of fewer than 16 voxels a side have fewer.
  int row_count() const { return std::min(slab_layers, side_); }
  /// The rows of one y in successive layers follow each other.
  std::size_t row_number(int y, int z_in_slab) const {
    return static_cast<std::size_t>(y) * slab_layers + static_cast<std::size_t>(z_in_slab);
  }

  /// The place of a row within a block's 256.
  static std::size_t voxel_row(int y, int z) {
    return static_cast<std::size_t>(y) + static_cast<std::size_t>(z) * slab_layers;
  }

  void flip_along(const glm::dvec2& from, const glm::dvec2& to, int z) {
    const int end = first_not_below(to.y, 0, side_);
    for (int y = first_not_below(from.y, 0, side_); y < end; ++y) {
      const double t = (y - from.y) / (to.y - from.y);
      const int x = first_not_below(from.x + t * (to.x - from.x), 0, side_);
      if (x == side_) continue;
      const std::size_t row = row_number(y, z - first_z_);
      bits_[row * words_ + static_cast<std::size_t>(x / 64)] ^= std::uint64_t{1} << (x % 64);
      touched_[row] = 1;
    }
  }

  int side_, first_z_, end_z_;
  std::size_t words_;
  std::vector<std::uint64_t> bits_;
  std::vector<std::uint8_t> touched_;
};

}  // namespace

voxel::Octree voxelise(const voxel::Universe& universe, const brep::Linked& solid,
                       const voxel::Progress& progress) {
  const int side = universe.side();
  progress.at(0.0);
  check_closed(solid);
  const std::vector<Corners> triangles = triangles_in_index_space(universe, solid.triangles);
  const SlabLists lists =
      sort_into_slabs(triangles, side, [side](const Corners& corners) { return layers_cut(corners, side); });

  BlockGrid grid(universe);
  voxel::SharedProgress slabs_done(progress, static_cast<std::size_t>(grid.side()));
  tbb::parallel_for(0, grid.side(), [&](int z) {
    slabs_done.one_more();
    const auto slab_number = static_cast<std::size_t>(z);
    if (lists.first[slab_number] == lists.first[slab_number + 1]) return;
    Slab slab(side, z * slab_layers);
    for (std::size_t i = lists.first[slab_number]; i < lists.first[slab_number + 1]; ++i)
      slab.flip_crossings_of(triangles[lists.triangles[i]]);
    slab.fill_rows();
    for (int y = 0; y < grid.side(); ++y)
      for (int x = 0; x < grid.side() && slab.touched(y); ++x) grid.at({x, y, z}) = slab.block(x, y);
  });
  return grid.take_octree();
}

}  // namespace octotomy::convert
