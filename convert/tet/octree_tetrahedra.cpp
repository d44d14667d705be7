// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/octree_tetrahedra.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <stdexcept>
#include <unordered_map>
#include <unordered_set>

#include "voxel/space/error.h"
#include "voxel/tree/slice_bits.h"
#include "voxel/tree/slice_build.h"

// 1 Voxels become cells. Eight cells of one parent and one region merge into one, level by level.
// 2 A cell is divided if a neighbour across a face, edge or corner has less than half its side, from the
//   smallest cells upward.
// 3 A cell's faces become triangles. If smaller cells lie on a face or touch its edges, a fan about its
// middle
//   with their corners on the edges; else two, along the diagonal that ends in the middle of the face of
//   twice the side. So both sides of a face see the same triangles: two of the fan's are those of a smaller
//   cell's face. Each triangle and the cell's middle form an element.
//
// Places are integers in half voxel edges: corners of voxels are even.

namespace octotomy::convert {
namespace {

using Place = glm::ivec3;

std::uint64_t key_of(const Place& p) {
  return (static_cast<std::uint64_t>(p.z) << 42) | (static_cast<std::uint64_t>(p.y) << 21) |
         static_cast<std::uint64_t>(p.x);
}

/// A cube of voxels of one region, by its first voxel.
struct Cell {
  Place first{0};
  std::uint32_t region = 0;
};

/// Cells by side and first voxel.
class Cells {
 public:
  Cells(const std::vector<voxel::Octree>& regions, BoundaryCells boundary)
      : of_side_log2_(static_cast<std::size_t>(regions.front().universe().depth) + 1) {
    for (std::uint32_t region = 0; region < regions.size(); ++region)
      voxel::for_each_slice(regions[region], [&](int z, const voxel::SliceBits& slice) {
        for (int y = 0; y < slice.side; ++y)
          for (int x = 0, last = -1; voxel::next_run(slice, y, last + 1, x, last);)
            for (int v = x; v <= last; ++v)
              of_side_log2_[0].try_emplace(key_of({v, y, z}), Cell{{v, y, z}, region});
      });
    if (boundary == BoundaryCells::Voxels) find_boundary();
    for (std::size_t level = 0; level + 1 < of_side_log2_.size() && !of_side_log2_[level].empty(); ++level)
      merge(level);
    at_boundary_.clear();
  }

  /// The side of the cell that holds a voxel, as a power of two; none if there is no cell.
  std::optional<int> side_log2_at(const Place& voxel) const {
    if (voxel.x < 0 || voxel.y < 0 || voxel.z < 0) return std::nullopt;
    for (std::size_t level = 0; level < of_side_log2_.size(); ++level)
      if (of_side_log2_[level].contains(key_of(first_of(voxel, static_cast<int>(level)))))
        return static_cast<int>(level);
    return std::nullopt;
  }

  /// Pass 2.
  void balance() {
    for (std::size_t level = 0; level + 2 < of_side_log2_.size(); ++level) {
      std::vector<Cell> open = sorted(level);
      while (!open.empty()) {
        const Place cell = open.back().first;
        open.pop_back();
        const int side = 1 << level;
        for (int n = 0; n < 27; ++n) {
          const Place beside = cell + side * (Place(n % 3, (n / 3) % 3, n / 9) - 1);
          for (std::optional<int> found = side_log2_at(beside); found && *found > static_cast<int>(level) + 1;
               found = side_log2_at(beside))
            divide(first_of(beside, *found), static_cast<std::size_t>(*found));
        }
      }
    }
  }

  std::vector<Cell> sorted(std::size_t level) const {
    std::vector<Cell> cells;
    for (const auto& [key, cell] : of_side_log2_[level]) cells.push_back(cell);
    std::sort(cells.begin(), cells.end(),
              [](const Cell& a, const Cell& b) { return key_of(a.first) < key_of(b.first); });
    return cells;
  }
  std::size_t levels() const { return of_side_log2_.size(); }
  std::size_t count() const {
    std::size_t cells = 0;
    for (const auto& of_side : of_side_log2_) cells += of_side.size();
    return cells;
  }

 private:
  static Place first_of(const Place& voxel, int level) { return (voxel >> level) << level; }
  static Place child(const Place& first, int number, int side) {
    return first + side * Place(number & 1, (number >> 1) & 1, number >> 2);
  }

