// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/operation/object/mask.h"
#include "planner/operation/table/bench.h"

namespace octotomy::planner {

/// A mask of files of regions as an octree's file, around the regions or on another file's voxels.
FileAnswer mask_file(const Mask& asked, const FileBench& bench);

}  // namespace octotomy::planner
