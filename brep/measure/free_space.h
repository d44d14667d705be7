// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/solid.h"

namespace octotomy::brep {

/// The free space around a solid: a box that exceeds the solid's by `margin_mm`, without the solid. The walls
/// of the free space are the solid's gaps and holes. Cavities of the solid belong to the free space. Has the
/// solid's proof, because the box touches nothing. Throws std::invalid_argument if the solid is empty or the
/// margin is not above 0. Cost: linear.
Solid free_space(const Solid& solid, double margin_mm);

}  // namespace octotomy::brep
