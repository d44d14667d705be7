// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/voxel/voxelise_partial.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <tbb/parallel_for.h>
#include <utility>

#include "convert/voxel/slab_triangles.h"
#include "convert/voxel/voxelise.h"
#include "voxel/solid/combine.h"
#include "voxel/space/shared_progress.h"
#include "voxel/tree/build.h"

// Shares by the divergence theorem, a row of voxels at a time. A line along x that enters the solid at e
// fills x1 - e of the voxel x0 .. x1 that holds e, and all voxels behind it; a line that leaves subtracts the
// same amounts. Integrated over the row's cross-section, a piece of surface in a voxel adds its area seen
// along x, times the voxel's length, to each voxel behind it. To its own voxel it adds that amount less the
// area's moment about x0. The passes:
//
// 1 voxelise() decides the voxels that no triangle touches by their centres.
// 2 A slab's triangles are cut into layers, the layers' pieces into rows, the rows' pieces into voxels: a
//   piece holds the two integrals of its polygon. A voxel is touched by a piece that is not in one of its
//   faces.
// 3 Pieces are sorted by voxel, those of one voxel in the order of their triangles, and summed along rows.
// 4 Shares are put into tree order.

namespace octotomy::convert {
namespace {

/// A convex polygon. A triangle cut by six planes has at most nine corners. A sliver that rounding has dented
/// may gain one more corner in a cut.
struct Polygon {
  int count = 0;
  std::array<glm::dvec3, 16> corners;

  void add(const glm::dvec3& p) {
    assert(count < 16);
    corners[static_cast<std::size_t>(count++)] = p;
  }
  double least(int axis) const {
    double value = corners[0][axis];
    for (int i = 1; i < count; ++i) value = std::min(value, corners[static_cast<std::size_t>(i)][axis]);
    return value;
  }
  double most(int axis) const {
    double value = corners[0][axis];
    for (int i = 1; i < count; ++i) value = std::max(value, corners[static_cast<std::size_t>(i)][axis]);
    return value;
  }
};

/// Cuts a polygon by the plane of one coordinate. Corners in the plane belong to both parts.
void split(const Polygon& polygon, int axis, double at, Polygon& below, Polygon& above) {
  below.count = above.count = 0;
  for (int i = 0; i < polygon.count; ++i) {
    const glm::dvec3& p = polygon.corners[static_cast<std::size_t>(i)];
    const glm::dvec3& q = polygon.corners[static_cast<std::size_t>((i + 1) % polygon.count)];
    if (p[axis] <= at) below.add(p);
    if (p[axis] >= at) above.add(p);
    if ((p[axis] < at && q[axis] > at) || (p[axis] > at && q[axis] < at)) {
      const bool rising = p[axis] < q[axis];
      const glm::dvec3& low = rising ? p : q;
      const glm::dvec3& high = rising ? q : p;
      glm::dvec3 cut = low + (at - low[axis]) / (high[axis] - low[axis]) * (high - low);
      cut[axis] = at;
      below.add(cut);
      above.add(cut);
    }
  }
}

/// Calls f(cell, piece) for the cells first .. end - 1 along an axis that a polygon reaches into, cell c from
/// c - 1/2 to c + 1/2. A polygon in the plane between two cells goes to the lower one, flat in its face.
template <typename F>
void for_each_cell(const Polygon& polygon, int axis, int first, int end, const F& f) {
  const auto cell_of = [&](double v) {
    return static_cast<int>(std::clamp(std::ceil(v - 0.5), first - 1.0, static_cast<double>(end)));
  };
  const int from = std::max(cell_of(polygon.least(axis)), first);
  const int to = std::min(cell_of(polygon.most(axis)), end - 1);
  if (from > to) return;
  Polygon rest = polygon;
  Polygon below;
  Polygon above;
  if (rest.least(axis) < first - 0.5) {
    split(rest, axis, first - 0.5, below, above);
    rest = above;
  }
  for (int cell = from; cell <= to; ++cell) {
    if (rest.count == 0) return;
    if (rest.most(axis) <= cell + 0.5) {
      f(cell, rest);
      return;
    }
    split(rest, axis, cell + 0.5, below, above);
    if (below.count > 0) f(cell, below);
    rest = above;
  }
}

/// The contribution of a polygon to its row of voxels.
struct RowContribution {
  std::uint32_t voxel = 0;  ///< x + 1 in a row of side + 1 places, rows y fastest; place 0 is before the row
  std::uint32_t touches = 0;
  double area = 0.0;    ///< projected along x; positive if a line along x enters the solid there
  double moment = 0.0;  ///< the area times its mean distance from the voxel's lower x
};

/// Computes the polygon's area seen along x, and the product of this area and its mean distance from x0.
void integrate(const Polygon& polygon, double x0, RowContribution& piece) {
  const glm::dvec3& a = polygon.corners[0];
  for (int i = 1; i + 1 < polygon.count; ++i) {
    const glm::dvec3& b = polygon.corners[static_cast<std::size_t>(i)];
    const glm::dvec3& c = polygon.corners[static_cast<std::size_t>(i + 1)];
    const double area = 0.5 * ((b.z - a.z) * (c.y - a.y) - (b.y - a.y) * (c.z - a.z));
    piece.area += area;
    piece.moment += area * ((a.x + b.x + c.x) / 3.0 - x0);
  }
}

/// A boundary voxel within its block of sixteen, by its place in tree order.
struct Share {
  std::uint16_t place = 0;
  std::uint16_t fraction = 0;
};

/// Place of a voxel of a block in tree order: leaf, then bit.
std::uint16_t place_of(const glm::ivec3& v) {
  return static_cast<std::uint16_t>(64 * voxel::child_index((v.x / 4) % 4, (v.y / 4) % 4, (v.z / 4) % 4) +
                                    voxel::child_index(v.x % 4, v.y % 4, v.z % 4));
}

/// Passes 2 and 3 for sixteen layers.
class ShareSlab {
 public:
  ShareSlab(int side, int first_z, bool right_handed)
      : side_(side),
        first_z_(first_z),
        end_z_(std::min(first_z + slab_layers, side)),
        sign_(right_handed ? 1.0 : -1.0) {}

