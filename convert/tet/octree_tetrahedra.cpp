// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/octree_tetrahedra.h"

#include <algorithm>
#include <array>
#include <bit>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <stdexcept>
#include <string>

#include "convert/tet/octree_cells.h"
#include "voxel/solid/combine.h"
#include "voxel/space/error.h"
#include "voxel/space/memory_need.h"
#include "voxel/space/rounded.h"
#include "voxel/space/shared_progress.h"

// 1 A region's Full nodes become cells; with BoundaryCells::Voxels, the nodes of its inner voxels do, and
//   each other voxel.
// 2 A cell is divided if a neighbour across a face, edge or corner has less than half its side.
// 3 A cell's faces become triangles. If smaller cells lie on a face or touch its edges, the triangles are a
//   fan about the face's middle with the smaller cells' corners on the edges; else two, along the diagonal
//   that ends in the middle of the face of twice the side. So both sides of a face see the same triangles:
//   two of the fan's are those of a smaller cell's face. Each triangle and the cell's middle form an element.
// 4 All cells are cut twice: first to mark the lattice's corners that are nodes and to count elements; then,
//   once there is memory for them, to number nodes in the order of their first mention.
//
// A cell's nodes are named by their places in it: 0, 1 or 2 along each axis, in half sides, x + 3y + 9z.

namespace octotomy::convert {
namespace {

constexpr int place_count = 27;
constexpr int middle_place = 13;

constexpr int step_of(int axis) {
  return axis == 0 ? 1 : axis == 1 ? 3 : 9;
}
constexpr int along(int place, int axis) {
  return place / step_of(axis) % 3;
}

/// The bits of OctreeCells::halves_about() of the eight cubes that meet at a place of the cell.
constexpr std::array<std::uint64_t, place_count> halves_at = [] {
  std::array<std::uint64_t, place_count> at{};
  for (int place = 0; place < place_count; ++place)
    for (int k = 0; k < 8; ++k)
      at[static_cast<std::size_t>(place)] |=
          std::uint64_t{1} << voxel::child_index(along(place, 0) + (k & 1), along(place, 1) + ((k >> 1) & 1),
                                                 along(place, 2) + (k >> 2));
  return at;
}();

/// Pass 3. Calls node(place) for every mention of a node, and triangle(face, a, b, c) with places; faces are
/// numbered 2 axis + upper.
template <typename Node, typename Triangle>
void cut(const OctreeCell& cell, std::uint64_t halves, const Node& node, const Triangle& triangle) {
  const auto is_divided_at = [&](int place) {
    return (halves & halves_at[static_cast<std::size_t>(place)]) != 0;
  };
  node(middle_place);
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    const int first = face % 2 * 2 * step_of(axis);
    const std::array<int, 5> corners{first, first + 2 * step_of(u), first + 2 * step_of(u) + 2 * step_of(v),
                                     first + 2 * step_of(v), first};
    std::array<int, 8> round{};
    std::size_t count = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      node(round[count++] = corners[i]);
      const int edge_middle = (corners[i] + corners[i + 1]) / 2;
      if (is_divided_at(edge_middle)) node(round[count++] = edge_middle);
    }
    const int centre = (corners[0] + corners[2]) / 2;
    if (count == 4 && !is_divided_at(centre)) {
      const glm::ivec3 of_side = cell.first >> cell.side_log2;
      const auto turn = static_cast<std::size_t>(of_side[u] + of_side[v]) & 1;
      triangle(face, round[turn], round[turn + 1], round[turn + 2]);
      triangle(face, round[turn], round[turn + 2], round[(turn + 3) % 4]);
      continue;
    }
    node(centre);
    for (std::size_t i = 0; i < count; ++i) triangle(face, centre, round[i], round[(i + 1) % count]);
  }
}

/// Numbers of the lattice's corners that are nodes, by the rank of their bits; about 5 bytes each.
class CornerNumbers {
 public:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  explicit CornerNumbers(int side) : corners_(side / 4 + 1) {}

