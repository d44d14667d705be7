// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "brep/boolean/corefine.h"
#include "brep/boolean/line_agreement.h"
#include "brep/mesh/solid.h"

namespace octotomy::brep {

struct NearBoolean {
  Results results;  ///< the wanted results, closed; none if `obstacle` states a reason
  /// Volumes of the wanted results and, as a check, of the other manifold ones.
  std::array<std::optional<double>, 4> volumes_mm3;
  /// Triangles through which to test lines, see line_agreement.h: of each far part of the operands and each
  /// shell of the near results, the one that is widest when projected along x.
  std::vector<Corners> widest;
  std::size_t flat = 0;       ///< see Corefined
  bool meets_itself = false;  ///< see Corefined
  std::string obstacle;
};

/// The Booleans of two solids, with little work for triangles that do not meet the other surface. Triangles
/// that meet it are cut out, corefined as open surfaces and joined again along their unchanged borders, point
/// by point. The remaining triangles form parts, each wholly inside or outside the other solid; the borders
/// decide which, and a ray confirms it. The volume of a wanted result is computed from its triangles; the
/// volume of a result that serves only as a check is computed from near triangles and parts. Returns no
/// results, with the reason in `obstacle`, if this method would be no faster or its answer uncertain: more
/// than half of the triangles are near, the surfaces only touch, faces nearly coincide, a result is not
/// manifold, or border, ray and seam disagree. Cost: linear in all triangles, about 0.2 us each, plus
/// corefine() for the near ones.
NearBoolean near_boolean(const Solid& a, const Solid& b, const Wanted& wanted,
                         const std::stop_token& stop = {});

}  // namespace octotomy::brep
