// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/triangles.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"
#include "voxel/tree/grey_octree.h"

namespace octotomy::convert {

/// The surface on which the scan's own samples, interpolated linearly along the lattice's edges, enter or leave
/// the window low..high, both included. In LPS millimetres; the bounds may be infinite.
///
/// Closed, manifold, oriented outward and free of self-intersection for any samples, noise included, and any
/// handedness of the lattice: ambiguous faces of cells keep the inside corners apart. Vertices keep a
/// thousandth of an edge's distance from samples, so no triangle is degenerate. An object that reaches the
/// scan's border is closed half a voxel beyond the outermost samples, at the voxels' ends. Samples that are
/// not numbers, and the scene's padding, are outside; the surface closes half way to them. Empty if nothing is
/// inside.
///
/// If there are samples on both sides of the window, its surface consists of the lower bound's surface and
/// the upper bound's surface turned inside out. Between a sample below and one above, the object is the layer
/// that passes through the window, at least a thousandth of the edge thick; at the scan's border and at
/// padding the layer ends with the outermost samples. Between neighbours the volumes of adjoining windows add
/// up. If there are samples on one side only, the surface has the same bits as with the bound on that side
/// alone. The surface of a window of a single value encloses the samples of that value.
///
/// For partial-volume samples of a sphere with a radius of r voxels, the relative volume is too small by 0.82
/// / r^2: 0.6 / r^2 because triangles are chords, the rest because a voxel's mean is not its centre's value.
/// The area is too large by 0.4 % - 0.3 / r^2, because of ripple.
///
/// Throws std::invalid_argument if the scene fails check() or a bound is not a number; voxel::Error
/// (Resource) if there are more triangles than 32-bit numbers can name; voxel::Stopped. Parallel; same bits on any
/// thread count. Cost: two passes over a bit a sample, one over the samples; memory one bit a sample beside the
/// surface. If there are samples on both sides of the window, four times that, and memory of both surfaces twice.
/// Source: Lorensen, Cline 1987; tables derived by following the loops of each of the 256 cases.
brep::Triangles isosurface(const voxel::Scene& scene, double low, double high,
                           const voxel::Progress& progress = {});

/// The isosurface of a grey octree's samples: the same bits as of a scene with these samples. Skips blocks
/// that lie wholly in or out of the window. Samples beyond the scan are outside every window. If the window
/// contains the value of samples beyond the scan, or if there are samples on both sides of the window, the
/// surface closes half a voxel beyond the scan's outermost samples.
brep::Triangles isosurface(const voxel::GreyOctree& grey, double low, double high,
                           const voxel::Progress& progress = {});

/// Whether rounding to doubles leaves isosurfaces on a lattice free of self-intersection: no part of the
/// lattice may be farther from the origin than 2^16 times the least height of its cells. Rounding then moves
/// points by less than 2^-34 of a cell, while they keep 2^-10 of an edge's distance from samples. Every scan
/// of a patient fulfils this: one with voxels of 0.2 mm would have to lie 13 metres away to fail.
bool stays_apart(const voxel::Lattice& lattice);

}  // namespace octotomy::convert
