// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "brep/contour/tile_sections.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

namespace octotomy::convert {

/// The contours of the window low..high on each slice along a scan's third axis, crossings by interpolation;
/// either bound may be infinite. In the scan's own millimetres: sample (i, j, k) lies at (i, j, k) times the
/// spacing. Objects are closed half a sample beyond the slice's border. Samples that are not numbers are
/// outside. Throws std::invalid_argument if the scene fails check() or a bound is not a number;
/// voxel::Stopped. Parallel. Cost: linear.
std::vector<brep::Section> trace_contours(const voxel::Scene& scene, double low, double high,
                                          const voxel::Progress& progress = {});

/// The surface tiled from those contours, in LPS millimetres, outward for either handedness of the lattice.
/// Independent of isosurface(): uses no cells between slices, and closes an end half way to the next slice.
/// Throws as trace_contours() and brep::tile_sections().
brep::TiledSections contour_surface(const voxel::Scene& scene, double low, double high,
                                    const brep::TileSectionsOptions& options = {},
                                    const voxel::Progress& progress = {});

}  // namespace octotomy::convert
