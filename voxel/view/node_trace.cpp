// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/node_trace.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <memory>
#include <optional>
#include <tbb/parallel_for.h>

#include "voxel/solid/top_blocks.h"
#include "voxel/tree/octant_order.h"
#include "voxel/tree/octree_node.h"
#include "voxel/view/leaf_surface.h"

// Node tracing (thesis 4.5) with the physical nodes. Departures from the thesis: a quadtree node has 16
// children, the columns of a physical node's 64 children, instead of four; instead of rays that search for
// their next neighbour from the root, the descent itself goes front to back and visits the same nodes; all
// objects are traced at once.
//
// In the *traced frame* a block's digits are p, q (in the image) and r (along the look axis), so that child
// number p + 4q + 16r makes every layer of children across the look axis 16 adjacent bits of a mask. Words
// are transformed into this frame by exchanging digits of their bit numbers. A reversed look only reverses
// the order of layers.
//
// For an object that is not built, a block is evaluated when the descent enters it. A block taller than a
// tile is evaluated once for all tiles, a smaller one by the only tile that shows it.
//
// Passes, for each tile of 64 x 64 columns: 1 descend front to back, paint open columns and skip quadtree
// nodes whose columns are all closed; 2 turn the voxel found in each column into a depth.

namespace octotomy::voxel {
namespace {

/// The height of blocks whose footprint is a tile.
constexpr int tile_height = 3;
constexpr int tile_side = 64;
constexpr int max_height = Universe::max_depth / 2;

/// Transforms a mask of children from number x + 4y + 16z to p + 4q + 16r by exchanging z with the coordinate
/// along `look_axis`. This transformation is its own inverse.
constexpr std::uint64_t traced(std::uint64_t word, int look_axis) {
  if (look_axis == 0) return exchange_index_bits<1, 5>(exchange_index_bits<0, 4>(word));
  if (look_axis == 1) return exchange_index_bits<3, 5>(exchange_index_bits<2, 4>(word));
  return word;
}
static_assert(traced(std::uint64_t{1} << child_index(1, 2, 3), 0) == std::uint64_t{1}
                                                                         << child_index(3, 2, 1));
static_assert(traced(std::uint64_t{1} << child_index(1, 2, 3), 1) == std::uint64_t{1}
                                                                         << child_index(1, 3, 2));

/// Converts a child's number in the traced frame to its number in the node.
constexpr int native(int child, int look_axis) {
  const int p = child & 3;
  const int q = (child >> 2) & 3;
  const int r = child >> 4;
  return look_axis == 0 ? child_index(r, q, p) : look_axis == 1 ? child_index(p, r, q) : child;
}

/// The position of the traced frame in the universe and in the map.
struct TracedFrame {
  explicit TracedFrame(const AxisView& axes, const Universe& universe)
      : look(axes.axis[2]),
        p_axis(look == 0 ? 2 : 0),
        q_axis(look == 1 ? 2 : 1),
        reversed(axes.reversed[2]),
        side(universe.side()) {
    const auto stride = [&](int axis) {
      return axis == axes.axis[0] ? std::size_t{1} : static_cast<std::size_t>(side);
    };
    p_stride = stride(p_axis);
    q_stride = stride(q_axis);
  }
  /// The index along the look axis at depth number `d` behind the universe's front face.
  int index(int d) const { return reversed ? side - 1 - d : d; }
  std::size_t entry(int p, int q) const {
    return static_cast<std::size_t>(p) * p_stride + static_cast<std::size_t>(q) * q_stride;
  }

