// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/rebase.h"

#include <algorithm>
#include <stdexcept>

#include "planner/plan/dependence.h"
#include "planner/table/json.h"
#include "voxel/space/staged_files.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;
fs::path whole(const fs::path& folder) {
  return fs::weakly_canonical(fs::absolute(folder.empty() ? fs::path(".") : folder));
}

/// Names paths of one folder from another one.
struct Rebase {
  fs::path from, to;

  std::string of(const std::string& path) const {
    if (path.empty() || fs::path(path).is_absolute()) return path;
    const fs::path found = voxel::absolute_of(from / path).lexically_relative(to);
    if (found.empty())
      throw std::runtime_error("'" + path + "' of " + from.string() + " has no relative path from " +
                               to.string() + ": name it by an absolute one");
    return found.generic_string();
  }
  /// Fields of a step that name a file which the step reads: a text, or texts of a list.
  void files(Json& step, const std::vector<fs::path>& read) const {
    const auto is_read = [&](const Json& value) {
      return value.is_string() &&
             std::find(read.begin(), read.end(), fs::path(value.get<std::string>())) != read.end();
    };
    for (auto& [key, value] : step.items()) {
      if (key == "id" || key == "do") continue;
      if (is_read(value)) value = of(value.get<std::string>());
      if (!value.is_array()) continue;
      for (Json& entry : value)
        if (is_read(entry)) entry = of(entry.get<std::string>());
    }
  }
};

}  // namespace

Plan rebased(const Plan& plan, const fs::path& folder) {
  const Rebase rebase{whole(plan.folder), whole(folder)};
  if (rebase.from == rebase.to) return plan;
  Json json = Json::parse(plan.text);
  for (auto& [name, scan] : json["scans"].items())
    if (scan.contains("path")) scan["path"] = rebase.of(scan["path"].get<std::string>());
  for (std::size_t i = 0; i < plan.steps.size(); ++i)
    rebase.files(json["steps"][i], files_read(plan.steps[i]));
  Plan made = parse_plan(json.dump(2) + "\n", folder);
  made.file = plan.file;
  return made;
}

}  // namespace octotomy::planner
