// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/operation/object/mask.h"
#include "planner/operation/table/bench.h"

namespace octotomy::planner {

/// Writes a mask from files of regions as an octree, around the regions or on another file's voxels.
FileAnswer mask_file(const Mask& asked, const FileBench& bench);

}  // namespace octotomy::planner