  int look, p_axis, q_axis;
  bool reversed;
  int side;
  std::size_t p_stride = 1, q_stride = 1;
};

using EnteredBlock = ExpressionBlocks::EnteredBlock;
using TopBlock = TopBlocks::TopBlock;

/// One entry per object; null if the object is built.
using UnbuiltObjects = std::vector<std::unique_ptr<const TopBlocks>>;

UnbuiltObjects unbuilt_of(const std::vector<DrawnObject>& objects) {
  UnbuiltObjects unbuilt(objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i)
    if (objects[i].unbuilt)
      unbuilt[i] = std::make_unique<const TopBlocks>(objects[i].octree.universe(), *objects[i].unbuilt,
                                                     tile_height + 1);
  return unbuilt;
}

/// An object's part of the current block. A block of height 1 is a leaf's word.
struct Part {
  BlockRef block;             ///< the block; unset if `entered` is set
  std::uint64_t full = 0;     ///< Full children, or voxels of a leaf, in the traced frame
  std::uint64_t partial = 0;  ///< in the traced frame
  std::int16_t object = 0;
  EnteredBlock* entered = nullptr;  ///< block of an object that is not built
  const TopBlock* top = nullptr;    ///< also set if all tiles share that block
};

/// Pass 1 for one tile. Depths are in voxels behind the universe's front face.
class TileTrace {
 public:
  TileTrace(const std::vector<DrawnObject>& objects, const UnbuiltObjects& unbuilt, const TracedFrame& frame,
            int tile_p, int tile_q, std::vector<Seen>& columns)
      : unbuilt_(unbuilt),
        frame_(frame),
        tile_p_(tile_p),
        tile_q_(tile_q),
        columns_(columns),
        entered_(objects.size()) {
    open_.fill(0xFFFF);
    const int height = objects.front().octree.root_height();
    // The root block may extend beyond the universe; along a reversed axis the part outside comes first.
    const int before = frame.reversed ? frame.side - (1 << (2 * height)) : 0;
    auto& parts = parts_[static_cast<std::size_t>(height)];
    for (std::size_t i = 0; i < objects.size(); ++i) {
      const auto object = static_cast<std::int16_t>(i);
      const BlockRef root = objects[i].octree.root();
      if (unbuilt[i] != nullptr)
        parts.push_back(unbuilt_root(object));
      else if (!root.is_empty())
        parts.push_back(part(root, object));
    }
    height_ = parts.empty() ? 0 : height;
    front_ = before;
  }

  void run() {
    if (height_ > 0) descend(height_, 0, 0, front_);
  }

 private:
  Part part(BlockRef block, std::int16_t object) const {
    const Node* node = block.node();
    if (node == nullptr) return {block, all_children, 0, object};
    return {block, traced(node->full, frame_.look), traced(node->partial, frame_.look), object};
  }
  Part part(const EnteredBlock& block, std::int16_t object) const {
    return {BlockRef(), traced(block.cover.full, frame_.look), traced(block.cover.undecided(), frame_.look),
            object};
  }
  Part part(EnteredBlock* block, std::int16_t object) const {
    Part made = part(*block, object);
    made.entered = block;
    return made;
  }
  Part part(const TopBlock* block, std::int16_t object) const {
    Part made = part(block->entered, object);
    made.top = block;
    return made;
  }

  Part unbuilt_root(std::int16_t object) {
    const auto i = static_cast<std::size_t>(object);
    entered_[i] = std::make_unique<EnteredBlocks>();
    const TopBlock& root = unbuilt_[i]->root();
    const int height = root.entered.height;
    if (height > tile_height) return part(&root, object);
    EnteredBlock& own = (*entered_[i])[static_cast<std::size_t>(height)];
    own = root.entered;
    return part(&own, object);
  }

  /// The child of a part that is not built. Precondition: the child's bit is set in the part's masks.
  Part unbuilt_child(const Part& outer, int height, int child, int number) {
    if (((outer.full >> child) & 1) != 0) return part(BlockRef::full(), outer.object);
    const auto slot = static_cast<std::size_t>(number);
    if (outer.top != nullptr) {
      if (const auto& top = outer.top->children[slot]) return part(top.get(), outer.object);
      if (const Node* node = outer.top->nodes[slot]) return part(BlockRef::of(node), outer.object);
    }
    const auto object = static_cast<std::size_t>(outer.object);
    EnteredBlock& inner = (*entered_[object])[static_cast<std::size_t>(height - 1)];
    const EnteredBlock& block = outer.top != nullptr ? outer.top->entered : *outer.entered;
    const Node* node = unbuilt_[object]->blocks().enter(block, number, inner);
    return node != nullptr ? part(BlockRef::of(node), outer.object) : part(&inner, outer.object);
  }

  /// Computes the leaf words of all unbuilt parts of height 2. `leaves` is in the traced frame.
  void ask_words(std::uint64_t leaves) {
    const std::uint64_t wanted = traced(leaves, frame_.look);
    for (const Part& part : parts_[2])
      if (part.entered != nullptr)
        unbuilt_[static_cast<std::size_t>(part.object)]->blocks().ask_words(*part.entered, wanted);
  }
  static std::uint64_t word(const Part& part, int number) {
    if (part.entered == nullptr) return part.block.word(number);
    const Cover& cover = part.entered->cover;
    if (((cover.undecided() >> number) & 1) != 0)
      return part.entered->words[static_cast<std::size_t>(number)];
    return ((cover.full >> number) & 1) != 0 ? all_children : 0;
  }

