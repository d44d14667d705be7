// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/bench/subjects.h"

#include <algorithm>
#include <map>

#include "verify/phantom/head_phantom.h"
#include "voxel/solid/combine.h"

namespace octotomy::bench {
namespace {

double extent_mm() {
  const glm::dvec3 extent = verify::head_bounds().high_mm - verify::head_bounds().low_mm;
  return std::max({extent.x, extent.y, extent.z});
}

glm::dvec3 middle_mm() {
  return 0.5 * (verify::head_bounds().high_mm + verify::head_bounds().low_mm);
}

}  // namespace

voxel::Universe universe(int side) {
  return voxel::universe_around(verify::head_bounds(), extent_mm() / side);
}

voxel::Expression sphere(int, double offset) {
  return voxel::Sphere{middle_mm() + glm::dvec3(offset * extent_mm(), 0, 0), 0.25 * extent_mm()};
}

voxel::Octree chequered_sphere(int side) {
  const voxel::Box bounds = voxel::bounds(universe(side).lattice());
  const double cell_mm = (bounds.high_mm.x - bounds.low_mm.x) / 8.0;
  // One set of slabs for each axis. A cell is inside if an odd number of axes contain it.
  std::optional<voxel::Expression> board;
  for (int axis = 0; axis < 3; ++axis)
    for (int slab = 0; slab < 8; slab += 2) {
      voxel::Box box = bounds;
      box.low_mm[axis] += slab * cell_mm;
      box.high_mm[axis] = box.low_mm[axis] + cell_mm;
      board = board ? *board ^ box : voxel::Expression(box);
    }
  return voxel::combine(universe(side), sphere(side, 0.0) & *board);
}

const voxel::Scene& head(int side) {
  static std::map<int, voxel::Scene> scanned;
  const auto found = scanned.find(side);
  if (found != scanned.end()) return found->second;
  verify::HeadOptions options;
  options.voxel_mm = extent_mm() / side;
  return scanned.emplace(side, verify::head_phantom(options)).first->second;
}

voxel::GreyOctree grey_skull(int side) {
  return voxel::grey_octree_of(universe(side), head(side));
}

voxel::Octree skull(int side) {
  return voxel::combine(universe(side), voxel::Window{grey_skull(side), 300.0, 32767.0});
}

voxel::Expression face_box(int) {
  return voxel::Box{{-45, -110, -70}, {45, -20, -10}};
}

voxel::Expression oblique_half_space(int) {
  return voxel::HalfSpace{glm::normalize(glm::dvec3(0.2, -0.5, 1.0)), 0.0};
}

}  // namespace octotomy::bench
