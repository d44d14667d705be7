// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/operation/object/mask.h"
#include "planner/operation/table/bench.h"

namespace octotomy::planner {

/// Makes a mask from files of regions and writes it as an octree. Its voxels are those of another file, or
/// cover the regions.
FileAnswer mask_file(const Mask& asked, const FileBench& bench);

}  // namespace octotomy::planner
