// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "brep/io/write_mesh.h"
#include "brep/mesh/progress.h"
#include "brep/mesh/solid.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/table/stopwatch.h"

namespace octotomy::planner {

/// Reads a mesh file as a solid, which its health proves. Adds "read" to the timings. Throws as
/// brep::read_triangles() and brep::solid_of(), naming the path.
brep::Solid read_solid(const std::filesystem::path& path, Timings& timings);

/// Reads a solid as read_solid() does, but repairs triangles that are not a solid by brep::repair(). A
/// finding states the volumes before and after and the largest distance between the surfaces. Adds "read" and
/// "repair" to the timings. Throws as repair(), naming the path.
brep::Solid read_mended_solid(const std::filesystem::path& path, Timings& timings,
                              std::vector<std::string>& findings, const brep::Progress& progress = {});

/// Reads a solid as read_solid() does, but turns triangles that face the wrong way: neighbours alike, outer
/// shells outward, cavities inward. No point moves. A finding counts the turned triangles.
brep::Solid read_turned_solid(const std::filesystem::path& path, Timings& timings,
                              std::vector<std::string>& findings);

/// Reads a mesh of any triangles with finite points, closed or not, joined by brep::joined_surface(). Adds
/// "read" to the timings. Changes made by joining are appended to `findings` unless it is null. Throws
/// std::runtime_error, naming the path.
brep::Mesh read_surface(const std::filesystem::path& path, Timings& timings,
                        std::vector<std::string>* findings = nullptr);

/// Reads the surfaces of two files in parallel, as triangles with their neighbours. Changes made by joining
/// are appended to `findings`.
std::array<brep::Linked, 2> read_surfaces(const std::array<std::filesystem::path, 2>& paths, Timings& timings,
                                          std::vector<std::string>& findings);

/// A finding if a .stl file that was written from a solid no longer contains a solid, because single
/// precision can make thin triangles cross. None otherwise, and always none for other formats. Precondition:
/// a solid was written. Throws as brep::read_mesh(). Cost: reading the file, and brep::health().
std::optional<std::string> rounding_finding(const std::filesystem::path& written, Timings& timings);

/// Writes a mesh by brep::write_mesh() and then replaces the file `out`, as voxel::StagedFiles does. Adds
/// "write" to the timings.
void write_surface(const brep::Mesh& mesh, const std::filesystem::path& out, Timings& timings,
                   const brep::VertexData& data = {});
void write_surface(const brep::Triangles& triangles, const std::filesystem::path& out, Timings& timings,
                   const brep::VertexData& data = {});

}  // namespace octotomy::planner
