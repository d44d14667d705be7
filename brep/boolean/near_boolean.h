// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "brep/boolean/corefine.h"
#include "brep/boolean/line_agreement.h"
#include "brep/mesh/solid.h"

namespace octotomy::brep {

struct NearBoolean {
  Results results;  ///< those wanted, closed; none of them where `obstacle` says why
  /// Of those, and for witness of all others that are manifold.
  std::array<std::optional<double>, 4> volumes_mm3;
  /// Of each far part of the operands and each shell of the near results the triangle that is widest along x.
  std::vector<Corners> widest;
  std::size_t flat = 0;       ///< see Corefined
  bool meets_itself = false;  ///< see Corefined
  std::string obstacle;
};

/// The Booleans of two solids with work for few triangles beyond those that meet: those are cut out,
/// corefined as open surfaces and sewn back along borders that nothing has touched, point by point; what is
/// left falls into parts wholly inside or outside, which the borders tell and a ray confirms. A wanted
/// result's volume is that of its triangles; a witness's is the near triangles' and the parts'. Gives up,
/// with the reason, where that is no gain or not certain: more than half of the triangles are near, the
/// surfaces only touch, faces all but coincide, a result is not manifold, or border, ray and seam disagree.
/// Cost: linear in all triangles, some 0.2 us each, and corefine()'s for the near ones.
NearBoolean near_boolean(const Solid& a, const Solid& b, const Wanted& wanted,
                         const std::stop_token& stop = {});

}  // namespace octotomy::brep
