// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "convert/tet/tetrahedra.h"

namespace octotomy::convert {

/// Where parts of a filling hang together by edges or nodes alone, as voxels do that share an edge: the solver
/// lets them turn there as on a hinge, or ends with a singular stiffness. None where elements that share a node
/// are linked by faces. Parts that share no node are separate bodies and not reported. Cost: n log n.
std::optional<std::string> hinge_in(const Tetrahedra& tetrahedra);

}  // namespace octotomy::convert
