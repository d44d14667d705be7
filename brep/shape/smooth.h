// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/mesh.h"

namespace octotomy::brep {

struct SmoothOptions {
  int rounds = 10;         ///< each consists of a step in and a step out, at least 1
  double pass_band = 0.1;  ///< waves below it are preserved, 0..1: 0.1 preserves those longer than about 10
                           ///< edges
  double max_volume_share = 0.01;  ///< largest share of the volume that may be gained or lost, above 0
};

/// The mesh with its vertices' noise taken off by steps in and out again that leave long waves, and so the
/// volume, nearly as they were. Connection and orientation stay; a thin wall may come to intersect itself:
/// ask health(). Borders of an open mesh stay where they are, and the volume between its triangles and their
/// first place is held against the share of the volume of a ball of its area. Precondition: manifold. Throws
/// std::invalid_argument where an option is out of its range, Error (Geometry) with both volumes if the
/// volume changes by more than its share. Deterministic. Cost: rounds times edges.
/// Source: Taubin, "A signal processing approach to fair surface design", SIGGRAPH 1995, with equal weights.
Mesh smooth(const Mesh& mesh, const SmoothOptions& options = {});

}  // namespace octotomy::brep
