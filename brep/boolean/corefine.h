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

/// The four results of two surfaces that cut each other, and where each stands in a list of them.
enum ResultPlace { of_union, of_intersection, of_a_minus_b, of_b_minus_a };
using Results = std::array<std::optional<Triangles>, 4>;
using Wanted = std::array<bool, 4>;

struct BooleanStopped : Stopped {
  BooleanStopped() : Stopped("the Boolean was stopped") {}
};

struct Corefined {
  Results results;  ///< those wanted that are manifold, in order of their coordinates
  /// Closed shells thinner than the rounding of points, left out: what remains between faces that would
  /// coincide but for their last places.
  std::array<std::size_t, 4> films{};
  bool has_open_film = false;  ///< a part that thin ends at a border, so that it is not known for a film
  /// A point of each part of the operands that is connected across edges and has no edge on the cut, though
  /// its triangles may touch the other surface: such parts count as outside where the other surface is open.
  /// Points are numbered as in the operand if `flat` is 0.
  std::array<std::vector<std::uint32_t>, 2> uncut;
  /// Triangles of the operands without area that another diagonal took out, see flat_triangles.h.
  std::size_t flat = 0;
  bool meets_itself = false;  ///< an operand's triangles intersect near the cut; the results are a guess
  std::string failure;        ///< why there are none; empty where there was none
};

/// Cuts both surfaces along their common lines and puts the parts together. Either may be open, a part of a
/// solid's surface, as long as its border does not meet the other; parts of results end at such borders then.
/// Points come in an order that does not hang on addresses, as those of CGAL's do. The only unit that sees
/// corefinement, which is dear to compile. Throws BooleanStopped where asked to stop, at one of its next
/// steps along the surface. Cost: n log n, about 2 us a triangle. Source: CGAL's Polygon Mesh Processing,
/// corefinement (Loriot et al.), EPICK predicates.
Corefined corefine(const Mesh& a, const Mesh& b, const Wanted& wanted, const std::stop_token& stop = {});

}  // namespace octotomy::brep
