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
  /// How far the volumes are from adding up, see Booleans; none where too few of them could be computed.
  std::optional<double> residual;
  double shift_mm = 0.0;              ///< see Booleans; of several steps the sum
  std::vector<std::string> findings;  ///< doubts, see Booleans
};

/// The Boolean of two solids by corefinement on OpenMesh; Difference is a - b. The result's proof is Rounded:
/// new points are rounded to doubles, so triangles thinner than that rounding may overlap their neighbours.
/// Ask health() before a mesh generator does. Volumes beside the result's are computed with it and must add
/// up. Lines through every shell of the operands and the result must find what the operation makes of the
/// operands, so that no shell is too many, missing or turned, see disagreement_along_lines(). Shells of one
/// operand may lie on the other's, with the same sense or the contrary one, in whole or in part. Faces that lie
/// on one plane but for the rounding of the points, as of boxes turned as one, count as lying on it exactly,
/// see common_frame.h. An operand
/// that meets itself, which a proof below Health allows, is found near the cut only. The bits are the same on
/// any number of threads and for either order of the operands. Throws std::invalid_argument if an operand is
/// inside out; Error (Geometry) if the result cannot be represented as a manifold surface, the volumes do not
/// add up or the lines disagree, after the remedy below; Stopped. Cost: linear in all triangles, some 0.4 us
/// each, and n log n, about 2 us each, for those near the common lines. Source: CGAL's Polygon Mesh
/// Processing, corefinement (Loriot et al.), EPICK predicates; only triangles near the common lines are given
/// to it, see near_boolean().
BooleanResult boolean(const Solid& a, Operation operation, const Solid& b, const std::stop_token& stop = {});

/// The Boolean of any number of solids: their union, their intersection, or the first less all others. The
/// residual is the largest of the steps', and findings are all of them. Throws std::invalid_argument if there
/// are no operands, else as above. Cost: unions are taken in pairs, so that each triangle passes log n of
/// them.
BooleanResult boolean(const std::vector<Solid>& operands, Operation operation,
                      const std::stop_token& stop = {});

/// Which results booleans() must give.
struct BooleansWanted {
  bool united = true;
  bool intersection = true;
  bool a_minus_b = true;
  bool b_minus_a = true;
};

/// Results of one corefinement. One that was not wanted may be there or not.
struct Booleans {
  std::optional<Solid> united;
  std::optional<Solid> intersection;
  std::optional<Solid> a_minus_b;
  std::optional<Solid> b_minus_a;
  /// The largest of |(A + B) - (A u B + A n B)|, |A - (A-B) - (A n B)| and |B - (B-A) - (A n B)|, volumes,
  /// relative to A + B; those of them whose parts were computed.
  std::optional<double> residual;
  /// How far an operand was moved, as "shifted" tells: some 4e-6 of the operands' extent, about 1 um for a
  /// head. Each volume is off by at most that times its area.
  double shift_mm = 0.0;
  /// Doubts. "shifted": the operands touch so that a result would not be manifold (a shared edge or vertex)
  /// or meet in a way corefinement cannot resolve, so the operand named was moved. "touches itself": sheets
  /// of a result share a point, which has a vertex for each of them. "meets itself": an operand's triangles
  /// intersect near the cut, usually by the rounding of an earlier one. "film": shells thinner than the
  /// rounding of points were left out. "without area": such triangles of an operand were cut along another
  /// diagonal, which leaves its surface where it is.
  std::vector<std::string> findings;
};

/// As boolean(), which see, for several results at the price of one. Only wanted results decide whether it
/// throws or resorts to the shift.
Booleans booleans(const Solid& a, const Solid& b, const BooleansWanted& wanted = {},
                  const std::stop_token& stop = {});

}  // namespace octotomy::brep
