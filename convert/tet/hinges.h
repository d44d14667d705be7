// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "convert/tet/tetrahedra.h"

namespace octotomy::convert {

/// A finding on parts of a filling that are connected by edges or nodes alone, like two voxels that share an
/// edge: in the solver such parts turn about that edge or node as about a hinge, or the stiffness is
/// singular. None if all elements that share a node are also connected by faces. Parts that share no node are
/// separate bodies and not reported. Cost: n log n.
std::optional<std::string> hinge_in(const Tetrahedra& tetrahedra);

}  // namespace octotomy::convert
