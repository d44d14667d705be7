// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/mesh.h"

namespace octotomy::brep {

struct SmoothOptions {
  int rounds = 10;         ///< rounds of one inward and one outward step, at least 1
  double pass_band = 0.1;  ///< waves below this are preserved, 0..1: 0.1 preserves those longer than about 10
                           ///< edges
  double max_volume_share = 0.01;  ///< largest share of the volume that may be gained or lost, above 0
};

/// Removes noise of the vertices by alternating inward and outward steps, which nearly preserve long waves
/// and thus the volume. Connection and orientation stay. A thin wall may intersect itself afterwards: check
/// with health(). Borders of an open mesh do not move. For an open mesh, the share refers to the volume of a
/// ball with the mesh's area, and the change is the volume between its triangles before and after.
/// Precondition: manifold. Throws std::invalid_argument where an option is out of its range, Error (Geometry)
/// with both volumes if the volume changes by more than the allowed share. Deterministic. Cost: rounds times
/// edges. Source: Taubin, "A signal processing approach to fair surface design", SIGGRAPH 1995, with equal
/// weights.
Mesh smooth(const Mesh& mesh, const SmoothOptions& options = {});

}  // namespace octotomy::brep
