// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "planner/operation/table/operation.h"
#include "voxel/space/lattice.h"

namespace octotomy::planner {

/// Whether the step tiles contours, which makes an object without a scan.
bool is_tile(const Action& action);

/// A box around the object, LPS mm. Relative paths are relative to `folder`. If the step names a file of
/// contours, reads it and throws as its reader. Precondition: is_tile().
voxel::Box tile_box(const Action& action, const std::filesystem::path& folder);

}  // namespace octotomy::planner
