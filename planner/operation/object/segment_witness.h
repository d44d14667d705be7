// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/operation/object/segment.h"
#include "verify/witness/reading.h"

namespace octotomy::planner {

/// The witness of an object whose samples were selected one by one: grown from seeds, parts of a window at
/// seeds, or a class by density and gradient. Empty for other objects, and for objects with further choices
/// of voxels. Also empty for grown objects whose voxels are not the scan's samples, because resampling then
/// determines which parts are connected.
verify::Witness witness_of_samples(const Segment& segment, const LoadedScan& scan, bool voxels_are_samples);

}  // namespace octotomy::planner