  /// A mask of the columns, or footprints of children, that are still open within the block's footprint.
  std::uint16_t& open(int height, int p, int q) {
    const int mask = tile_side - 1;
    const int shift = 2 * height;
    if (height > tile_height) {
      // Above the tile's height, the descent enters only children that contain the tile, until the tile is
      // closed.
      std::uint16_t& above = open_[273 + static_cast<std::size_t>(height - tile_height - 1)];
      const int child = shift - 2;
      if (above != 0)
        above = static_cast<std::uint16_t>(1 << (((tile_p_ >> child) & 3) + 4 * ((tile_q_ >> child) & 3)));
      return above;
    }
    const int row = tile_side >> shift;
    const int first = height == 1 ? 0 : height == 2 ? 256 : 272;
    const int number = first + ((p & mask) >> shift) + row * ((q & mask) >> shift);
    return open_[static_cast<std::size_t>(number)];
  }

  void see(int p, int q, int d, std::int16_t object) {
    columns_[frame_.entry(p, q)] = {static_cast<float>(d), object, true};
  }

  /// Paints the open columns of a footprint.
  void paint(int height, int p, int q, int d, std::int16_t object) {
    assert(height >= 1 && height <= tile_height);
    std::uint16_t& columns = open(height, p, q);
    for (unsigned rest = columns; rest != 0; rest &= rest - 1) {
      const int column = std::countr_zero(rest);
      const int edge = 1 << (2 * (height - 1));
      const int at_p = p + (column & 3) * edge;
      const int at_q = q + (column >> 2) * edge;
      if (height == 1) {
        see(at_p, at_q, d, object);
      } else {
        paint(height - 1, at_p, at_q, d, object);
      }
    }
    columns = 0;
  }

  /// Traces parts_[1], the words of a leaf.
  void trace_leaf(int p, int q, int d) {
    std::uint16_t& columns = open(1, p, q);
    for (int layer = 0; layer < 4 && columns != 0; ++layer) {
      const int shift = 16 * (frame_.reversed ? 3 - layer : layer);
      for (const Part& leaf : parts_[1]) {
        const auto hit = static_cast<std::uint16_t>((leaf.full >> shift) & columns);
        for (unsigned rest = hit; rest != 0; rest &= rest - 1) {
          const int column = std::countr_zero(rest);
          see(p + (column & 3), q + (column >> 2), d + layer, leaf.object);
        }
        columns = static_cast<std::uint16_t>(columns & ~hit);
      }
    }
  }

  /// Fills parts_[height - 1] with child number `child` of each part at `height`.
  void enter(int height, int child) {
    auto& inner = parts_[static_cast<std::size_t>(height - 1)];
    inner.clear();
    const int number = native(child, frame_.look);
    for (const Part& outer : parts_[static_cast<std::size_t>(height)]) {
      if ((((outer.full | outer.partial) >> child) & 1) == 0) continue;
      if (height == 2) {
        inner.push_back({BlockRef(), traced(word(outer, number), frame_.look), 0, outer.object});
      } else if (outer.entered == nullptr && outer.top == nullptr) {
        inner.push_back(part(outer.block.child(number), outer.object));
      } else {
        inner.push_back(unbuilt_child(outer, height, child, number));
      }
    }
  }

  /// Traces parts_[height]. The corner of their blocks is at p, q, and the blocks' front face is at depth d.
  void descend(int height, int p, int q, int d) {
    assert(height >= 2 && height <= max_height);
    const auto& parts = parts_[static_cast<std::size_t>(height)];
    const int edge = 1 << (2 * (height - 1));
    std::uint16_t& columns = open(height, p, q);
    for (int layer = 0; layer < 4; ++layer) {
      const int shift = 16 * (frame_.reversed ? 3 - layer : layer);
      if (height == 2) ask_words(std::uint64_t{columns} << shift);
      std::uint64_t present = 0;
      for (const Part& part : parts) present |= (part.full | part.partial) >> shift;
      for (unsigned rest = static_cast<unsigned>(present & columns); rest != 0; rest &= rest - 1) {
        const int column = std::countr_zero(rest);
        const int at_p = p + (column & 3) * edge;
        const int at_q = q + (column >> 2) * edge;
        const int at_d = d + layer * edge;
        const std::uint64_t child = std::uint64_t{1} << (shift + column);
        // If the child is Full in the first object that is present, that object fills the whole front layer.
        const auto first = std::find_if(parts.begin(), parts.end(), [&](const Part& part) {
          return ((part.full | part.partial) & child) != 0;
        });
        if ((first->full & child) != 0 && height <= tile_height) {
          paint(height - 1, at_p, at_q, at_d, first->object);
        } else {
          enter(height, shift + column);
          if (height == 2) {
            trace_leaf(at_p, at_q, at_d);
          } else {
            descend(height - 1, at_p, at_q, at_d);
          }
        }
        if (open(height - 1, at_p, at_q) == 0)
          columns = static_cast<std::uint16_t>(columns & ~(1u << column));
      }
      if (columns == 0) return;
    }
  }

