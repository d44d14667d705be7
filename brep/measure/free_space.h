// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/solid.h"

namespace octotomy::brep {

/// The free space around a solid: the solid's box enlarged by `margin_mm` on each side, minus the solid.
/// Where the solid has a gap or a hole, the free space is as thin as the gap, so its wall thickness there is
/// the width of the gap. Cavities of the solid belong to the free space. Its proof is proof_of_part() of the
/// solid's, because the box touches nothing. Throws std::invalid_argument if the solid is empty or the margin
/// is not above 0. Cost: linear in the triangles.
Solid free_space(const Solid& solid, double margin_mm);

}  // namespace octotomy::brep
