// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/voxel/winding_number.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

#include "convert/voxel/cap.h"
#include "convert/voxel/slab_triangles.h"
#include "convert/voxel/winding_threshold.h"
#include "voxel/space/shared_progress.h"

// The winding number of an open surface S is that of S closed by a cap, less that of the cap. The passes:
// 1 The rim of S is filled by a cap C, see cap.h.
// 2 Along each row of voxels, the signed crossings of S + C are summed to the whole number n, the winding
//   number of S + C about each voxel centre.
// 3 Let w be the winding number of C. A voxel is inside where n - w > 1/2. Away from C, w is smooth. If a
//   cube of voxels contains no triangle of C, and w(centre) differs from every odd multiple of 1/2 by more
//   than w can change within the cube, one whole number serves as the threshold of n for the whole cube.
//   Other cubes are divided, from the universe down to single voxels.
// 4 A row of blocks of 16^3 voxels has 256 rows of voxels. Consecutive blocks that no crossing touches form a
//   stretch if n is the same in all 256 rows. Other blocks are made voxel by voxel. The octree is put
//   together from above: a cube of one n and one threshold is Full or Empty.
//
// Departure from Jacobson, Kavan and Sorkine-Hornung (see the header), who sum over all triangles by a tree:
// here only rims cost, a closed surface has none, and the decision for a cube is proven for each of its
// voxels.

namespace octotomy::convert {
namespace {

constexpr int row_count = slab_layers * slab_layers;  // of a row of blocks

/// How far a cap leaves the rim's plane, in voxel edges. Not simple fractions, so that it lies in no plane of
/// voxel centres.
constexpr glm::dvec3 cap_offset_voxels{0.2718281828, 0.3141592653, 0.1414213562};

/// A crossing of a row with the closed surface: the winding number changes by `change` at voxel x.
struct Crossing {
  std::int32_t x = 0;
  std::uint8_t row = 0;  ///< y + 16 z, of the row of blocks
  std::int8_t change = 0;
};

/// The winding numbers of a block's voxels, x fastest.
using BlockWinds = std::array<std::int32_t, std::size_t{row_count} * slab_layers>;

/// Consecutive blocks in a row of blocks. Begins where the stretch before it ends.
struct Stretch {
  int end = 0;  ///< first block after the stretch
  std::optional<std::int32_t> winds;
  voxel::Block block;  ///< the voxels of each block of the stretch, if `winds` is empty
};
/// An empty row: the surface winds about none of its voxels.
using BlockRow = std::vector<Stretch>;

/// Pass 2 for sixteen layers: by row of blocks, ascending x.
std::vector<std::vector<Crossing>> crossings_of(const std::vector<Corners>& surface, const SlabLists& lists,
                                                int slab, int side, int sign) {
  std::vector<std::vector<Crossing>> rows(static_cast<std::size_t>(std::max(side / slab_layers, 1)));
  const int first_z = slab * slab_layers;
  const int end_z = std::min(first_z + slab_layers, side);
  const auto list = static_cast<std::size_t>(slab);
  for (std::size_t i = lists.first[list]; i < lists.first[list + 1]; ++i) {
    const Corners& corners = surface[lists.triangles[i]];
    const auto [first, end] = layers_cut(corners, side);
    for (int z = std::max(first, first_z); z < std::min(end, end_z); ++z) {
      const LayerCut cut = cut_by_layer(corners, z);
      const int end_y = first_not_below(cut.to.y, 0, side);
      for (int y = first_not_below(cut.from.y, 0, side); y < end_y; ++y) {
        const double t = (y - cut.from.y) / (cut.to.y - cut.from.y);
        const int x = first_not_below(cut.from.x + t * (cut.to.x - cut.from.x), 0, side);
        if (x < side)
          rows[static_cast<std::size_t>(y / slab_layers)].push_back(
              {x, static_cast<std::uint8_t>(y % slab_layers + slab_layers * (z % slab_layers)),
               static_cast<std::int8_t>(cut.entering ? sign : -sign)});
      }
    }
  }
  for (std::vector<Crossing>& row : rows)
    std::sort(row.begin(), row.end(), [](const Crossing& a, const Crossing& b) { return a.x < b.x; });
  return rows;
}

/// Pass 4.
class WoundOctree {
 public:
  WoundOctree(const voxel::Universe& universe, const WindingThreshold& threshold, const std::stop_token& stop)
      : universe_(universe),
        threshold_(threshold),
        stop_(stop),
        top_(threshold_tree(universe, threshold, stop)),
        blocks_along_(std::max(universe.side() / slab_layers, 1)),
        rows_(static_cast<std::size_t>(blocks_along_) * static_cast<std::size_t>(blocks_along_)) {}

