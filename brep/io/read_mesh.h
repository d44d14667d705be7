// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "brep/io/mesh_audit.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// What is known better than the file says it.
struct MeshReadOptions {
  std::optional<std::string> frame;  ///< of frame_named(): "RAS"
  std::optional<std::string> unit;   ///< of length_unit(): "inch"
};

/// A mesh file's triangles, LPS millimetres, and what was found about its frame, unit, program, size and
/// polygons.
struct MeshFile {
  Triangles triangles;
  std::vector<MeshFinding> audit;

  /// Around the points; zero where there are none.
  Extent extent() const;
};

/// Extensions of files that read_mesh() reads, for people: ".stl, .ply, ... or .3mf".
extern const char* const mesh_formats_read;
/// Whether read_mesh() reads files with the path's extension.
bool is_mesh_file(const std::filesystem::path& path);

/// Reads a surface:
/// - .stl, binary and ASCII; equal points welded;
/// - .ply, ASCII and both binary orders; .obj; .off, also binary;
/// - .vtk, legacy polydata and unstructured grids, ASCII and binary, versions to 5.1;
/// - .vtp and .vtu, XML: text, base64 or appended, plain or packed by zlib or LZ4;
/// - .glb, binary glTF 2.0: the triangles of the scene's nodes in their places; equal points welded;
/// - .3mf: the objects of the build in their places.
/// Points that PLY, OBJ and VTK's files repeat, because normals, colours or textures differ there, become one
/// where that closes open sides and leaves every edge with two triangles (weld_seams.h); OFF's and 3MF's stay
/// as they are. Triangles that repeat a corner are left out. The audit says both.
/// Of an unstructured grid with volume cells it is the surface around those. Larger polygons are triangulated
/// (polygons.h), strips too; colours, normals, textures, lines and loose points are passed over.
/// Frame and unit are what the options give, else what the file says (mesh_statements.h; glTF is metres with
/// y up and z to the front, 3MF names its unit), else LPS millimetres by assumption: the audit says which of
/// these. Coordinates beyond 1.2e19 mm are refused. Throws Error (Input) with path, place and reason; never
/// allocates beyond a fixed multiple of what the file's size can hold.
MeshFile read_mesh(const std::filesystem::path& path, const MeshReadOptions& options = {});

/// The triangles alone.
Triangles read_triangles(const std::filesystem::path& path, const MeshReadOptions& options = {});

}  // namespace octotomy::brep
