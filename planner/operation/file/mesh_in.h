// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "brep/io/read_mesh.h"
#include "planner/operation/table/json.h"

// Reads the meshes that the command line of a run names, and collects findings on them.
namespace octotomy::planner {

/// A file that was read, with the findings of its audit.
struct MeshRecord {
  std::filesystem::path path;
  std::vector<brep::MeshFinding> audit;
};

/// Sets the frames and units of mesh files for this process, each as "RAS" or, for one file, as
/// "box.stl=RAS". Clears the lists of files read so far. Throws std::runtime_error if a word names no frame
/// or no unit.
void choose_mesh_reading(const std::vector<std::string>& frames, const std::vector<std::string>& units);

/// Reads a mesh with the frame and unit chosen for it, and stores its audit for meshes_read(). Any thread may
/// call. Throws as brep::read_mesh().
brep::Triangles read_mesh_in(const std::filesystem::path& path);
/// Reads a mesh in the frame and unit of `options`, and stores its audit.
brep::Triangles read_mesh_in(const std::filesystem::path& path, const brep::MeshReadOptions& options);

/// The meshes read since the last choose_mesh_reading(), each path once, sorted by path.
std::vector<MeshRecord> meshes_read();

/// The choices for one file, such as "box.stl=RAS", whose file was never read.
std::vector<std::string> unused_choices();

/// Stores assumptions about a landmark file for landmark_files_read(). Any thread may call.
void keep_landmark_audit(const std::filesystem::path& path, std::vector<brep::MeshFinding> audit);
/// The landmark files read since the last choose_mesh_reading() about which something was assumed, sorted by
/// path.
std::vector<MeshRecord> landmark_files_read();

/// An audit as a JSON list of {check, verdict, detail}.
Json to_json(const std::vector<brep::MeshFinding>& audit);

/// The warnings of an audit, one text each, such as "frame: the file names no frame".
std::vector<std::string> warnings_of(const std::vector<brep::MeshFinding>& audit);

}  // namespace octotomy::planner
