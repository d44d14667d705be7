// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/tree/grey_octree.h"
#include "voxel/tree/window_bits.h"
#include "voxel/view/camera.h"
#include "voxel/view/visits.h"

namespace octotomy::voxel {

/// Visits of node tracing through a grey octree whose Partial nodes store nothing (thesis A.4.2): a node is opened unless
/// all its samples are equal. What the minimum and maximum at each node save is the difference from the visits that
/// render() counts with DrawnObject::counted_in_grey. Precondition: the axes are of the octree's universe, and the window
/// excludes the background.
Visits visits_without_ranges(const GreyOctree& grey, Window16 window, const AxisView& axes);

}  // namespace octotomy::voxel
