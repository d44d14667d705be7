// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "voxel/solid/region_mask.h"
#include "voxel/solid/slice_mask.h"

// Regions drawn elsewhere, as JSON files. Points are [u, v] in the view's millimetres.
namespace octotomy::planner {

/// {"polygons_mm": [[[u, v], ...], ...]}, or that list alone. Throws std::runtime_error saying file, place
/// and what is expected there.
voxel::Region read_region(const voxel::View& view, const std::filesystem::path& path);

/// {"view": "inferior", "between": "shape_based" or "nearest", "slices": [{"position_mm": p . look,
/// "polygons_mm": [...]}, ...]}; "between" may be left out. Slices are put in order. Throws as read_region(),
/// and what check(SliceMask) refuses.
voxel::SliceMask read_slices(const std::filesystem::path& path);

}  // namespace octotomy::planner