  void mark(const glm::ivec3& corner) {
    corners_.at(corner >> 2).marked |= std::uint64_t{1} << bit_of(corner);
  }
  std::uint64_t count_marked() const {
    std::uint64_t count = 0;
    for (const auto& page : corners_.pages())
      for (const CornerBlock& word : page) count += static_cast<std::uint64_t>(std::popcount(word.marked));
    return count;
  }
  /// Gives every corner marked the number `none`. Precondition: 32-bit numbers can name all of these corners.
  void start_numbering() {
    std::uint32_t before = 0;
    for (auto& page : corners_.pages())
      for (CornerBlock& word : page) {
        word.before = before;
        before += static_cast<std::uint32_t>(std::popcount(word.marked));
      }
    numbers_.assign(before, none);
  }
  std::uint32_t& of(const glm::ivec3& corner) {
    const CornerBlock word = corners_.get(corner >> 2);
    const std::uint64_t below = (std::uint64_t{1} << bit_of(corner)) - 1;
    return numbers_[word.before + static_cast<std::size_t>(std::popcount(word.marked & below))];
  }

 private:
  struct CornerBlock {
    std::uint64_t marked = 0;  ///< bits of the marked ones of 4 x 4 x 4 corners
    std::uint32_t before = 0;  ///< number of corners marked in the words before
  };
  static int bit_of(const glm::ivec3& corner) {
    return voxel::child_index(corner.x & 3, corner.y & 3, corner.z & 3);
  }

  SparseGrid<CornerBlock> corners_;
  std::vector<std::uint32_t> numbers_;
};

constexpr std::size_t cells_between_looks = 4096;  // some milliseconds

/// Throws if this many elements and nodes need more memory than is free. `bound` precedes the numbers in the
/// message.
void need_room(std::uint64_t elements, std::uint64_t nodes, const std::string& bound = "") {
  constexpr double bytes_an_element = sizeof(std::array<std::uint32_t, 4>) + sizeof(std::uint32_t);
  constexpr double bytes_a_node = sizeof(glm::dvec3) + 2 * sizeof(std::uint32_t);
  const auto count = static_cast<double>(elements);
  const double bytes = bytes_an_element * count + bytes_a_node * static_cast<double>(nodes);
  if (const auto free = static_cast<double>(voxel::free_memory()); bytes > free)
    throw voxel::Error(voxel::ErrorCode::Resource,
                       "tetrahedra_of: " + bound + voxel::rounded(count / 1e6) + " million elements take " +
                           voxel::rounded(bytes / 1e9) + " GB of memory, " + voxel::rounded(free / 1e9) +
                           " are free: take larger voxels, or raise --memory");
}

/// Pass 4.
class Filling {
 public:
  Filling(const voxel::Universe& universe, const OctreeCells& cells)
      : lattice_(universe.lattice()), cells_(cells), numbers_(universe.side()), cell_count_(cells.count()) {}

  /// Regions share no voxel. Without `tells_regions` all elements belong to one region.
  Tetrahedra run(const std::vector<voxel::Octree>& regions, bool tells_regions,
                 const voxel::Progress& progress) {
    mark_nodes(voxel::part_of(progress, 0.0, 0.5));
    if (tells_regions) result_.region_of_tet.reserve(result_.tets.capacity());
    const voxel::Progress of_elements = voxel::part_of(progress, 0.5, 1.0);
    std::size_t done = 0;
    std::size_t region = 0;
    cells_.for_each([&](const OctreeCell& cell) {
      if (done++ % cells_between_looks == 0)
        of_elements.at(static_cast<double>(done) / static_cast<double>(cell_count_));
      add(cell);
      if (!tells_regions) return;
      // Neighbouring cells are mostly of one region, so test the last one first.
      if (!regions[region].contains(cell.first))
        for (region = 0; !regions[region].contains(cell.first);) ++region;
      result_.region_of_tet.resize(result_.tets.size(), static_cast<std::uint32_t>(region));
    });
    for (std::uint32_t node = 0; node < is_boundary_.size(); ++node)
      if (is_boundary_[node]) result_.boundary_nodes.push_back(node);
    result_.method = "octree";
    return std::move(result_);
  }

