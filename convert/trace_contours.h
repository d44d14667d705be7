// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "brep/tile_sections.h"
#include "voxel/scene.h"

namespace octotomy::convert {

/// The contours of the window low..high on each of a scan's slices along its third axis, crossings placed by
/// interpolation; either bound may be infinite. In the scan's own millimetres: the sample of index (i, j, k)
/// stands at (i, j, k) times the spacing. Objects are closed half a sample beyond the slice's border; samples
/// that are no numbers are outside. Throws std::invalid_argument where the scene is not whole or a bound is
/// not a number. Parallel. Cost: linear.
std::vector<brep::Section> trace_contours(const voxel::Scene& scene, double low, double high);

/// The surface tiled from them, in LPS millimetres, outward whatever the lattice's handedness. Throws as
/// brep::tile_sections() does. Of separate lineage from isosurface(): it knows no cells between slices, and
/// closes an end half way to the next slice.
brep::TiledSections contour_surface(const voxel::Scene& scene, double low, double high,
                                    const brep::TileSectionsOptions& options = {});

}  // namespace octotomy::convert
