// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Reads triangles from .stl (binary, ASCII; equal points welded), .ply (ASCII, both binary orders), .obj,
/// .off (ASCII), .vtk (legacy polydata, ASCII and binary, versions to 5.1) or .vtp (XML polydata; text,
/// base64 or appended, plain or packed by zlib). Larger polygons are split into fans from their first corner,
/// strips into triangles; colours, normals, textures, lines and loose points are passed over. Coordinates are
/// taken as LPS millimetres: no such format says its frame or unit; those beyond 1.2e19 are refused. Throws
/// Error (Input) with path, place and reason; never allocates beyond what the file's size can hold.
Triangles read_triangles(const std::filesystem::path& path);

}  // namespace octotomy::brep