 private:
  void mark_nodes(const voxel::Progress& progress) {
    std::size_t done = 0;
    std::uint64_t elements = 0;
    cells_.for_each([&](const OctreeCell& cell) {
      if (done++ % cells_between_looks == 0)
        progress.at(static_cast<double>(done) / static_cast<double>(cell_count_));
      std::uint32_t mentioned = 0;
      cut(
          cell, cells_.halves_about(cell), [&](int place) { mentioned |= std::uint32_t{1} << place; },
          [&](int, int, int, int) { ++elements; });
      mentioned &= ~(std::uint32_t{1} << middle_place);
      for (; mentioned != 0; mentioned &= mentioned - 1)
        numbers_.mark(corner_at(cell, std::countr_zero(mentioned)));
    });
    const std::uint64_t nodes = cell_count_ + numbers_.count_marked();
    if (nodes > std::numeric_limits<std::uint32_t>::max())
      throw voxel::Error(voxel::ErrorCode::Resource,
                         "tetrahedra_of: more nodes than 32-bit numbers can name: take larger voxels");
    need_room(elements, nodes);
    numbers_.start_numbering();
    result_.nodes_mm.reserve(nodes);
    result_.tets.reserve(elements);
    is_boundary_.resize(nodes, false);
  }

  void add(const OctreeCell& cell) {
    const std::uint64_t halves = cells_.halves_about(cell);
    std::array<std::uint32_t, place_count> nodes;
    nodes.fill(CornerNumbers::none);
    int covered_face = -1;
    bool is_covered = false;
    cut(
        cell, halves, [&](int place) { nodes[static_cast<std::size_t>(place)] = node(cell, place, nodes); },
        [&](int face, int a, int b, int c) {
          const std::array<std::uint32_t, 3> corners{nodes[static_cast<std::size_t>(a)],
                                                     nodes[static_cast<std::size_t>(b)],
                                                     nodes[static_cast<std::size_t>(c)]};
          add(corners[0], corners[1], corners[2], nodes[middle_place]);
          if (face != covered_face) is_covered = cells_.has_equal_or_twice(cell, face / 2, face % 2 != 0);
          covered_face = face;
          if (!is_covered && (halves & half_beyond(face, b, c)) == 0)
            for (const std::uint32_t corner : corners) is_boundary_[corner] = true;
        });
  }

  /// The bit of the half cube beyond a fan's triangle, by the triangle's two places on the face's edges. For
  /// an undivided edge, no half cube beyond either half of the edge is a cell.
  static std::uint64_t half_beyond(int face, int b, int c) {
    glm::ivec3 half(0);
    for (int axis = 0; axis < 3; ++axis) half[axis] = along(b, axis) + along(c, axis) > 2 ? 2 : 1;
    half[face / 2] = face % 2 == 0 ? 0 : 3;
    return std::uint64_t{1} << voxel::child_index(half.x, half.y, half.z);
  }

  static glm::ivec3 corner_at(const OctreeCell& cell, int place) {
    return cell.first +
           ((glm::ivec3(along(place, 0), along(place, 1), along(place, 2)) << cell.side_log2) >> 1);
  }

