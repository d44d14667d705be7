// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/triangles.h"
#include "voxel/grey_octree.h"
#include "voxel/scene.h"

namespace octotomy::convert {

/// The surface where the scan's own samples, interpolated linearly along the lattice's edges, enter the
/// window low..high, both included. In LPS millimetres; the bounds may be infinite.
///
/// Closed, manifold, and oriented outward whatever the lattice's handedness, for any samples, noise included:
/// ambiguous faces of cells keep the inside corners apart. Vertices keep a thousandth of an edge's distance
/// from samples, so no triangle is degenerate. Where an object reaches the scan's border it is closed half a
/// voxel beyond the outermost samples, at the voxels' ends. Samples that are no numbers are outside. Where
/// neighbouring samples lie below and above the window, what lies between them is not seen. Empty where
/// nothing is inside.
///
/// On a sphere of r voxels of partial-volume samples the volume is 0.82 / r^2 of it low: 0.6 because
/// triangles are chords, the rest because the mean of a voxel is not its centre's value. The area is 0.4 %
/// high at every resolution, by ripple, less 0.3 / r^2.
///
/// Throws std::invalid_argument where the scene is not whole or a bound is not a number, std::length_error
/// where 32 bits do not number the triangles. Parallel; same bits on any thread count. Cost: two passes over
/// a bit a sample, one over the samples; memory one bit a sample beside the surface. Source: Lorensen, Cline
/// 1987; tables derived by following the loops of each of the 256 cases.
brep::Triangles isosurface(const voxel::Scene& scene, double low, double high);

/// The same of a grey octree's samples: the same bits as of a scene of them. Blocks wholly in or out of the
/// window are not opened. Where the window holds the background, the surface closes at the universe's border.
brep::Triangles isosurface(const voxel::GreyOctree& grey, double low, double high);

}  // namespace octotomy::convert
