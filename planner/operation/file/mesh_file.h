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

/// A mesh file's solid, proven by its health; "read" in the timings. Throws as brep::read_triangles() and
/// brep::solid_of(), naming the path.
brep::Solid read_solid(const std::filesystem::path& path, Timings& timings);

/// As read_solid(), but repairs triangles that are no solid by brep::repair(). A finding states the volume
/// and the largest distance. "repair" in the timings. Throws as repair(), naming the path.
brep::Solid read_mended_solid(const std::filesystem::path& path, Timings& timings,
                              std::vector<std::string>& findings, const brep::Progress& progress = {});

/// As read_solid(), but turns triangles that face the wrong way: neighbours alike, shells outward, cavities
/// inward. No point moves. A finding counts the turned triangles.
brep::Solid read_turned_solid(const std::filesystem::path& path, Timings& timings,
                              std::vector<std::string>& findings);

/// A mesh of any triangles with finite points, closed or not, joined as brep::joined_surface() does; "read"
/// in the timings. The changes made by joining are appended to `findings` unless it is null. Throws
/// std::runtime_error, naming the path.
brep::Mesh read_surface(const std::filesystem::path& path, Timings& timings,
                        std::vector<std::string>* findings = nullptr);

/// Reads the surfaces of two files at once, as triangles with their neighbours.
std::array<brep::Linked, 2> read_surfaces(const std::array<std::filesystem::path, 2>& paths, Timings& timings,
                                          std::vector<std::string>& findings);

/// The finding that a file written from a solid no longer holds a solid: .stl rounds points to single
/// precision, which can make thin triangles cross. None for other formats. Precondition: a solid was written.
/// Throws as brep::read_mesh(). Cost: reading the file, and brep::health().
std::optional<std::string> rounding_finding(const std::filesystem::path& written, Timings& timings);

/// Writes a mesh by brep::write_mesh() and replaces the file `out`, as voxel::StagedFiles does; "write" in
/// the timings.
void write_surface(const brep::Mesh& mesh, const std::filesystem::path& out, Timings& timings,
                   const brep::VertexData& data = {});
void write_surface(const brep::Triangles& triangles, const std::filesystem::path& out, Timings& timings,
                   const brep::VertexData& data = {});

}  // namespace octotomy::planner
