// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "brep/io/mesh_audit.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Facts from the caller that override the file's statements.
struct MeshReadOptions {
  std::optional<std::string> frame;  ///< a name for frame_named(): "RAS"
  std::optional<std::string> unit;   ///< a word for length_unit(): "inch"
};

/// A mesh file's triangles in LPS millimetres, and findings about its frame, unit, program, size and
/// polygons.
struct MeshFile {
  Triangles triangles;
  std::vector<MeshFinding> audit;

  /// The extent of the points; zero if there are none.
  Extent extent() const;
};

/// Extensions of files that read_mesh() reads, for messages: ".stl, .ply, ... or .dcm".
extern const char* const mesh_formats_read;
/// Whether read_mesh() reads files with the path's extension. For .dcm, and for files without an extension,
/// whether the file holds a surface.
bool is_mesh_file(const std::filesystem::path& path);

/// Reads a surface:
/// - .stl, binary and ASCII; equal points welded;
/// - .ply, ASCII and both binary orders; .obj; .off, also binary;
/// - .vtk, legacy polydata and unstructured grids, ASCII and binary, versions to 5.1;
/// - .vtp and .vtu, XML: text, base64 or appended, plain or compressed by zlib or LZ4;
/// - .glb, binary glTF 2.0: the triangles of the scene's nodes, transformed; equal points welded;
/// - .3mf: the objects of the build, transformed;
/// - .dcm: STL or OBJ that is encapsulated in DICOM, with the unit of its header.
/// PLY, OBJ and VTK files repeat points at which normals, colours or textures differ. Such points are merged
/// if that closes open sides and leaves every edge with two triangles (weld_seams.h); points of OFF and 3MF
/// are not merged. Triangles that repeat a corner are left out. The audit reports both. For an unstructured
/// grid with volume cells, the result is the surface around these. Larger polygons and strips are
/// triangulated (polygons.h); colours, normals, textures, lines and loose points are ignored. Frame and unit
/// are those of the options, else those stated by the file (mesh_statements.h; glTF has metres with y up and
/// z to the front, 3MF names its unit), else LPS millimetres are assumed. The audit reports which.
/// Coordinates beyond 1.2e19 mm are refused. Throws Error (Input) with path, place and reason; never
/// allocates more than a fixed multiple of the triangles that fit into the file's size.
MeshFile read_mesh(const std::filesystem::path& path, const MeshReadOptions& options = {});

/// The triangles of read_mesh() alone.
Triangles read_triangles(const std::filesystem::path& path, const MeshReadOptions& options = {});

}  // namespace octotomy::brep
