// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/triangles.h"
#include "convert/surface/surface_extraction.h"
#include "voxel/space/lattice.h"
#include "voxel/space/progress.h"

namespace octotomy::convert {

/// For each sample, on which sides of a window's two bounds it lies. Samples that were not measured count as below
/// the window.
struct WindowBits {
  InsideBits measured;    ///< samples that are numbers and no padding
  InsideBits from_low;    ///< not below the window
  InsideBits above_high;  ///< above the window; a part of `from_low`
};

/// The closed surface of the region between two levels of a lattice's samples, in LPS millimetres, oriented
/// outward: the surface of the lower level, and that of the upper one inside out. The two neither cross nor
/// touch. A cell with a sample that was not measured has the surface that separates samples in the window
/// from all others; there, regions that pass through the window between two samples end at the outermost
/// samples.
///
/// `low` and `high` write where edges cross the lower and the upper level. Precondition: where both cross
/// an edge, the crossings are apart, in order, and keep a part of the edge above 2^-11 from its ends and
/// from each other. Throws and guarantees as extract_surface().
brep::Triangles window_surface(const voxel::Lattice& lattice, const WindowBits& bits, const Crossings& low,
                               const Crossings& high, const voxel::Progress& progress = {});

}  // namespace octotomy::convert
