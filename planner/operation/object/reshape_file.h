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

/// The fields that an operation on one surface has only for its verb.
struct ReshapeFile {
  std::filesystem::path mesh, out;
  std::optional<double> voxel_mm;
  bool mend = false;
};

/// Computes the changed surface of a mesh, which may be open. Adds to the details and findings of the answer.
using Reshape =
    std::function<brep::Mesh(const brep::Mesh& mesh, Json& details, std::vector<std::string>& findings)>;

/// Runs the verb of an operation on one surface: reads the mesh, changes it, and writes it, or for an .octree
/// the voxels inside it. The change has the name `doing` in the timings. An open surface stays open in a mesh
/// file, with a finding. Throws std::runtime_error if the file contains voxels, or if the surface is open and
/// an .octree is requested; as read_solid() for other defects; and as `reshape`.
FileAnswer reshaped_file(const ReshapeFile& asked, const FileBench& bench, const std::string& doing,
                         const Reshape& reshape);

}  // namespace octotomy::planner
