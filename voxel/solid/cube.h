// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

#include "voxel/tree/octree_node.h"

// Whether a cube of index space has parts inside and outside a solid. Decisions follow regular sets: a cube
// is inside if no open part of it lies outside, and it meets the solid if an open part of it lies inside. A
// solid that only touches a cube from outside therefore does not meet it, and replacing a solid by its
// complement swaps the two answers exactly.

namespace octotomy::voxel {

/// A cube of index space.
struct Cube {
  glm::dvec3 centre{0.0};
  double half = 0.5;  ///< half the edge length, in voxels; above 0

  Cube octant(int number) const {
    const glm::dvec3 way(number & 1 ? 1 : -1, number & 2 ? 1 : -1, number & 4 ? 1 : -1);
    return {centre + 0.5 * half * way, 0.5 * half};
  }
};

/// Whether open parts of a cube lie inside and outside a solid. Conservative: `in` may be wrongly true unless
/// `sure_in` is set, and `out` may be unless `sure_out` is set. The operators combine the answers for two
/// solids. If the surfaces of both cross the cube, the result may remain undecided.
struct Meets {
  bool in = true;
  bool out = true;
  bool sure_in = false;
  bool sure_out = false;

  static Meets exactly(bool in, bool out) { return {in, out, in, out}; }
  /// Converts a block's status. Full and Empty are exact; Partial is conservative.
  static Meets of(Status status) {
    return status == Status::Partial ? Meets{} : exactly(status == Status::Full, status == Status::Empty);
  }
  bool decided() const { return in == sure_in && out == sure_out; }

  friend Meets operator~(const Meets& a) { return {a.out, a.in, a.sure_out, a.sure_in}; }
  friend Meets operator&(const Meets& a, const Meets& b) {
    if (!a.in || !b.in) return exactly(false, true);
    return {true, a.out || b.out, (a.sure_in && !b.out) || (b.sure_in && !a.out), a.sure_out || b.sure_out};
  }
  friend Meets operator|(const Meets& a, const Meets& b) { return ~(~a & ~b); }
  friend Meets operator^(const Meets& a, const Meets& b) {
    if (!a.in) return b;
    if (!b.in) return a;
    if (!a.out) return ~b;
    return b.out ? Meets{} : ~a;
  }
};

/// A plane tangent to a surface: inside where gradient . (p - centre of the cube) + value <= 0.
struct Tangent {
  glm::dvec3 gradient{0.0};
  double value = 0.0;
};

/// The number of smooth surfaces of an operand within a cube, and the tangent plane of one of them. Two or
/// more count as meeting in an edge.
struct Sheets {
  int count = 0;
  Tangent first;
  double off_voxels = 0.0;  ///< bounds the distance between the surface and its tangent within the cube
};

/// The share, 0..1, of the cube [-half, half]^3 that lies on the inner side of a plane. Source: Scardovelli
/// and Zaleski, J. Computational Physics 164, 2000, eq. 2-4.
double share_below(const Tangent& tangent, double half);

}  // namespace octotomy::voxel