  int slab_count() const { return blocks_along_; }

  /// Builds a row of blocks from its crossings. Different rows may be built on different threads.
  void make_row(int block_y, int block_z, const std::vector<Crossing>& crossings) {
    if (crossings.empty()) return;
    BlockRow& row = rows_[row_number(block_y, block_z)];
    std::array<std::int32_t, row_count> winds{};
    auto crossing = crossings.begin();
    for (int x = 0; x < blocks_along_;) {
      const int next = crossing == crossings.end() ? blocks_along_ : crossing->x / slab_layers;
      if (x < next) {
        add_stretch(row, {x, block_y, block_z}, next, winds);
        x = next;
        continue;
      }
      BlockWinds block{};
      for (; crossing != crossings.end() && crossing->x / slab_layers == x; ++crossing)
        block[static_cast<std::size_t>(crossing->row * slab_layers + crossing->x % slab_layers)] +=
            crossing->change;
      for (std::size_t r = 0; r < row_count; ++r) {
        const auto first = block.begin() + static_cast<std::ptrdiff_t>(r) * slab_layers;
        *first += winds[r];
        std::partial_sum(first, first + slab_layers, first);
        winds[r] = *(first + slab_layers - 1);
      }
      row.push_back({x + 1, std::nullopt, made({x, block_y, block_z}, block)});
      ++x;
    }
  }

  voxel::Octree take(const voxel::Progress& progress) const {
    voxel::SharedProgress parts(progress, 64);
    voxel::Octree octree{universe_,
                         put_together(voxel::root_height(universe_.depth), glm::ivec3(0), top_, &parts)};
    progress.at(1.0);
    return octree;
  }

 private:
  void add_stretch(BlockRow& row, glm::ivec3 block, int end,
                   const std::array<std::int32_t, row_count>& winds) {
    if (std::equal(winds.begin() + 1, winds.end(), winds.begin())) {
      row.push_back({end, winds[0], {}});
      return;
    }
    BlockWinds all;
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = winds[i / slab_layers];
    std::optional<int> number;
    for (; block.x < end; ++block.x) {
      const std::optional<int> before = std::exchange(number, node_at(block).number);
      voxel::Block same = number && number == before ? row.back().block : made(block, all);
      row.push_back({block.x + 1, std::nullopt, std::move(same)});
    }
  }

  /// The block's voxels whose winding number is at least the threshold there.
  voxel::Block made(const glm::ivec3& block, const BlockWinds& winds) const {
    std::array<std::uint16_t, row_count> rows{};
    const auto decided = [&](const Cube& cube, int least) {
      const glm::ivec3 end = glm::min(cube.origin + cube.side, glm::ivec3(universe_.side()));
      for (int z = cube.origin.z; z < end.z; ++z)
        for (int y = cube.origin.y; y < end.y; ++y)
          for (int x = cube.origin.x; x < end.x; ++x) {
            const auto r = static_cast<std::size_t>(y % slab_layers + slab_layers * (z % slab_layers));
            if (winds[r * slab_layers + static_cast<std::size_t>(x % slab_layers)] >= least)
              rows[r] |= static_cast<std::uint16_t>(1 << (x % slab_layers));
          }
    };
    const Cube cube{block * slab_layers, slab_layers};
    if (const std::optional<int> number = node_at(block).number)
      decided(cube, *number);
    else
      threshold_.divide(cube, decided);
    return leaf_block_of_rows(rows);
  }

  /// The threshold's node that holds a block.
  const ThresholdNode& node_at(const glm::ivec3& block) const {
    const ThresholdNode* node = &top_;
    for (int height = voxel::root_height(universe_.depth) - 1; node->children != nullptr; --height) {
      const glm::ivec3 child = (block >> (2 * (height - 2))) & 3;
      node = &(*node->children)[static_cast<std::size_t>(voxel::child_index(child.x, child.y, child.z))];
    }
    return *node;
  }

  std::size_t row_number(int block_y, int block_z) const {
    return static_cast<std::size_t>(block_z) * static_cast<std::size_t>(blocks_along_) +
           static_cast<std::size_t>(block_y);
  }

  /// The stretch that holds a block. Precondition: its row has any.
  static const Stretch& stretch_at(const BlockRow& row, int block_x) {
    return *std::partition_point(row.begin(), row.end(),
                                 [block_x](const Stretch& stretch) { return stretch.end <= block_x; });
  }