  void add(const Corners& corners) {
    Polygon triangle;
    for (const glm::dvec3& corner : corners) triangle.add(corner);
    for_each_cell(triangle, 2, first_z_, end_z_, [&](int z, const Polygon& layer) {
      if (!reaches_into(layer, 2, z)) return;
      for_each_cell(layer, 1, 0, side_, [&](int y, const Polygon& row) {
        if (!reaches_into(row, 1, y)) return;
        add_row(row, y, z);
      });
    });
  }

  /// Shares of the touched voxels by block number x + blocks * y.
  std::vector<std::vector<Share>> shares() {
    std::stable_sort(pieces_.begin(), pieces_.end(),
                     [](const RowContribution& a, const RowContribution& b) { return a.voxel < b.voxel; });
    const int blocks = std::max(side_ / slab_layers, 1);
    std::vector<std::vector<Share>> result(static_cast<std::size_t>(blocks) *
                                           static_cast<std::size_t>(blocks));
    const auto places = static_cast<std::uint32_t>(side_ + 1);
    std::uint32_t row = ~std::uint32_t{0};
    double filled = 0.0;  // the share of the voxels behind
    for (std::size_t i = 0; i < pieces_.size();) {
      const std::uint32_t number = pieces_[i].voxel;
      if (number / places != row) filled = 0.0;
      row = number / places;
      double area = 0.0;
      double moment = 0.0;
      bool touched = false;
      for (; i < pieces_.size() && pieces_[i].voxel == number; ++i) {
        area += pieces_[i].area;
        moment += pieces_[i].moment;
        touched = touched || pieces_[i].touches != 0;
      }
      if (touched) {
        const glm::ivec3 v(static_cast<int>(number % places) - 1, static_cast<int>(row) % side_,
                           first_z_ + static_cast<int>(row) / side_);
        const double share = std::clamp(filled + area - moment, 0.0, 1.0);
        result[static_cast<std::size_t>(v.x / slab_layers + blocks * (v.y / slab_layers))].push_back(
            {place_of(v), static_cast<std::uint16_t>(std::lround(share * voxel::PartialOctree::whole))});
      }
      filled += area;
    }
    return result;
  }

 private:
  /// Whether a polygon reaches into the cell's layer along an axis: cell - 1/2 to cell + 1/2.
  static bool reaches_into(const Polygon& polygon, int axis, int cell) {
    return polygon.most(axis) > cell - 0.5 && polygon.least(axis) < cell + 0.5;
  }

