// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "brep/mesh.h"

namespace octotomy::brep {

/// Writes .stl (binary), .ply (binary, double), .obj or .off as the extension says; LPS millimetres. Written
/// beside and renamed into place. Throws std::runtime_error with path and reason.
void write_mesh(const Mesh& mesh, const std::filesystem::path& path);

}  // namespace octotomy::brep
