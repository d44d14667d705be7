// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "brep/mesh/triangles.h"
#include "planner/operation/file/output_path.h"
#include "planner/operation/table/bench.h"
#include "voxel/tree/octree_file.h"

// Lets a verb on files and a plan's step on objects share one function. FileBench::step is null for the verb,
// whose names are paths; for a step, names are objects of the plan.
namespace octotomy::planner {

/// Whether a name refers to an octree: in a verb an .octree file, in a plan any object.
bool names_octree(const std::string& name, const FileBench& bench);
/// The octree of a name. Adds "read" to the timings of a verb. Throws as read_timed().
voxel::OctreeFile octree_named(const std::string& name, const FileBench& bench);
/// The triangles of a name: of a mesh file, or of an object's mesh within the universe. Throws as
/// read_mesh_in(), and std::runtime_error if the object has no mesh.
brep::Triangles triangles_named(const std::string& name, const FileBench& bench);

/// Writes a step's file by `run`, the function of the verb. `object` is the first object that the step uses,
/// empty if it uses a scan; `path` is the file within the result's folder. Scans are those of the plan. If
/// `run` throws for bad input or impossible geometry, the reason becomes a finding and no file is written.
void write_by_verb(const std::string& object, const std::filesystem::path& path,
                   const std::function<FileAnswer(const FileBench& bench)>& run, const AnswerBench& bench,
                   Exported& made);

/// The `write` of an operation that calls its verb's function `on_files`. The objects are `Value::inputs()`,
/// the output is `Value::out`.
template <typename Value, FileAnswer (*on_files)(const Value&, const FileBench&)>
void write_step(const Value& asked, const AnswerBench& bench, Exported& made) {
  const std::vector<std::string> objects = asked.inputs();
  write_by_verb(
      objects.empty() ? "" : objects.front(), asked.out,
      [&](const FileBench& files) {
        Value there = asked;
        there.out = output_file(bench.folder, output_path(asked.out));
        return on_files(there, files);
      },
      bench, made);
}

}  // namespace octotomy::planner