  /// Finds voxels with a neighbour across a face, edge or corner that is not in their region.
  void find_boundary() {
    const auto& voxels = of_side_log2_[0];
    for (const auto& [key, voxel] : voxels)
      for (int n = 0; n < 27; ++n) {
        const Place beside = voxel.first + Place(n % 3, (n / 3) % 3, n / 9) - 1;
        if (glm::all(glm::greaterThanEqual(beside, Place(0))))
          if (const auto found = voxels.find(key_of(beside));
              found != voxels.end() && found->second.region == voxel.region)
            continue;
        at_boundary_.insert(key);
        break;
      }
  }

  void merge(std::size_t level) {
    auto& cells = of_side_log2_[level];
    const int side = 1 << level;
    for (const Cell& cell : sorted(level)) {
      const Place parent = first_of(cell.first, static_cast<int>(level) + 1);
      if (parent != cell.first) continue;
      bool all = true;
      for (int k = 0; k < 8 && all; ++k) {
        const std::uint64_t key = key_of(child(parent, k, side));
        const auto found = cells.find(key);
        all = found != cells.end() && found->second.region == cell.region &&
              (level > 0 || !at_boundary_.contains(key));
      }
      if (!all) continue;
      for (int k = 0; k < 8; ++k) cells.erase(key_of(child(parent, k, side)));
      of_side_log2_[level + 1].emplace(key_of(parent), Cell{parent, cell.region});
    }
  }

  void divide(const Place& first, std::size_t level) {
    const auto whole = of_side_log2_[level].find(key_of(first));
    const std::uint32_t region = whole->second.region;
    of_side_log2_[level].erase(whole);
    for (int k = 0; k < 8; ++k) {
      const Place cell = child(first, k, 1 << (level - 1));
      of_side_log2_[level - 1].emplace(key_of(cell), Cell{cell, region});
    }
  }

  std::vector<std::unordered_map<std::uint64_t, Cell>> of_side_log2_;
  std::unordered_set<std::uint64_t> at_boundary_;  ///< voxels that are not merged
};

/// A square of the lattice: its first voxel corner, normal axis, and side as a power of two.
struct Square {
  Place first{0};
  int axis = 0;
  int side_log2 = 0;
};

class Filling {
 public:
  Filling(const voxel::Universe& universe, const Cells& cells)
      : lattice_(universe.lattice()), cells_(cells) {}

  Tetrahedra run(const voxel::Progress& progress) {
    constexpr std::size_t cells_between_looks = 4096;  // some milliseconds
    std::size_t done = 0;
    for (std::size_t level = 0; level < cells_.levels(); ++level)
      for (const Cell& cell : cells_.sorted(level)) {
        if (done++ % cells_between_looks == 0)
          progress.at(static_cast<double>(done) / static_cast<double>(cells_.count()));
        add_cell(cell.first, static_cast<int>(level));
        result_.region_of_tet.resize(result_.tets.size(), cell.region);
      }
    result_.boundary_nodes = boundary_nodes(result_.tets);
    result_.method = "octree";
    return std::move(result_);
  }

 private:
  void add_cell(const Place& cell, int level) {
    const std::uint32_t middle = node(2 * cell + (1 << level));
    for (int axis = 0; axis < 3; ++axis)
      for (int upper = 0; upper < 2; ++upper) {
        Square square{cell, axis, level};
        square.first[axis] += upper << level;
        add_face(square, middle);
      }
  }