  void add_row(const Polygon& polygon, int y, int z) {
    const auto row = static_cast<std::uint32_t>(y + side_ * (z - first_z_));
    const auto places = static_cast<std::uint32_t>(side_ + 1);
    // Surface before the row's first voxel contributes to the whole row.
    if (polygon.least(0) <= -0.5) {
      Polygon before;
      Polygon rest;
      split(polygon, 0, -0.5, before, rest);
      RowContribution piece{.voxel = row * places};
      integrate(before, 0.0, piece);
      pieces_.push_back({piece.voxel, 0, sign_ * piece.area, 0.0});
    }
    for_each_cell(polygon, 0, 0, side_, [&](int x, const Polygon& cell) {
      RowContribution piece{.voxel = row * places + static_cast<std::uint32_t>(x) + 1,
                            .touches = reaches_into(cell, 0, x) ? 1U : 0U};
      integrate(cell, x - 0.5, piece);
      piece.area *= sign_;
      piece.moment *= sign_;
      pieces_.push_back(piece);
    });
  }

  int side_, first_z_, end_z_;
  double sign_;
  std::vector<RowContribution> pieces_;
};

/// The place of a block of sixteen voxels a side in tree order: its digits to base four, the largest blocks
/// first.
std::uint64_t tree_place(const glm::ivec3& block, int root_height) {
  std::uint64_t place = 0;
  for (int digit = root_height - 3; digit >= 0; --digit) {
    const glm::ivec3 child = (block >> (2 * digit)) & 3;
    place = 64 * place + static_cast<std::uint64_t>(voxel::child_index(child.x, child.y, child.z));
  }
  return place;
}

voxel::Octree touched_octree(const voxel::Universe& universe, const std::vector<std::vector<Share>>& shares,
                             int blocks) {
  return voxel::octree_of_blocks(universe, [&](const glm::ivec3& block) {
    std::array<std::uint64_t, 64> words{};
    const std::vector<Share>& here =
        shares[static_cast<std::size_t>(block.x + blocks * (block.y + blocks * block.z))];
    if (here.empty()) return voxel::Block();
    for (const Share& share : here) words[share.place / 64] |= std::uint64_t{1} << (share.place % 64);
    return voxel::make_leaf_block(0, voxel::all_children, words.data());
  });
}

}  // namespace

voxel::PartialOctree voxelise_partial(const voxel::Universe& universe, const brep::Linked& solid,
                                      const voxel::Progress& progress) {
  const voxel::Octree centres = voxelise(universe, solid, {progress.stop, {}});
  const std::vector<Corners> triangles = triangles_in_index_space(universe, solid.triangles);
  const int side = universe.side();
  const SlabLists lists = sort_into_slabs(triangles, side, [side](const Corners& corners) {
    const auto [low, high] = std::minmax({corners[0].z, corners[1].z, corners[2].z});
    return std::pair{first_not_below(low - 0.5, 0, side), first_not_below(high + 0.5, 0, side)};
  });

  const int blocks = std::max(side / slab_layers, 1);
  const auto layer = static_cast<std::size_t>(blocks) * static_cast<std::size_t>(blocks);
  std::vector<std::vector<Share>> shares(layer * static_cast<std::size_t>(blocks));
  voxel::SharedProgress slabs_done(progress, static_cast<std::size_t>(blocks));
  tbb::parallel_for(0, blocks, [&](int z) {
    slabs_done.one_more();
    ShareSlab slab(side, z * slab_layers, universe.lattice().right_handed());
    const auto slab_number = static_cast<std::size_t>(z);
    for (std::size_t i = lists.first[slab_number]; i < lists.first[slab_number + 1]; ++i)
      slab.add(triangles[lists.triangles[i]]);
    std::vector<std::vector<Share>> of_slab = slab.shares();
    std::move(of_slab.begin(), of_slab.end(),
              shares.begin() + static_cast<std::ptrdiff_t>(layer * slab_number));
  });

  const voxel::Octree touched = touched_octree(universe, shares, blocks);
  voxel::PartialOctree partial{voxel::combine(universe, voxel::Expression(centres) - touched),
                               voxel::combine(universe, voxel::Expression(centres) | touched),
                               {}};
  std::vector<std::pair<std::uint64_t, std::size_t>> order;
  for (int z = 0; z < blocks; ++z)
    for (int y = 0; y < blocks; ++y)
      for (int x = 0; x < blocks; ++x) {
        const auto number = static_cast<std::size_t>(x + blocks * (y + blocks * z));
        if (!shares[number].empty()) order.emplace_back(tree_place({x, y, z}, centres.root_height()), number);
      }
  std::sort(order.begin(), order.end());
  for (const auto& [place, number] : order) {
    std::vector<Share>& here = shares[number];
    std::sort(here.begin(), here.end(), [](const Share& a, const Share& b) { return a.place < b.place; });
    for (const Share& share : here) partial.fractions.push_back(share.fraction);
  }
  check(partial);
  progress.at(1.0);
  return partial;
}

}  // namespace octotomy::convert
