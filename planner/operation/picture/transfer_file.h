// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "voxel/view/transfer.h"

namespace octotomy::planner {

/// Reads a transfer function from a JSON file, samples ascending:
///   { "octotomy_transfer": 1, "surface_per_mm": 50, "points": [
///       { "sample": 180, "colour": "#cc8c6b", "per_mm": 0 },
///       { "sample": 320, "colour": "#f0e3c7", "per_mm": 0.5 } ] }
/// surface_per_mm may be left out. Throws std::runtime_error with path, place and fault; unknown keys
/// are refused with the nearest known one.
voxel::TransferFunction read_transfer(const std::filesystem::path& path);

}  // namespace octotomy::planner