  void add_face(const Square& square, std::uint32_t middle) {
    const int side = 1 << square.side_log2;
    std::array<Place, 4> corners;
    for (int i = 0; i < 4; ++i) {
      corners[static_cast<std::size_t>(i)] = square.first;
      corners[static_cast<std::size_t>(i)][(square.axis + 1) % 3] += i == 1 || i == 2 ? side : 0;
      corners[static_cast<std::size_t>(i)][(square.axis + 2) % 3] += i >= 2 ? side : 0;
    }
    std::vector<std::uint32_t> round;
    for (std::size_t i = 0; i < 4; ++i) {
      const Place& from = corners[i];
      const Place& to = corners[(i + 1) % 4];
      round.push_back(node(2 * from));
      if (is_edge_divided(glm::min(from, to),
                          from[(square.axis + 1) % 3] != to[(square.axis + 1) % 3] ? (square.axis + 1) % 3
                                                                                   : (square.axis + 2) % 3,
                          square.side_log2))
        round.push_back(node(from + to));
    }
    if (round.size() == 4 && !is_divided(square)) {
      const Place of_side = square.first >> square.side_log2;
      const std::size_t turn =
          static_cast<std::size_t>(of_side[(square.axis + 1) % 3] + of_side[(square.axis + 2) % 3]) & 1;
      add(round[turn], round[turn + 1], round[turn + 2], middle);
      add(round[turn], round[turn + 2], round[(turn + 3) % 4], middle);
      return;
    }
    const std::uint32_t centre = node(corners[0] + corners[2]);
    for (std::size_t i = 0; i < round.size(); ++i)
      add(centre, round[i], round[(i + 1) % round.size()], middle);
  }

  /// Whether smaller cells lie on the square, on either side.
  bool is_divided(const Square& square) const {
    if (square.side_log2 == 0) return false;
    const int half = 1 << (square.side_log2 - 1);
    for (int k = 0; k < 8; ++k) {
      Place voxel = square.first;
      voxel[(square.axis + 1) % 3] += (k & 1) * half;
      voxel[(square.axis + 2) % 3] += ((k >> 1) & 1) * half;
      voxel[square.axis] -= k >> 2;
      if (const std::optional<int> side = cells_.side_log2_at(voxel); side && *side < square.side_log2)
        return true;
    }
    return false;
  }

  /// Whether smaller cells touch an edge of the lattice with half of theirs.
  bool is_edge_divided(const Place& first, int axis, int side_log2) const {
    if (side_log2 == 0) return false;
    for (int k = 0; k < 8; ++k) {
      Place voxel = first;
      voxel[axis] += (k & 1) << (side_log2 - 1);
      voxel[(axis + 1) % 3] -= (k >> 1) & 1;
      voxel[(axis + 2) % 3] -= k >> 2;
      if (const std::optional<int> side = cells_.side_log2_at(voxel); side && *side < side_log2) return true;
    }
    return false;
  }

  std::uint32_t node(const Place& half) {
    const auto [at, is_new] =
        nodes_.try_emplace(key_of(half), static_cast<std::uint32_t>(result_.nodes_mm.size()));
    if (is_new) {
      if (result_.nodes_mm.size() == std::numeric_limits<std::uint32_t>::max())
        throw voxel::Error(voxel::ErrorCode::Resource,
                           "tetrahedra_of: more nodes than 32-bit numbers can name: take larger voxels");
      result_.nodes_mm.push_back(lattice_.lps_mm(0.5 * glm::dvec3(half) - 0.5));
    }
    return at->second;
  }

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    const auto& p = result_.nodes_mm;
    if (six_volumes({p[a], p[b], p[c], p[d]}) < 0.0) std::swap(b, c);
    result_.tets.push_back({a, b, c, d});
  }

  voxel::Lattice lattice_;
  const Cells& cells_;
  std::unordered_map<std::uint64_t, std::uint32_t> nodes_;
  Tetrahedra result_;
};

}  // namespace

Tetrahedra tetrahedra_of(const voxel::Octree& octree, BoundaryCells boundary,
                         const voxel::Progress& progress) {
  Tetrahedra all = tetrahedra_of(std::vector{octree}, boundary, progress);
  all.region_of_tet.clear();
  return all;
}

Tetrahedra tetrahedra_of(const std::vector<voxel::Octree>& regions, BoundaryCells boundary,
                         const voxel::Progress& progress) {
  if (regions.empty()) throw std::invalid_argument("tetrahedra_of: there is no region");
  for (const voxel::Octree& region : regions) {
    if (region.is_empty())
      throw std::invalid_argument("tetrahedra_of: the octree is empty: there is nothing to fill");
    if (!(region.universe() == regions.front().universe()))
      throw std::invalid_argument("tetrahedra_of: regions are of different universes: evaluate them in one");
  }
  progress.at(0.0);
  Cells cells(regions, boundary);
  cells.balance();
  return Filling(regions.front().universe(), cells).run(progress);
}

}  // namespace octotomy::convert
