// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/triangles.h"
#include "voxel/scene.h"

namespace octotomy::convert {

/// The surface where the scan's own samples, interpolated linearly along the lattice's edges, enter the
/// window low..high. What is inside the window reaches the scan's border is closed there, half a voxel beyond
/// the outermost samples. Closed, oriented outward in LPS millimetres whatever the lattice's handedness, and
/// manifold: each edge of a lattice cell is crossed by at most one vertex, and ambiguous faces always keep
/// the inside corners apart. Crossings keep a small distance from samples (see the source), so no triangle is
/// degenerate. Empty where nothing is inside. Parallel; same bits on any thread count. Source: Lorensen,
/// Cline 1987; tables derived by following the loops of each of the 256 cases.
brep::Triangles isosurface(const voxel::Scene& scene, double low, double high);

}  // namespace octotomy::convert
