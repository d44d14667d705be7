// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/room.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "planner/operation/table/number_format.h"
#include "voxel/measure/distance_map.h"

namespace octotomy::planner {
namespace {

/// Number of times that a universe may double its side.
constexpr int most_levels = 2;

bool contains(const voxel::Box& box, const voxel::Box& other) {
  return glm::all(glm::lessThanEqual(box.low_mm, other.low_mm)) &&
         glm::all(glm::greaterThanEqual(box.high_mm, other.high_mm));
}

voxel::Box around(const voxel::Box& a, const voxel::Box& b) {
  return {glm::min(a.low_mm, b.low_mm), glm::max(a.high_mm, b.high_mm)};
}

/// Whether a part of an object lies outside of the universe, at a place that box_of() can state. Parts that
/// its operands have already lost do not count.
bool has_left(const Object& made) {
  if (!made.image && !made.mesh.whole) return false;
  return std::any_of(made.caveats.begin(), made.caveats.end(), [](const Caveat& caveat) {
    return caveat.verdict == voxel::Verdict::Fail && caveat.is_of_place && !caveat.is_inherited;
  });
}

/// The box of an object in LPS millimetres, including its part outside of the universe.
voxel::Box box_of(const Objects& objects, const Object& made) {
  if (made.mesh.whole) return {made.mesh.whole->size().low_mm, made.mesh.whole->size().high_mm};
  const voxel::Octree& still = still_of(objects, made).voxel.octree;
  const voxel::VoxelRange range = voxel::range_of(still);
  voxel::Box box{glm::dvec3(std::numeric_limits<double>::infinity()),
                 glm::dvec3(-std::numeric_limits<double>::infinity())};
  for (int corner = 0; corner < 8; ++corner) {
    glm::dvec3 p_voxel;
    for (int axis = 0; axis < 3; ++axis)
      p_voxel[axis] = (corner >> axis & 1) != 0 ? range.high[axis] + 0.5 : range.low[axis] - 0.5;
    const glm::dvec3 p_mm(made.image->image_from_object *
                          glm::dvec4(still.universe().lattice().lps_mm(p_voxel), 1.0));
    box = around(box, {p_mm, p_mm});
  }
  return box;
}

}  // namespace

std::optional<voxel::Universe> with_room(const voxel::Universe& universe, const voxel::Box& box_mm) {
  const voxel::Lattice lattice = universe.lattice();
  // Number of voxels needed below the first and beyond the last voxel. The axes of a universe are those of
  // LPS.
  const glm::dvec3 low = glm::min(glm::floor(lattice.voxel(box_mm.low_mm) + 0.5), glm::dvec3(0.0));
  const glm::dvec3 high = glm::max(glm::ceil(lattice.voxel(box_mm.high_mm) + 0.5),
                                   glm::dvec3(static_cast<double>(universe.side())));
  const glm::dvec3 wanted = high - low;
  voxel::Universe larger = universe;
  while (larger.side() < std::max({wanted.x, wanted.y, wanted.z}))
    if (++larger.depth > std::min(universe.depth + most_levels, voxel::Universe::max_depth))
      return std::nullopt;
  // Voxels that the larger universe has in addition are divided between both sides.
  const glm::dvec3 first = low - glm::floor(0.5 * (static_cast<double>(larger.side()) - wanted));
  if (larger.depth > universe.depth) larger.lps_from_voxel[3] = glm::dvec4(lattice.lps_mm(first), 1.0);
  return larger;
}

void need_room(const Objects& objects, const Object& made, const voxel::Universe& least,
               const std::optional<voxel::Box>& room) {
  if (!has_left(made)) return;
  const voxel::Box own = box_of(objects, made), now = voxel::bounds(made.voxel.octree.universe().lattice());
  if (contains(now, own)) return;
  const voxel::Box all = room ? around(*room, own) : own;
  if (with_room(least, all)) throw NeedsRoom{all};
  if (!made.image) return;
  const voxel::Box start = voxel::bounds(least.lattice());
  const glm::dvec3 beyond = glm::max(start.low_mm - own.low_mm, own.high_mm - start.high_mm);
  throw std::runtime_error("it reaches " + three_figures(std::max({beyond.x, beyond.y, beyond.z})) +
                           " mm out of the universe (" + plain(start) +
                           "), which may grow to four times its side and to " +
                           std::to_string(1 << voxel::Universe::max_depth) +
                           " voxels: move less (lengths are in mm), or take larger voxels");
}

}  // namespace octotomy::planner
