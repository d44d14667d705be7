// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/plan_folders.h"

#include <algorithm>
#include <set>
#include <string_view>
#include <utility>

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

/// Folders' names may contain blanks and commas, so that these end a path only after its last slash.
constexpr std::string_view softly_ends_path = " \t,", ends_path = "\n'\"`)]}>;:";

bool begins_path(std::string_view text, std::size_t at) {
  return text[at] == '/' && (at == 0 || may_begin_after(text[at - 1])) && at + 1 < text.size() &&
         text[at + 1] != '/' && softly_ends_path.find(text[at + 1]) == std::string_view::npos &&
         ends_path.find(text[at + 1]) == std::string_view::npos;
}

/// The file's name in an absolute path: its first character, and the one after the path.
std::pair<std::size_t, std::size_t> name_of_path(std::string_view text, std::size_t begin) {
  std::size_t last_slash = begin, end = begin + 1;
  for (; end < text.size() && ends_path.find(text[end]) == std::string_view::npos; ++end) {
    if (text[end] != '/') continue;
    if (may_begin_after(text[end - 1])) break;
    last_slash = end;
  }
  return {last_slash + 1, std::min(end, text.find_first_of(softly_ends_path, last_slash))};
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
  for (std::size_t at = 0; at < text.size();) {
    if (!begins_path(text, at)) {
      kept += text[at++];
      continue;
    }
    const auto [name, end] = name_of_path(text, at);
    kept += text.substr(name, end - name);
    at = end;
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
