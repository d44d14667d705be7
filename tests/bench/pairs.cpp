// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/bench/pairs.h"

#include "tests/bench/subjects.h"
#include "voxel/solid/combine.h"

namespace octotomy::bench {
namespace {

using voxel::Expression;
using voxel::Octree;

template <Octree (*make)(int)>
const Octree& kept(int side) {
  if (side == 256) {
    static const Octree at_256 = make(256);
    return at_256;
  }
  static const Octree at_512 = make(512);
  return at_512;
}

Octree evaluated(const Expression& expression, int side) {
  return voxel::combine(universe(side), expression);
}

Octree left_sphere(int side) {
  return evaluated(sphere(side, -0.06), side);
}
Octree right_sphere(int side) {
  return evaluated(sphere(side, 0.06), side);
}
Octree box(int side) {
  return evaluated(face_box(side), side);
}
Octree half_space(int side) {
  return evaluated(oblique_half_space(side), side);
}

}  // namespace

std::span<const Pair> pairs() {
  static constexpr Pair all[] = {
      {"spheres", kept<left_sphere>, kept<right_sphere>},
      {"sphere_chequer", kept<left_sphere>, kept<chequered_sphere>},
      {"skull_box", kept<skull>, kept<box>},
      {"skull_halfspace", kept<skull>, kept<half_space>},
  };
  return all;
}

voxel::Motion translation(int side) {
  voxel::Motion motion;
  motion.translate_mm = universe(side).lattice().spacing_mm() * glm::dvec3(3, -11, 6);
  return motion;
}

voxel::Motion rotation() {
  voxel::Motion motion;
  motion.degrees = 5.0;
  motion.axis = {1, 0.2, 0.1};
  motion.about_mm = {0, -40, -30};
  motion.translate_mm = {0, -6, 2};
  return motion;
}

}  // namespace octotomy::bench
