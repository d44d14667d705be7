// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cli/octree_out.h"

#include "planner/plan/octree_summary.h"

namespace octotomy::planner::cli {

namespace fs = std::filesystem;

voxel::OctreeFile read_timed(const fs::path& path, Timings& timings) {
  const Stopwatch watch(timings, "read");
  return voxel::read_octree(path);
}

int write_and_say(const Program& program, const voxel::OctreeFile& file, const fs::path& out,
                  Timings& timings, const std::vector<std::string>& findings, const Json& more) {
  if (program.stop.stop_requested()) throw Stopped("stopped before " + out.string() + " was written");
  {
    const Stopwatch watch(timings, "write");
    voxel::write_octree(file, out);
  }
  Json json = octree_answer(file, fs::file_size(out), timings);
  json["path"] = out.string();
  json.update(more);
  for (const std::string& finding : findings) {
    warn(finding);
    json["findings"].push_back(finding);
  }
  program.say(json, octree_text(out.string(), json));
  return done;
}

int info_of_octree(const Program& program, const fs::path& path) {
  Timings timings;
  const voxel::OctreeFile file = read_timed(path, timings);
  Json json = octree_answer(file, fs::file_size(path), timings);
  json["source"] = path.string();
  program.say(json, octree_text(path.string(), json));
  return done;
}

}  // namespace octotomy::planner::cli
