// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/octree_cells.h"

#include <gtest/gtest.h>
#include <map>
#include <random>
#include <tuple>

#include "tests/unit_universe.h"
#include "voxel/solid/combine.h"

namespace octotomy::convert {
namespace {

/// Positions as side_log2, z, y, x.
using Places = std::vector<std::array<int, 4>>;

/// The side_log2 of each voxel's cell by the definition, voxel by voxel; -1 without one.
class PlainCells {
 public:
  explicit PlainCells(const voxel::Octree& octree)
      : octree_(octree),
        side_(octree.universe().side()),
        levels_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_) *
                    static_cast<std::size_t>(side_),
                -1) {
    fill_nodes({0, 0, 0}, octree.universe().depth);
  }

  void balance() {
    for (bool changed = true; changed;) {
      changed = false;
      for (int i = 0; i < side_ * side_ * side_; ++i) {
        const glm::ivec3 p(i % side_, i / side_ % side_, i / side_ / side_);
        for (int n = 0; n < 27; ++n) {
          const glm::ivec3 beside = p + glm::ivec3(n % 3, n / 3 % 3, n / 9) - 1;
          if (at(p) < 0 || at(beside) <= at(p) + 1) continue;
          const int level = at(beside);
          set((beside >> level) << level, level, level - 1);
          changed = true;
        }
      }
    }
  }

  /// -1 outside of the universe, too.
  int at(const glm::ivec3& p) const {
    for (int axis = 0; axis < 3; ++axis)
      if (p[axis] < 0 || p[axis] >= side_) return -1;
    return levels_[static_cast<std::size_t>(p.x + side_ * (p.y + side_ * p.z))];
  }

  Places places() const {
    Places cells;
    for (int z = 0; z < side_; ++z)
      for (int y = 0; y < side_; ++y)
        for (int x = 0; x < side_; ++x)
          if (const int level = at({x, y, z}); level >= 0 && ((x | y | z) & ((1 << level) - 1)) == 0)
            cells.push_back({level, z, y, x});
    std::sort(cells.begin(), cells.end());
    return cells;
  }

 private:
  void fill_nodes(const glm::ivec3& first, int level) {
    bool all = true;
    for (int i = 0; i < 1 << (3 * level); ++i)
      all = all && octree_.contains(first + glm::ivec3(i & ((1 << level) - 1),
                                                       (i >> level) & ((1 << level) - 1), i >> (2 * level)));
    if (all) return set(first, level, level);
    for (int k = 0; k < 8 && level > 0; ++k)
      fill_nodes(first + (glm::ivec3(k & 1, (k >> 1) & 1, k >> 2) << (level - 1)), level - 1);
  }

  void set(const glm::ivec3& first, int side_log2, int level) {
    const int side = 1 << side_log2;
    for (int z = first.z; z < first.z + side; ++z)
      for (int y = first.y; y < first.y + side; ++y)
        for (int x = first.x; x < first.x + side; ++x)
          levels_[static_cast<std::size_t>(x + side_ * (y + side_ * z))] = level;
  }

  const voxel::Octree& octree_;
  int side_;
  std::vector<int> levels_;
};

Places places_of(const OctreeCells& cells) {
  Places places;
  cells.for_each([&](const OctreeCell& cell) {
    places.push_back({cell.side_log2, cell.first.z, cell.first.y, cell.first.x});
  });
  return places;
}

/// Boxes at random places, so that nodes of every side lie beside each other.
voxel::Octree random_boxes(int depth, unsigned seed) {
  const voxel::Universe universe = tests::unit_universe(depth);
  std::mt19937 random(seed);
  const auto voxel_number = [&] {
    return static_cast<double>(random() % static_cast<unsigned>(universe.side()));
  };
  voxel::Expression all = voxel::Octree::empty(universe);
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 a(voxel_number(), voxel_number(), voxel_number());
    const glm::dvec3 b(voxel_number(), voxel_number(), voxel_number());
    const voxel::Box box{glm::min(a, b) - 0.5, glm::max(a, b) + 0.5};
    all = i == 2 ? all ^ box : all | box;
  }
  return voxel::combine(universe, all);
}

TEST(OctreeCells, AreAnOctreesNodesAndDividedNoMoreThanNeighboursNeed) {
  std::size_t divided = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const voxel::Octree octree = random_boxes(2 + static_cast<int>(seed % 4), seed);
    PlainCells plain(octree);
    OctreeCells cells(octree.universe());
    cells.add_nodes(octree);
    EXPECT_EQ(places_of(cells), plain.places());
    const std::uint64_t before = cells.count();
    plain.balance();
    cells.balance();
    EXPECT_EQ(places_of(cells), plain.places());
    EXPECT_EQ(cells.count(), plain.places().size());
    divided += cells.count() > before;
  }
  EXPECT_GT(divided, 10U);
}

TEST(OctreeCells, KnowTheirNeighboursOfHalfTheSideTheSameAndTwice) {
  std::size_t halves = 0, twice = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const voxel::Octree octree = random_boxes(4 + static_cast<int>(seed % 2), seed);
    PlainCells plain(octree);
    plain.balance();
    OctreeCells cells(octree.universe());
    cells.add_nodes(octree);
    cells.balance();
    cells.for_each([&](const OctreeCell& cell) {
      const std::uint64_t about = cells.halves_about(cell);
      const int half = (1 << cell.side_log2) / 2;
      for (int i = 0; i < 64; ++i) {
        const glm::ivec3 cube = cell.first + half * (voxel::child_place(i) - 1);
        const bool is_half = half > 0 && plain.at(cube) == cell.side_log2 - 1;
        ASSERT_EQ((about >> i) & 1, is_half ? 1U : 0U) << "cube " << i;
        halves += is_half;
      }
      for (int face = 0; face < 6; ++face) {
        glm::ivec3 beyond = cell.first;
        beyond[face / 2] += face % 2 == 0 ? -1 : 1 << cell.side_log2;
        ASSERT_EQ(cells.has_equal_or_twice(cell, face / 2, face % 2 != 0),
                  plain.at(beyond) >= cell.side_log2);
        twice += plain.at(beyond) > cell.side_log2;
      }
    });
  }
  EXPECT_GT(halves, 100U);
  EXPECT_GT(twice, 100U);
}

TEST(OctreeCells, OfVoxelsHaveNoOtherSide) {
  const voxel::Octree octree = random_boxes(5, 7);
  OctreeCells cells(octree.universe());
  cells.add_voxels(octree);
  EXPECT_EQ(cells.count(), octree.voxel_count());
  cells.for_each([&](const OctreeCell& cell) {
    ASSERT_EQ(cell.side_log2, 0);
    ASSERT_TRUE(octree.contains(cell.first));
  });
}

TEST(OctreeCells, OfAWholeUniverseAreOne) {
  for (int depth = 2; depth <= 12; ++depth) {
    OctreeCells cells(tests::unit_universe(depth));
    cells.add_nodes(voxel::Octree::full(tests::unit_universe(depth)));
    cells.balance();
    EXPECT_EQ(places_of(cells), (Places{{depth, 0, 0, 0}}));
  }
}

}  // namespace
}  // namespace octotomy::convert
