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

// A verb that makes a file and a plan's step that makes the same file from earlier objects share one
// function. FileBench::step distinguishes them: names are paths of files, or objects of the plan.
namespace octotomy::planner {

/// Whether a name refers to an octree: an .octree file, or any object of the plan.
bool names_octree(const std::string& name, const FileBench& bench);
/// The octree with a name; "read" in the timings. Throws as read_timed().
voxel::OctreeFile octree_named(const std::string& name, const FileBench& bench);
/// The triangles that a name stands for: a mesh file's triangles, or the triangles of an object's mesh within
/// the universe. Throws as read_mesh_in(), and std::runtime_error if the object has no mesh.
brep::Triangles triangles_named(const std::string& name, const FileBench& bench);

/// Writes a step's file by a verb's function `run`. `object` is the first object that it uses, empty if it uses a
/// scan; `path` is the file within the result's folder. Scans are those of the plan. If `run` has no answer, the
/// reason becomes a finding, and no file is written.
void write_by_verb(const std::string& object, const std::filesystem::path& path,
                   const std::function<FileAnswer(const FileBench& bench)>& run, const AnswerBench& bench,
                   Exported& made);

/// Runs `on_files` as the `write` of an operation whose value has its objects in `Value::inputs()` and its
/// output in `Value::out`.
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
