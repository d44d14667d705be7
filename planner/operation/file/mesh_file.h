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

/// The same, but triangles that are no solid are made one by brep::repair(), as a finding says with the
/// volume and the largest distance; "repair" in the timings. Throws as repair(), naming the path.
brep::Solid read_mended_solid(const std::filesystem::path& path, Timings& timings,
                              std::vector<std::string>& findings, const brep::Progress& progress = {});

/// As read_solid(), with triangles that face the wrong way turned: neighbours alike, shells outward, cavities
/// inward; nothing moves. A finding counts them.
brep::Solid read_turned_solid(const std::filesystem::path& path, Timings& timings,
                              std::vector<std::string>& findings);

/// A mesh of any triangles with finite points, closed or not, joined as brep::joined_surface() does; "read"
/// in the timings. What was done to join them is appended to the findings, if there are any. Throws
/// std::runtime_error, naming the path.
brep::Mesh read_surface(const std::filesystem::path& path, Timings& timings,
                        std::vector<std::string>* findings = nullptr);

/// The same of two files at once, as triangles with their neighbours.
std::array<brep::Linked, 2> read_surfaces(const std::array<std::filesystem::path, 2>& paths, Timings& timings,
                                          std::vector<std::string>& findings);

/// The finding that a solid is none any more in the file to which it was written: .stl rounds points to single
/// precision, by which thin triangles cross. None for other formats. Precondition: what was written is a solid.
/// Throws as brep::read_mesh(). Cost: reading the file, and brep::health().
std::optional<std::string> rounding_finding(const std::filesystem::path& written, Timings& timings);

/// Writes a mesh by brep::write_mesh() and replaces what `out` means, as voxel::StagedFiles; "write" in the
/// timings.
void write_surface(const brep::Mesh& mesh, const std::filesystem::path& out, Timings& timings,
                   const brep::VertexData& data = {});
void write_surface(const brep::Triangles& triangles, const std::filesystem::path& out, Timings& timings,
                   const brep::VertexData& data = {});

}  // namespace octotomy::planner