  /// The winding number of all voxels of a cube; none if they differ. Precondition: within the universe, and
  /// made of whole blocks.
  std::optional<std::int32_t> winds_in(const Cube& cube) const {
    const glm::ivec3 first = cube.origin / slab_layers, end = first + cube.side / slab_layers;
    std::optional<std::int32_t> all;
    for (int z = first.z; z < end.z; ++z)
      for (int y = first.y; y < end.y; ++y) {
        std::int32_t winds = 0;
        if (const BlockRow& row = rows_[row_number(y, z)]; !row.empty()) {
          const Stretch& stretch = stretch_at(row, first.x);
          if (!stretch.winds || stretch.end < end.x) return std::nullopt;
          winds = *stretch.winds;
        }
        if (all.value_or(winds) != winds) return std::nullopt;
        all = winds;
      }
    return all;
  }

  voxel::Block leaf(const glm::ivec3& block) const {
    const BlockRow& row = rows_[row_number(block.y, block.z)];
    const Stretch* stretch = row.empty() ? nullptr : &stretch_at(row, block.x);
    if (stretch != nullptr && !stretch->winds) return stretch->block;
    BlockWinds winds;
    winds.fill(stretch == nullptr ? 0 : *stretch->winds);
    return made(block, winds);
  }

  voxel::Block put_together(int height, const glm::ivec3& origin, const ThresholdNode& node,
                            voxel::SharedProgress* parts) const {
    const Cube cube{origin, 1 << (2 * height)};
    if (glm::any(glm::greaterThanEqual(origin, glm::ivec3(universe_.side())))) return {};
    voxel::Progress{stop_, {}}.at(0.0);
    if (node.number && glm::all(glm::lessThanEqual(origin + cube.side, glm::ivec3(universe_.side()))))
      if (const std::optional<std::int32_t> winds = winds_in(cube))
        return *winds >= *node.number ? voxel::Block::adopt(voxel::BlockRef::full()) : voxel::Block();
    if (height == 2) return leaf(origin / slab_layers);
    std::array<voxel::Block, 64> children;
    tbb::parallel_for(0, 64, [&](int child) {
      const auto i = static_cast<std::size_t>(child);
      children[i] = put_together(height - 1, origin + cube.side / 4 * voxel::child_place(child),
                                 node.children == nullptr ? node : (*node.children)[i], nullptr);
      if (parts != nullptr) parts->one_more();
    });
    std::array<voxel::BlockRef, 64> refs;
    for (std::size_t i = 0; i < 64; ++i) refs[i] = children[i].detach();
    return voxel::make_block(height, 0, voxel::all_children, refs);
  }

  const voxel::Universe& universe_;
  const WindingThreshold& threshold_;
  std::stop_token stop_;
  ThresholdNode top_;
  int blocks_along_;
  std::vector<BlockRow> rows_;  ///< y fastest
};

}  // namespace

double winding_number(const brep::Triangles& triangles, const glm::dvec3& p_mm) {
  double sum = 0.0;
  for (const auto& [a, b, c] : triangles.faces)
    sum += covered_share({triangles.points_mm[a], triangles.points_mm[b], triangles.points_mm[c]}, p_mm);
  return sum;
}

voxel::Octree voxelise_by_winding_number(const voxel::Universe& universe, const brep::Triangles& triangles,
                                         const voxel::Progress& progress) {
  progress.at(0.0);
  std::vector<Corners> surface = triangles_in_index_space(universe, triangles);
  const voxel::Lattice lattice = universe.lattice();
  std::vector<std::array<glm::dvec3, 3>> cap =
      cap_of(triangles, glm::dmat3(universe.lps_from_voxel) * cap_offset_voxels);
  for (const auto& t : cap)
    surface.push_back({lattice.voxel(t[0]), lattice.voxel(t[1]), lattice.voxel(t[2])});
  const int side = universe.side();
  const SlabLists lists =
      sort_into_slabs(surface, side, [side](const Corners& corners) { return layers_cut(corners, side); });
  const WindingThreshold threshold(universe, std::move(cap));
  const int sign = lattice.right_handed() ? 1 : -1;

  WoundOctree wound(universe, threshold, progress.stop);
  const voxel::Progress of_slabs = voxel::part_of(progress, 0.0, 0.5);
  voxel::SharedProgress slabs_done(of_slabs, static_cast<std::size_t>(wound.slab_count()));
  tbb::parallel_for(0, wound.slab_count(), [&](int slab) {
    slabs_done.one_more();
    const auto rows = crossings_of(surface, lists, slab, side, sign);
    for (std::size_t y = 0; y < rows.size(); ++y) wound.make_row(static_cast<int>(y), slab, rows[y]);
  });
  return wound.take(voxel::part_of(progress, 0.5, 1.0));
}

}  // namespace octotomy::convert
