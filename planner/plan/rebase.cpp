// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/rebase.h"

#include <algorithm>
#include <functional>
#include <stdexcept>

#include "planner/operation/table/json.h"
#include "planner/plan/dependence.h"
#include "voxel/space/staged_files.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;
fs::path whole(const fs::path& folder) {
  return fs::weakly_canonical(fs::absolute(folder.empty() ? fs::path(".") : folder));
}

/// Converts paths relative to one folder to paths relative to another.
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
};

/// Converts the paths of files that a step reads, in fields that are texts or lists of texts.
void change_files(Json& step, const std::vector<fs::path>& read,
                  const std::function<std::string(const std::string&)>& change) {
  const auto is_read = [&](const Json& value) {
    return value.is_string() &&
           std::find(read.begin(), read.end(), fs::path(value.get<std::string>())) != read.end();
  };
  for (auto& [key, value] : step.items()) {
    if (key == "id" || key == "do") continue;
    if (is_read(value)) value = change(value.get<std::string>());
    if (!value.is_array()) continue;
    for (Json& entry : value)
      if (is_read(entry)) entry = change(entry.get<std::string>());
  }
}

}  // namespace

Plan rebased(const Plan& plan, const fs::path& folder) {
  const Rebase rebase{whole(plan.folder), whole(folder)};
  if (rebase.from == rebase.to) return plan;
  Json json = Json::parse(plan.text);
  for (auto& [name, scan] : json["scans"].items())
    if (scan.contains("path")) scan["path"] = rebase.of(scan["path"].get<std::string>());
  for (std::size_t i = 0; i < plan.steps.size(); ++i)
    change_files(json["steps"][i], files_read(plan.steps[i]),
                 [&](const std::string& path) { return rebase.of(path); });
  Plan made = parse_plan(json.dump(2) + "\n", folder);
  made.file = plan.file;
  return made;
}

Plan with_files(const Plan& plan, const std::map<fs::path, fs::path>& places) {
  if (places.empty()) return plan;
  Json json = Json::parse(plan.text);
  for (std::size_t i = 0; i < plan.steps.size(); ++i)
    change_files(json["steps"][i], files_read(plan.steps[i]), [&](const std::string& path) {
      const auto place = places.find(path);
      return place == places.end() ? path : place->second.generic_string();
    });
  Plan made = parse_plan(json.dump(2) + "\n", plan.folder);
  made.file = plan.file;
  return made;
}

}  // namespace octotomy::planner
