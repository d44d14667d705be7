// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/io/write_mesh.h"
#include "brep/mesh/solid.h"
#include "planner/file/file_kind.h"
#include "planner/table/stopwatch.h"

namespace octotomy::planner {

/// A mesh file's solid, proven by its health; "read" in the timings. Throws as brep::read_triangles() and
/// brep::solid_of(), naming the path.
brep::Solid read_solid(const std::filesystem::path& path, Timings& timings);

/// A mesh that need not be closed; "read" in the timings. Throws std::runtime_error where its triangles
/// cannot be joined.
brep::Mesh read_surface(const std::filesystem::path& path, Timings& timings);

/// Writes a mesh by brep::write_mesh() and replaces what `out` means, as voxel::StagedFiles; "write" in the
/// timings.
void write_surface(const brep::Mesh& mesh, const std::filesystem::path& out, Timings& timings,
                   const brep::VertexData& data = {});

}  // namespace octotomy::planner
