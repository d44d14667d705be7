// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "brep/triangles.h"

namespace octotomy::brep {

/// Reads triangles from STL (binary, ASCII; equal points welded), PLY, OBJ, OFF, legacy VTK polydata. Larger
/// polygons are split into fans. Throws std::runtime_error with path and reason; never allocates beyond what
/// the file's size can hold.
Triangles read_triangles(const std::filesystem::path& path);

}  // namespace octotomy::brep