  /// The current blocks of an object, by height, up to a tile's height.
  using EnteredBlocks = std::array<EnteredBlock, tile_height + 1>;

  const UnbuiltObjects& unbuilt_;
  const TracedFrame& frame_;
  int tile_p_, tile_q_;
  int height_ = 0;  ///< height of the root block; 0 if there is nothing to trace
  int front_ = 0;   ///< depth of the root block's front face
  std::vector<Seen>& columns_;
  /// Masks of the tile's quadtree: 16 x 16 of height 1, 4 x 4 of height 2, one of height 3, then those above.
  std::array<std::uint16_t, 273 + max_height - tile_height> open_;
  std::array<std::vector<Part>, max_height + 1> parts_;
  std::vector<std::unique_ptr<EnteredBlocks>> entered_;  ///< one for each object; null if the object is built
};

/// Reads samples of a grey octree along the look axis, column by column. Caches the last brick.
class ColumnSamples {
 public:
  ColumnSamples(const GreyOctree& grey, const TracedFrame& frame) : grey_(&grey), frame_(&frame) {}

  void go_to_column(int p, int q) {
    offset_ = part(frame_->p_axis, p) + part(frame_->q_axis, q);
    if (p >> 4 == block_[frame_->p_axis] && q >> 4 == block_[frame_->q_axis]) return;
    block_[frame_->p_axis] = p >> 4;
    block_[frame_->q_axis] = q >> 4;
    block_[frame_->look] = -1;
  }
  /// The sample at an index along the look axis.
  float at(int r) {
    if (r >> 4 != block_[frame_->look]) {
      block_[frame_->look] = r >> 4;
      samples_ = grey_->brick(block_).samples.front().data();
    }
    return samples_[offset_ + part(frame_->look, r)];
  }

 private:
  /// The summand of an index along an axis in the number of a brick's sample. Samples are numbered by leaves,
  /// then by voxels of a leaf, each in the order x + 4y + 16z.
  static int part(int axis, int index) { return (((index >> 2) & 3) * 64 + (index & 3)) << (2 * axis); }

  const GreyOctree* grey_;
  const TracedFrame* frame_;
  const std::int16_t* samples_ = nullptr;
  int offset_ = 0;
  glm::ivec3 block_{-1};
};

/// Computes a moved object's surface in columns, a batch of columns at a time.
class MovedColumns {
 public:
  MovedColumns(const DrawnObject& object, const TracedFrame& frame, double spacing_mm)
      : frame_(frame),
        spacing_mm_(spacing_mm),
        forward_(frame.reversed ? -1.0 : 1.0),
        mirror_(per_mm(), 1 << (2 * object.octree.root_height())),
        surface_(object, per_mm(), mirror_) {}

  /// Adds `seen`, whose depth is a number of voxels, to the batch. When the batch is full, the depths of its
  /// columns are replaced by depths in millimetres.
  void add(Seen& seen, int p, int q) {
    const auto ray = static_cast<std::size_t>(batch_.count);
    const double d = static_cast<double>(seen.depth_mm);
    columns_[ray] = &seen;
    // The ray through the column's centre, starting at the universe's front face.
    batch_.start[static_cast<std::size_t>(frame_.p_axis)][ray] = p;
    batch_.start[static_cast<std::size_t>(frame_.q_axis)][ray] = q;
    batch_.start[static_cast<std::size_t>(frame_.look)][ray] = frame_.index(0) - 0.5 * forward_;
    batch_.enter_mm[ray] = d * spacing_mm_;
    batch_.leave_mm[ray] = (d + 1.0) * spacing_mm_;
    if (++batch_.count == RayBatch::most) find();
  }
  /// Sets the depths of all queued columns. A column whose ray remains outside the surface gets the depth of
  /// the voxel's face.
  void find() {
    surface_.find(batch_, found_);
    for (std::size_t ray = 0; ray < static_cast<std::size_t>(batch_.count); ++ray) {
      columns_[ray]->depth_mm = found_.depth_mm[ray];
      columns_[ray]->stepped = ((~found_.lit | found_.stepped) >> ray & 1) != 0;
    }
    batch_.count = 0;
  }

