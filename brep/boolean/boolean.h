// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "brep/mesh/solid.h"

namespace octotomy::brep {

enum class Operation { Union, Intersection, Difference };

struct BooleanResult {
  Solid solid;
  /// The error of the sums of volumes, see Booleans::residual; none if too few volumes could be computed.
  std::optional<double> residual;
  double shift_mm = 0.0;              ///< as Booleans::shift_mm, summed over several steps
  std::vector<std::string> findings;  ///< doubts, see Booleans
};

/// The Boolean of two solids by corefinement on OpenMesh; Difference is a - b. The result's proof is Rounded:
/// new points are rounded to doubles, so triangles thinner than that rounding may overlap their neighbours.
/// Check with health() before meshing. The result's volume must add up with the volumes of other results.
/// Along lines through every shell, the result must be the operation of the operands, so no shell is surplus,
/// missing or inverted, see disagreement_along_lines(). Shells of one operand may lie on the other's, with
/// the same sense or the contrary one, in whole or in part. Faces that lie on one plane apart from the
/// rounding of points, for example of two boxes under one rotation, count as lying on it exactly, see
/// common_frame.h. If triangles of that answer intersect, it is computed in another way: by cells, if all
/// faces are square to the axes of one frame, see rectilinear.h; otherwise after the coplanar faces were
/// divided into the same triangles, see imprint.h. An operand with a proof below Health may intersect itself;
/// this is detected near the cut only. The bits are the same on any number of threads and for either order of
/// the operands. Throws std::invalid_argument if an operand is inside out; Error (Geometry) if the result
/// cannot be represented as a manifold surface, the volumes do not add up or the lines disagree, even after
/// shifts of an operand (see Booleans::findings); Stopped. Cost: linear in all triangles, some 0.4 us each,
/// and n log n, about 2 us each, for those near the common lines. Source: CGAL's Polygon Mesh Processing,
/// corefinement (Loriot et al.), EPICK predicates; it processes only triangles near the common lines, see
/// near_boolean().
BooleanResult boolean(const Solid& a, Operation operation, const Solid& b, const std::stop_token& stop = {});

/// The Boolean of any number of solids: their union, their intersection, or the first minus all others. The
/// residual is the largest of all steps; findings of all steps are listed. Throws std::invalid_argument if
/// there are no operands, and as above. Cost: unions are computed in pairs, so each triangle takes part in
/// log n unions.
BooleanResult boolean(const std::vector<Solid>& operands, Operation operation,
                      const std::stop_token& stop = {});

/// The results that booleans() must compute.
struct BooleansWanted {
  bool united = true;
  bool intersection = true;
  bool a_minus_b = true;
  bool b_minus_a = true;
};

/// Results of one corefinement. A result that was not wanted may be present or absent.
struct Booleans {
  std::optional<Solid> united;
  std::optional<Solid> intersection;
  std::optional<Solid> a_minus_b;
  std::optional<Solid> b_minus_a;
  /// The largest of |(A + B) - (A u B + A n B)|, |A - (A-B) - (A n B)| and |B - (B-A) - (A n B)|, as volumes
  /// relative to A + B; an identity counts only if all its volumes were computed. None if there is no such
  /// identity.
  std::optional<double> residual;
  /// The distance by which an operand was moved (see "shifted"): about 4e-6 of the operands' extent, 1 um for
  /// a head. The error of each volume is at most this length times the area of the operand's surface.
  double shift_mm = 0.0;
  /// Doubts. "shifted": the operands touch so that a difference or intersection would not be manifold (a
  /// shared edge), or intersect in a way that corefinement cannot resolve, so the named operand was moved.
  /// "touches itself": sheets of a result share a point, which has a vertex for each sheet. "crosses itself":
  /// rounding made triangles intersect, and settled() could not remove these intersections. "meets itself":
  /// an operand's triangles intersect near the cut, usually because an earlier cut was rounded. "film":
  /// shells thinner than the rounding of points were left out. "without area": an operand's triangles without
  /// area were removed by another diagonal, which does not change its surface.
  std::vector<std::string> findings;
};

/// boolean() for several results at once, at the cost of one. An operand is shifted only if a wanted result
/// needs it, and only a missing wanted result throws.
Booleans booleans(const Solid& a, const Solid& b, const BooleansWanted& wanted = {},
                  const std::stop_token& stop = {});

}  // namespace octotomy::brep
