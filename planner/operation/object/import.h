// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "planner/operation/table/operation.h"
#include "voxel/space/lattice.h"

namespace octotomy::planner {

/// Whether the step is an import, which makes an object from a mesh file alone.
bool is_import(const Action& action);

/// The bounding box of an import's mesh, LPS mm. Relative paths are relative to `folder`. Reads the file and
/// throws as brep::read_mesh(). Precondition: is_import().
voxel::Box import_box(const Action& action, const std::filesystem::path& folder);

}  // namespace octotomy::planner