  /// The node's number, which is assigned at the node's first mention.
  std::uint32_t node(const OctreeCell& cell, int place, const std::array<std::uint32_t, place_count>& known) {
    if (const std::uint32_t number = known[static_cast<std::size_t>(place)]; number != CornerNumbers::none)
      return number;
    const auto next = static_cast<std::uint32_t>(result_.nodes_mm.size());
    if (place != middle_place) {
      std::uint32_t& number = numbers_.of(corner_at(cell, place));
      if (number != CornerNumbers::none) return number;
      number = next;
    }
    const glm::ivec3 half_edges =
        2 * cell.first + (glm::ivec3(along(place, 0), along(place, 1), along(place, 2)) << cell.side_log2);
    result_.nodes_mm.push_back(lattice_.lps_mm(0.5 * glm::dvec3(half_edges) - 0.5));
    return next;
  }

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    const auto& p = result_.nodes_mm;
    if (six_volumes({p[a], p[b], p[c], p[d]}) < 0.0) std::swap(b, c);
    result_.tets.push_back({a, b, c, d});
  }

  voxel::Lattice lattice_;
  const OctreeCells& cells_;
  CornerNumbers numbers_;
  std::uint64_t cell_count_;
  std::vector<bool> is_boundary_;  ///< by node
  Tetrahedra result_;
};

/// The voxels of which all 26 neighbours are in the octree.
voxel::Octree inner_voxels(const voxel::Octree& octree) {
  // On a unit lattice, steps of one voxel are exact.
  const voxel::Universe unit{octree.universe().depth, glm::dmat4(1.0)};
  voxel::Octree inner(unit, voxel::Block::share(octree.root()));
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 step(0.0);
    step[axis] = 1.0;
    const voxel::Expression all = inner;
    inner = voxel::combine(unit, all & moved(all, glm::translate(glm::dmat4(1.0), step)) &
                                     moved(all, glm::translate(glm::dmat4(1.0), -step)));
  }
  return {octree.universe(), voxel::Block::share(inner.root())};
}

Tetrahedra filled(const std::vector<voxel::Octree>& regions, bool tells_regions, BoundaryCells boundary,
                  const voxel::Progress& progress) {
  // Each octree node yields at least twelve elements and a node in its middle.
  std::uint64_t least_cells = 0;
  for (const voxel::Octree& region : regions)
    for (const voxel::LevelCount& level : voxel::level_counts(region)) least_cells += level.full;
  need_room(12 * least_cells, least_cells, "at least ");

  const voxel::Universe& universe = regions.front().universe();
  OctreeCells cells(universe);
  for (const voxel::Octree& region : regions) {
    progress.at(0.0);
    if (boundary == BoundaryCells::Nodes) {
      cells.add_nodes(region);
    } else {
      const voxel::Octree inner = inner_voxels(region);
      cells.add_nodes(inner);
      cells.add_voxels(voxel::combine(universe, voxel::Expression(region) - inner));
    }
  }
  cells.balance(progress);
  return Filling(universe, cells).run(regions, tells_regions, progress);
}

}  // namespace

Tetrahedra tetrahedra_of(const voxel::Octree& octree, BoundaryCells boundary,
                         const voxel::Progress& progress) {
  if (octree.is_empty())
    throw voxel::InvalidInput("tetrahedra_of: the octree is empty: there is nothing to fill");
  progress.at(0.0);
  return filled({octree}, false, boundary, progress);
}

Tetrahedra tetrahedra_of(const std::vector<voxel::Octree>& regions, BoundaryCells boundary,
                         const voxel::Progress& progress) {
  if (regions.empty()) throw std::invalid_argument("tetrahedra_of: there is no region");
  for (const voxel::Octree& region : regions) {
    if (region.is_empty())
      throw voxel::InvalidInput("tetrahedra_of: the octree is empty: there is nothing to fill");
    if (!(region.universe() == regions.front().universe()))
      throw voxel::InvalidInput("tetrahedra_of: regions are of different universes: evaluate them in one");
  }
  progress.at(0.0);
  // A voxel in several regions belongs to the first.
  const voxel::Universe& universe = regions.front().universe();
  std::vector<voxel::Octree> apart{regions.front()};
  voxel::Octree taken = regions.front();
  for (std::size_t i = 1; i < regions.size(); ++i) {
    apart.push_back(voxel::combine(universe, voxel::Expression(regions[i]) - taken));
    taken = voxel::combine(universe, voxel::Expression(taken) | regions[i]);
  }
  return filled(apart, true, boundary, progress);
}

}  // namespace octotomy::convert
