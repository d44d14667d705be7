// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "planner/operation/table/operation.h"
#include "voxel/space/lattice.h"

namespace octotomy::planner {

/// Whether the action tiles contours, which makes an object without a scan.
bool is_tile(const Action& action);

/// A box that holds the object, LPS mm; relative paths are relative to `folder`. Reads the file of contours if there
/// is one, and throws as its reader. Precondition: is_tile().
voxel::Box tile_box(const Action& action, const std::filesystem::path& folder);

}  // namespace octotomy::planner
