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
  InsideBits above_high;  ///< above the window; a subset of `from_low`
};

/// The closed surface of the region between two levels of a lattice's samples, in LPS millimetres, oriented
/// outward: the surface of the lower level, and the surface of the upper level turned inside out. The two
/// neither cross nor touch. In a cell with a sample that was not measured, the surface separates samples in
/// the window from all others; there, a layer that passes through the window between two samples ends at the
/// outermost samples.
///
/// `low` and `high` write where edges cross the lower and the upper level. Precondition: where both cross an
/// edge, the crossings are in order, and more than 2^-11 of the edge apart and away from its ends. Throws and
/// guarantees as extract_surface().
brep::Triangles window_surface(const voxel::Lattice& lattice, const WindowBits& bits, const Crossings& low,
                               const Crossings& high, const voxel::Progress& progress = {});

}  // namespace octotomy::convert
