// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/step_on_files.h"

#include <nlohmann/json.hpp>

#include "planner/operation/file/mesh_in.h"
#include "planner/operation/file/octree_in.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/table/fault.h"

namespace octotomy::planner {
namespace {

/// The text with paths in `folder` shortened to paths within it. A result is written to a temporary folder,
/// whose name must not appear in findings.
std::string within(std::string text, const std::filesystem::path& folder) {
  const std::string beginning = (folder / "").string();
  for (std::size_t at = 0; (at = text.find(beginning, at)) != std::string::npos;)
    text.erase(at, beginning.size());
  return text;
}

}  // namespace

bool names_octree(const std::string& name, const FileBench& bench) {
  return bench.step != nullptr || is_octree(name);
}

voxel::OctreeFile octree_named(const std::string& name, const FileBench& bench) {
  if (bench.step == nullptr) return read_timed(name, bench.timings);
  const Object& object = bench.step->objects.at(name);
  return {object.voxel.octree, object.id,
          nlohmann::ordered_json{{"made_by", std::string("octotomy ") + OCTOTOMY_VERSION},
                                 {"definition", object.definition}}
              .dump()};
}

brep::Triangles triangles_named(const std::string& name, const FileBench& bench) {
  if (bench.step == nullptr) return read_mesh_in(name);
  const Object& object = bench.step->objects.at(name);
  if (!object.mesh.within) throw std::runtime_error("'" + name + "' has no mesh, see its findings");
  return object.mesh.within->triangles();
}

void write_by_verb(const std::string& object, const std::filesystem::path& path,
                   const std::function<FileAnswer(const FileBench& bench)>& run, const AnswerBench& bench,
                   Exported& made) {
  made.object = object;
  made.path = output_path(path).generic_string();
  try {
    const auto samples = [&](const std::filesystem::path& scan, const voxel::SlicesFinal&) {
      return bench.samples(scan.string());
    };
    FileAnswer answer = run({bench.timings, bench.stop, bench.report, samples, &bench});
    for (std::string& finding : answer.findings)
      made.findings.push_back(within(std::move(finding), bench.folder));
    for (const char* key : {"octotomy", "timings_ms", "path", "findings"}) answer.json.erase(key);
    made.details = std::move(answer.json);
    for (const auto& [name, text] : answer.rows)
      if (name != "written") made.content += (made.content.empty() ? "" : ", ") + name + " " + text;
    made.written = true;
  } catch (const std::exception& error) {
    // Errors such as a full disk are no property of the object, so they are thrown.
    if (fault_of(error) != Fault::Input && fault_of(error) != Fault::Geometry) throw;
    made.findings.push_back("not written: " + within(message_of(error), bench.folder));
  }
}

}  // namespace octotomy::planner
