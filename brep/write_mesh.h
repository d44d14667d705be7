// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "brep/mesh.h"

namespace octotomy::brep {

/// Writes .stl (binary; points in single precision), .ply (binary little-endian, double), .obj or .off (text
/// that reads back to the same doubles) as the extension says; LPS millimetres. Written beside and renamed
/// into place, so that a reader sees the old file or the whole new one. Precondition: nothing is marked as
/// deleted. Throws std::runtime_error with path and reason; what was there before stays.
void write_mesh(const Mesh& mesh, const std::filesystem::path& path);

}  // namespace octotomy::brep