 private:
  glm::dvec3 per_mm() const {
    glm::dvec3 per_mm(0.0);
    per_mm[frame_.look] = forward_ / spacing_mm_;
    return per_mm;
  }

  const TracedFrame& frame_;
  double spacing_mm_, forward_;
  Mirror mirror_;
  LeafSurface surface_;
  RayBatch batch_;
  RayBatch::ByRay<Seen*> columns_{};
  LeafSurface::Found found_;
};

/// Pass 2 for a tile: depths of the first voxels in millimetres.
class Depths {
 public:
  Depths(const std::vector<DrawnObject>& objects, const TracedFrame& frame, double spacing_mm)
      : objects_(objects), frame_(frame), spacing_mm_(spacing_mm), moved_(objects.size()) {
    for (const DrawnObject& object : objects)
      readers_.push_back(object.grey ? std::optional<ColumnSamples>(std::in_place, *object.grey, frame)
                                     : std::nullopt);
  }

  /// Depths of moved objects are set only after finish().
  void interpolate(Seen& seen, int p, int q) {
    const auto object = static_cast<std::size_t>(seen.object);
    if (readers_[object] && objects_[object].moved_from_still) {
      if (moved_[object] == nullptr)
        moved_[object] = std::make_unique<MovedColumns>(objects_[object], frame_, spacing_mm_);
      return moved_[object]->add(seen, p, q);
    }
    const int d = static_cast<int>(seen.depth_mm);
    double depth_voxels = d;
    if (readers_[object] && d > 0) {
      const double threshold = objects_[object].grey->in_steps(objects_[object].threshold);
      ColumnSamples& samples = *readers_[object];
      samples.go_to_column(p, q);
      const double inside = samples.at(frame_.index(d));
      const double outside = samples.at(frame_.index(d - 1));
      if (outside < threshold && threshold <= inside) {
        // Voxel centres are half a voxel behind their front faces.
        depth_voxels = d - 0.5 + (threshold - outside) / (inside - outside);
        seen.stepped = false;
      }
    }
    seen.depth_mm = static_cast<float>(depth_voxels * spacing_mm_);
  }
  void finish() {
    for (const auto& columns : moved_)
      if (columns != nullptr) columns->find();
  }

 private:
  const std::vector<DrawnObject>& objects_;
  const TracedFrame& frame_;
  double spacing_mm_;
  std::vector<std::optional<ColumnSamples>> readers_;
  /// One for each object that was moved away from its samples.
  std::vector<std::unique_ptr<MovedColumns>> moved_;
};

}  // namespace

ColumnMap node_trace(const std::vector<DrawnObject>& objects, const AxisView& axes) {
  assert(!objects.empty());
  const Universe& universe = objects.front().octree.universe();
  const glm::dvec3 spacing_mm = universe.lattice().spacing_mm();
  const TracedFrame frame(axes, universe);
  const auto side = static_cast<std::size_t>(frame.side);
  ColumnMap map{frame.side, {spacing_mm[axes.axis[0]], spacing_mm[axes.axis[1]]}, {}};
  map.columns.assign(side * side, Seen{});
  const UnbuiltObjects unbuilt = unbuilt_of(objects);
  const int tiles = (frame.side + tile_side - 1) / tile_side;
  tbb::parallel_for(0, tiles * tiles, [&](int tile) {
    const int tile_p = tile % tiles * tile_side;
    const int tile_q = tile / tiles * tile_side;
    // 1. Compute the first voxel of every column.
    TileTrace(objects, unbuilt, frame, tile_p, tile_q, map.columns).run();
    // 2. Compute depths from these voxels, leaf by leaf so that a leaf's samples remain in the cache.
    Depths depths(objects, frame, spacing_mm[frame.look]);
    const int last_p = std::min(tile_p + tile_side, frame.side);
    const int last_q = std::min(tile_q + tile_side, frame.side);
    for (int leaf_q = tile_q; leaf_q < last_q; leaf_q += 4)
      for (int leaf_p = tile_p; leaf_p < last_p; leaf_p += 4)
        for (int column = 0; column < 16; ++column) {
          const int p = leaf_p + (column & 3);
          const int q = leaf_q + (column >> 2);
          Seen& seen = map.columns[frame.entry(p, q)];
          if (seen.lit()) depths.interpolate(seen, p, q);
        }
    depths.finish();
  });
  return map;
}

}  // namespace octotomy::voxel
