// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/plan_folders.h"

#include <algorithm>
#include <set>
#include <string_view>

#include "planner/plan/dependence.h"
#include "voxel/space/error.h"

namespace octotomy::planner::serve {
namespace {

namespace fs = std::filesystem;

void add_folder(const fs::path& path, std::set<std::string>& folders) {
  const std::string folder = path.parent_path().string();
  if (folder.size() > 1) folders.insert(folder + "/");
}

void add_all_forms(const fs::path& folder, const fs::path& stated, std::set<std::string>& folders) {
  const fs::path joined = folder / stated;
  std::error_code ignored;
  for (const fs::path& path : {stated, stated.lexically_normal(), joined, joined.lexically_normal(),
                               fs::weakly_canonical(joined, ignored)})
    add_folder(path, folders);
}

/// Whether an absolute path may begin at a slash, by the character before it. In "1/2" and "https://" none does.
bool may_begin_after(char before) {
  return std::string_view(" \t\n'\"`([{<=,;:").find(before) != std::string_view::npos;
}

bool ends_path(char symbol) {
  return std::string_view(" \t\n'\"`)]}>,;:").find(symbol) != std::string_view::npos;
}

}  // namespace

std::vector<std::string> folders_of(const Session& session) {
  std::set<std::string> folders;
  add_all_forms(session.working_folder(), "file", folders);
  try {
    const auto [plan, path] = session.with_document([](const Document& document) {
      return std::pair{document.plan(), document.path()};
    });
    const fs::path folder = plan->folder;
    add_all_forms(folder, path, folders);
    for (const auto& [name, scan] : plan->scans) add_all_forms(folder, scan.path, folders);
    for (const Step& step : plan->steps)
      for (const fs::path& file : files_read(step)) add_all_forms(folder, file, folders);
  } catch (const voxel::Error&) {
    // No plan is open.
  }
  std::vector<std::string> sorted(folders.begin(), folders.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const std::string& a, const std::string& b) { return a.size() > b.size(); });
  return sorted;
}

std::string without_folders(std::string text, const std::vector<std::string>& folders) {
  if (text.find('/') == std::string::npos) return text;
  for (const std::string& folder : folders)
    for (std::size_t at = 0; (at = text.find(folder, at)) != std::string::npos;)
      text.erase(at, folder.size());
  std::string kept;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool begins = text[i] == '/' && (i == 0 || may_begin_after(text[i - 1])) && i + 1 < text.size() &&
                        !ends_path(text[i + 1]) && text[i + 1] != '/';
    if (!begins) {
      kept += text[i];
      continue;
    }
    const std::size_t end = static_cast<std::size_t>(
        std::find_if(text.begin() + static_cast<std::ptrdiff_t>(i), text.end(), ends_path) - text.begin());
    kept += fs::path(text.substr(i, end - i)).filename().string();
    i = end - 1;
  }
  return kept;
}

Json without_folders(Json said, const std::vector<std::string>& folders) {
  if (said.is_string()) return without_folders(said.get<std::string>(), folders);
  if (!said.is_structured()) return said;
  for (auto value = said.begin(); value != said.end(); ++value) {
    *value = without_folders(std::move(*value), folders);
    if (said.is_object() && value.key() == "path" && value->is_string())
      *value = fs::path(value->get<std::string>()).filename().string();
  }
  return said;
}

}  // namespace octotomy::planner::serve
