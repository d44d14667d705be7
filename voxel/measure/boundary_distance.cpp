// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/measure/boundary_distance.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

/// The squared distances in mm^2 along one axis from a coordinate to four adjacent intervals of `voxels`
/// voxels each.
glm::dvec4 squares_mm2(double p, int first, int voxels, double spacing_mm) {
  const glm::dvec4 low = first - 0.5 + double(voxels) * glm::dvec4(0, 1, 2, 3);
  const glm::dvec4 apart_mm = spacing_mm * glm::max(glm::max(low - p, p - low - double(voxels)), 0.0);
  return apart_mm * apart_mm;
}

/// Searches for the voxel nearest to a point on the other side of the boundary. The shortest path from the
/// point to this voxel ends on the boundary.
struct Search {
  glm::dvec3 p;  ///< in voxels
  glm::dvec3 spacing_mm;
  bool wants_inside;
  double enough_mm2;
  double nearest_mm2 = std::numeric_limits<double>::infinity();

  bool is_over() const { return nearest_mm2 < enough_mm2; }
  bool wants(bool is_inside) const { return is_inside == wants_inside; }

  /// Searches the voxels that touch the point's voxel. Returns whether no other voxel can be nearer.
  bool look_around(const Octree& octree, const glm::ivec3& centre) {
    const glm::dvec3 to_low_mm = spacing_mm * (p - glm::dvec3(centre) + 0.5),
                     to_high_mm = spacing_mm - to_low_mm;
    const glm::dmat3 apart_mm2(to_low_mm * to_low_mm, glm::dvec3(0.0), to_high_mm * to_high_mm);
    const glm::dvec3 beyond_mm = spacing_mm + glm::min(to_low_mm, to_high_mm);
    const double reach_mm = std::min({beyond_mm.x, beyond_mm.y, beyond_mm.z});
    for (int axes = 1; axes <= 3; ++axes)  // across faces, edges, corners
      for (int i = 0; i < 27; ++i) {
        const glm::ivec3 step(i % 3, i / 3 % 3, i / 9);
        if ((step.x != 1) + (step.y != 1) + (step.z != 1) != axes) continue;
        const double mm2 = apart_mm2[step.x].x + apart_mm2[step.y].y + apart_mm2[step.z].z;
        if (mm2 < nearest_mm2 && wants(octree.contains(centre + step - 1))) nearest_mm2 = mm2;
        if (is_over()) return true;
      }
    return nearest_mm2 <= reach_mm * reach_mm;
  }

  /// Considers the distance to the universe's border too, because all space beyond is outside.
  void look_beyond(int side) {
    for (int axis = 0; axis < 3; ++axis) {
      const double mm = spacing_mm[axis] * std::min(p[axis] + 0.5, side - 0.5 - p[axis]);
      nearest_mm2 = std::min(nearest_mm2, mm * mm);
    }
  }

  /// Searches a block of 4^height voxels a side from `low`, nearest children first.
  void visit(BlockRef block, int height, const glm::ivec3& low) {
    assert(height >= 2 && block.node() != nullptr);
    const int side = 1 << (2 * (height - 1));
    const glm::dvec4 x = squares_mm2(p.x, low.x, side, spacing_mm.x),
                     y = squares_mm2(p.y, low.y, side, spacing_mm.y),
                     z = squares_mm2(p.z, low.z, side, spacing_mm.z);
    struct Child {
      double mm2;
      int number;
    };
    std::array<Child, 64> nearer;
    std::size_t count = 0;
    for (int i = 0; i < 64; ++i) {
      const glm::ivec3 at = child_place(i);
      const double mm2 = x[at.x] + y[at.y] + z[at.z];
      if (mm2 < nearest_mm2) nearer[count++] = {mm2, i};
    }
    std::sort(nearer.begin(), nearer.begin() + static_cast<std::ptrdiff_t>(count),
              [](const Child& a, const Child& b) { return a.mm2 < b.mm2; });
    for (std::size_t i = 0; i < count && nearer[i].mm2 < nearest_mm2 && !is_over(); ++i) {
      const glm::ivec3 child_low = low + side * child_place(nearer[i].number);
      if (height == 2) {
        visit_leaf(block.word(nearer[i].number), child_low);
        continue;
      }
      const BlockRef child = block.child(nearer[i].number);
      if (child.node() != nullptr)
        visit(child, height - 1, child_low);
      else if (wants(child.is_full()))
        nearest_mm2 = nearer[i].mm2;
    }
  }

  void visit_leaf(std::uint64_t word, const glm::ivec3& low) {
    const glm::dvec4 x = squares_mm2(p.x, low.x, 1, spacing_mm.x),
                     y = squares_mm2(p.y, low.y, 1, spacing_mm.y),
                     z = squares_mm2(p.z, low.z, 1, spacing_mm.z);
    for (std::uint64_t wanted = wants_inside ? word : ~word; wanted != 0; wanted &= wanted - 1) {
      const glm::ivec3 at = child_place(std::countr_zero(wanted));
      nearest_mm2 = std::min(nearest_mm2, x[at.x] + y[at.y] + z[at.z]);
    }
  }
};

}  // namespace

BoundaryDistance::BoundaryDistance(const Octree& octree)
    : octree_(octree),
      voxel_from_lps_(glm::inverse(octree.universe().lps_from_voxel)),
      spacing_mm_(octree.universe().lattice().spacing_mm()) {
  const glm::dmat3 axes(octree.universe().lps_from_voxel);
  for (int a = 0; a < 3; ++a)
    if (const int b = (a + 1) % 3;
        std::abs(glm::dot(axes[a], axes[b])) > 1e-9 * spacing_mm_[a] * spacing_mm_[b])
      throw InvalidInput("boundary distance: the universe's axes are not perpendicular");
}

double BoundaryDistance::operator()(const glm::dvec3& p_mm, double enough_mm) const {
  const BlockRef root = octree_.root();
  if (root.is_empty()) return std::numeric_limits<double>::infinity();
  const int side = octree_.universe().side();
  const glm::dvec3 p(voxel_from_lps_ * glm::dvec4(p_mm, 1.0));
  const bool in_universe = glm::all(glm::greaterThanEqual(p, glm::dvec3(-0.5))) &&
                           glm::all(glm::lessThan(p, glm::dvec3(side - 0.5)));
  const glm::ivec3 voxel(glm::floor(glm::clamp(p, glm::dvec3(-0.5), glm::dvec3(side)) + 0.5));
  Search search{p, spacing_mm_, !(in_universe && octree_.contains(voxel)), enough_mm * enough_mm};
  if (in_universe && search.look_around(octree_, voxel)) return std::sqrt(search.nearest_mm2);
  if (!search.wants_inside) search.look_beyond(side);
  if (root.node() != nullptr) {
    search.visit(root, octree_.root_height(), glm::ivec3(0));
  } else if (search.wants_inside) {
    const glm::dvec3 apart_mm = spacing_mm_ * glm::max(glm::max(-0.5 - p, p - (side - 0.5)), glm::dvec3(0.0));
    search.nearest_mm2 = glm::dot(apart_mm, apart_mm);
  }
  return std::sqrt(search.nearest_mm2);
}

}  // namespace octotomy::voxel
