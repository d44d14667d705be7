// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "brep/mesh/solid.h"
#include "planner/operation/table/bench.h"
#include "planner/operation/table/json.h"

namespace octotomy::planner {

/// The fields that an operation on one surface has only as a verb.
struct ReshapeFile {
  std::filesystem::path mesh, out;
  std::optional<double> voxel_mm;
  bool mend = false;
};

/// The changed surface of a mesh that may be open; adds to the answer's details and findings.
using Reshape =
    std::function<brep::Mesh(const brep::Mesh& mesh, Json& details, std::vector<std::string>& findings)>;

/// Runs the verb: reads the mesh, changes it, and writes it, or for an .octree the voxels inside it. The change is
/// `doing` in the timings. A surface that is open stays so in a mesh file, with a finding. Throws std::runtime_error
/// where the file holds voxels, or the surface is open and an .octree is wanted; as read_solid() for other defects,
/// and as `reshape`.
FileAnswer reshaped_file(const ReshapeFile& asked, const FileBench& bench, const std::string& doing,
                         const Reshape& reshape);

}  // namespace octotomy::planner
