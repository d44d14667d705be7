// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "brep/io/read_mesh.h"
#include "planner/operation/table/json.h"

// Reads the meshes that the command line of a run names, and collects findings on them.
namespace octotomy::planner {

/// A mesh file that was read, with its audit.
struct MeshRecord {
  std::filesystem::path path;
  std::vector<brep::MeshFinding> audit;
};

/// Chooses frames and units for the meshes of this process, each as "RAS" or, for one file, as
/// "box.stl=RAS". Clears the lists of files read so far. Throws std::runtime_error if a word names no frame
/// or no unit.
void choose_mesh_reading(const std::vector<std::string>& frames, const std::vector<std::string>& units);

/// Reads a mesh as chosen and keeps its audit for meshes_read(); any thread may call. Throws as
/// brep::read_mesh().
brep::Triangles read_mesh_in(const std::filesystem::path& path);
/// Reads a mesh in the given frame and unit.
brep::Triangles read_mesh_in(const std::filesystem::path& path, const brep::MeshReadOptions& options);

/// The meshes read since the last choice, sorted by path, each path once.
std::vector<MeshRecord> meshes_read();

/// Choices such as "box.stl=RAS" whose file was never read.
std::vector<std::string> unused_choices();

/// Records an assumption about a file of landmarks for landmark_files_read(); any thread may call.
void keep_landmark_audit(const std::filesystem::path& path, std::vector<brep::MeshFinding> audit);
/// The files of landmarks read since the last choice for which something was assumed, sorted by path.
std::vector<MeshRecord> landmark_files_read();

/// The audit as a list of check, verdict and detail.
Json to_json(const std::vector<brep::MeshFinding>& audit);

/// The audit's warnings, one line a finding: "frame: the file names no frame".
std::vector<std::string> warnings_of(const std::vector<brep::MeshFinding>& audit);

}  // namespace octotomy::planner
