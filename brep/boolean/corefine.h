// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <stop_token>
#include <string>

#include "brep/mesh/error.h"
#include "brep/mesh/mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// The four results of two surfaces that cut each other, as indices into Results.
enum ResultPlace { of_union, of_intersection, of_a_minus_b, of_b_minus_a };
using Results = std::array<std::optional<Triangles>, 4>;
using Wanted = std::array<bool, 4>;

struct BooleanStopped : Stopped {
  BooleanStopped() : Stopped("the Boolean was stopped") {}
};

struct Corefined {
  Results results;  ///< the wanted results that are manifold, with points in coordinate order
  /// Number of closed shells that were left out because they are thinner than the rounding of points. They
  /// lie between faces that would coincide without rounding.
  std::array<std::size_t, 4> films{};
  bool has_open_film = false;  ///< an equally thin part ends at a border, so it may or may not be a film
  /// One point of each part of the operands that has no edge on the cut; parts are connected across edges.
  /// Such a part may touch the other surface. It counts as outside if the other surface is open. Points are
  /// numbered as in the operand if `flat` is 0.
  std::array<std::vector<std::uint32_t>, 2> uncut;
  /// Number of the operands' triangles without area that were removed by another diagonal, see
  /// flat_triangles.h.
  std::size_t flat = 0;
  bool meets_itself = false;  ///< an operand's triangles intersect near the cut; the results are a guess
  std::string failure;        ///< why there are no results; empty on success
};

/// Cuts both surfaces along their common lines and puts the parts together. Either may be open (a part of a
/// solid's surface) if its border does not meet the other; parts of results then end at such borders. The
/// order of points does not depend on addresses, unlike CGAL's. Only this unit includes CGAL's corefinement,
/// which is slow to compile. Throws BooleanStopped soon after a stop is requested, at a step along the
/// surface. Cost: n log n, about 2 us a triangle. Source: CGAL's Polygon Mesh Processing, corefinement
/// (Loriot et al.), EPICK predicates.
Corefined corefine(const Mesh& a, const Mesh& b, const Wanted& wanted, const std::stop_token& stop = {});

}  // namespace octotomy::brep
