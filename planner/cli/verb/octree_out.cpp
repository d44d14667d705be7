// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cli/verb/octree_out.h"

#include <algorithm>

#include "planner/operation/measure/octree_summary.h"

namespace octotomy::planner::cli {

namespace fs = std::filesystem;

int say(const Program& program, const FileAnswer& made, const Timings& timings) {
  for (const std::string& finding : made.findings) warn_finding(finding);
  Json json = answer(timings);
  json.update(made.json);
  program.say(json,
              made.rows.empty() ? octree_text(json["path"].get<std::string>(), json) : lines(made.rows));
  const auto verdict = made.json.find("verdict");
  const bool failed = (verdict != made.json.end() && *verdict == "FAIL") ||
                      std::any_of(made.findings.begin(), made.findings.end(),
                                  [](const std::string& finding) { return finding.starts_with("FAIL "); });
  return failed ? disagreement : done;
}

int info_of_octree(const Program& program, const fs::path& path) {
  Timings timings;
  const voxel::OctreeFile file = read_timed(path, timings);
  Json json = octree_answer(file, fs::file_size(path), timings);
  json["source"] = path.string();
  for (const std::string& doubt : told_doubts(json)) {
    json["findings"].push_back(doubt);
    warn_finding(doubt);
  }
  program.say(json, octree_text(path.string(), json));
  return done;
}

}  // namespace octotomy::planner::cli
